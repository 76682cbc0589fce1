// Looks words up in search-index.js. The book can be read without it: only search.html loads these two files.
"use strict";

const query = new URLSearchParams(location.search).get("q") || "";
const terms = query.toLowerCase().match(/[\p{L}\p{N}_]+/gu) || [];
const shown = 40;

/** Section numbers of all words that begin with a term, with a weight: rare words say more. */
function sectionsWith(term) {
  const found = new Map();
  for (const [word, packed] of Object.entries(INDEX.words)) {
    if (!word.startsWith(term)) continue;
    const gaps = packed.split(" ");
    const weight = Math.log(1 + INDEX.sections.length / gaps.length) * (word === term ? 2 : 1);
    let section = -1;
    for (const gap of gaps) {
      section += parseInt(gap, 36);
      found.set(section, Math.max(found.get(section) || 0, weight));
    }
  }
  return found;
}

/** Sections that have all terms, the best first; a word in a heading counts four times. */
function search() {
  let all = null;
  for (const term of terms) {
    const found = sectionsWith(term);
    for (const [section, weight] of found)
      if (INDEX.sections[section][2].toLowerCase().includes(term)) found.set(section, 4 * weight);
    if (all) for (const section of [...all.keys()]) {
      if (found.has(section)) all.set(section, all.get(section) + found.get(section));
      else all.delete(section);
    } else all = found;
  }
  return [...(all || [])].sort((a, b) => b[1] - a[1] || a[0] - b[0]).map(([section]) => INDEX.sections[section]);
}

function item(address, text, about, list) {
  const line = document.createElement("li"), link = document.createElement("a"), note = document.createElement("span");
  link.href = address;
  link.textContent = text;
  note.textContent = " " + about;
  note.className = "about";
  line.append(link, note);
  list.append(line);
}

document.querySelector("main input").value = query;
if (terms.length) {
  const identifiers = INDEX.identifiers.filter(([word]) => terms.every((term) => word.toLowerCase().includes(term)));
  identifiers.sort((a, b) => a[0].length - b[0].length);
  const sections = search(), list = document.getElementById("results");
  for (const [word, anchor] of identifiers.slice(0, 8)) item("identifiers.html#" + anchor, word, "identifier", list);
  for (const [page, anchor, title] of sections.slice(0, shown))
    item(INDEX.pages[page][0] + (anchor ? "#" + anchor : ""), title, INDEX.pages[page][1], list);
  const more = sections.length > shown ? `, the first ${shown} of them here` : "";
  document.getElementById("said").textContent =
      sections.length + identifiers.length ? `${sections.length} sections and ${identifiers.length} identifiers${more}` : "Nothing found.";
}
