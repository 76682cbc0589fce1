// Looks words up in search-index.js. The book can be read without it: only search.html loads these two files.
"use strict";

const GREEK = {α: "alpha", β: "beta", γ: "gamma", δ: "delta", ε: "epsilon", ζ: "zeta", η: "eta", θ: "theta", κ: "kappa", λ: "lambda", μ: "mu", µ: "mu",
  ν: "nu", ξ: "xi", π: "pi", ρ: "rho", σ: "sigma", τ: "tau", φ: "phi", ϕ: "phi", χ: "chi", ψ: "psi", ω: "omega"};
// British spelling becomes American, and irregular plurals singular
const SPELLINGS = [[/ys(e|ed|es|er|ers|ing)$/, "yz$1"], [/is(e|ed|es|er|ers|ing|ation|ations|able)$/, "iz$1"],
  [/^(\w{3,})our(s|ed|ing|less)?$/, "$1or$2"], [/tre(s?)$/, "ter$1"], [/^grey/, "gray"], [/ll(ing|ed|er|ers)$/, "l$1"], [/gue(s?)$/, "g$1"],
  [/^spectra$/, "spectrum"], [/^axes$/, "axis"], [/ices$/, "ix"], [/^index$/, "indix"]];
const ENDINGS = ["ations", "ation", "ances", "ance", "nesses", "ness", "ities", "ity", "ively", "ive", "ions", "ion", "ings", "ing", "able", "edly",
  "ed", "ers", "er", "ors", "or", "ally", "ly", "es", "s", "e"];
const KINDS = ["", "message in ", "test in "];  // of sections: prose, messages of the program, tests
const TEST = 2, SHOWN = 40, AROUND = 110;

/** What words of one root have in common: roughness and rough, polarised and polarization. */
function stem(word) {
  for (const [pattern, better] of SPELLINGS) word = word.replace(pattern, better);
  for (let before = ""; before !== word;) {
    before = word;
    const ending = ENDINGS.find((each) => word.endsWith(each) && word.length - each.length >= (/^(e|s|es|ed|ing|ness|ly)$/.test(each) ? 3 : 4)
      && !/(ss|us|is)$/.test(each === "s" ? word : ""));
    if (ending) word = word.slice(0, -ending.length);
    word = word.replace(/ie$|y$/, "i").replace(/([bdfglmnprt])\1$/, "$1");
  }
  return word;
}

const query = new URLSearchParams(location.search).get("q") || "";
const common = new Set(INDEX.common);
const given = [...query].map((letter) => GREEK[letter] || letter).join("").toLowerCase().match(/[\p{L}\p{N}_]+/gu) || [];
const meant = given.filter((word) => word.length > 1 && !common.has(word));
const terms = meant.length ? meant : given;
const roots = new Map(terms.map((term) => [term, stem(term)]));

/** Sections with a term, with a weight: rare words say more, the word itself more than its relatives. */
function sectionsWith(term) {
  const found = new Map(), root = roots.get(term);
  for (const [word, packed] of Object.entries(INDEX.words)) {
    const kinship = word === term ? 2 : stem(word) === root ? 1.8 : term.length > 2 && word.startsWith(term) ? 0.7 : 0;
    if (!kinship) continue;
    const gaps = packed.split(" ");
    const weight = Math.log(1 + INDEX.sections.length / gaps.length) * kinship;
    let section = -1;
    for (const gap of gaps) {
      section += parseInt(gap, 36);
      found.set(section, Math.max(found.get(section) || 0, weight));
    }
  }
  return found;
}

/** Sections that have all terms, the best first. A heading counts four times, but for a test's name; messages of the program and tests come after prose. */
function search() {
  let all = null;
  for (const term of terms) {
    const found = sectionsWith(term);
    for (const [section, weight] of found) {
      const heading = (INDEX.sections[section][2].toLowerCase().match(/[\p{L}\p{N}_]+/gu) || []).map(stem);
      if (INDEX.sections[section][3] !== TEST && heading.includes(roots.get(term))) found.set(section, 4 * weight);
    }
    if (all) for (const section of [...all.keys()]) {
      if (found.has(section)) all.set(section, all.get(section) + found.get(section));
      else all.delete(section);
    } else all = found;
  }
  const phrase = given.join(" ");
  const plain = (text) => (text.toLowerCase().match(/[\p{L}\p{N}_]+/gu) || []).join(" ");
  const rank = ([section, weight]) => weight + (given.length > 1 && plain(INDEX.texts[section]).includes(phrase) ? 20 : 0) - (INDEX.sections[section][3] ? 6 : 0);
  const ranked = [...(all || [])].map((each) => [each[0], rank(each)]);
  return ranked.sort((a, b) => b[1] - a[1] || a[0] - b[0]).map(([section]) => section);
}

/** Some words around the first place with a term, the terms marked. */
function snippet(section) {
  const text = INDEX.texts[section], line = document.createElement("span");
  line.className = "snippet";
  const hits = [...text.matchAll(/[\p{L}\p{N}_]+/gu)].filter(([word]) => {
    const low = word.toLowerCase();
    return terms.some((term) => low === term || stem(low) === roots.get(term) || (term.length > 2 && low.startsWith(term)));
  });
  const first = hits.length ? hits[0].index : 0;
  const begin = first > AROUND ? text.indexOf(" ", first - AROUND) + 1 : 0, wide = begin + Math.round(2.4 * AROUND);
  const end = wide < text.length ? text.lastIndexOf(" ", wide) : text.length;
  let place = begin;
  line.append(begin ? "… " : "");
  for (const hit of hits) {
    if (hit.index < place || hit.index + hit[0].length > end) continue;
    const mark = document.createElement("mark");
    mark.textContent = hit[0];
    line.append(text.slice(place, hit.index), mark);
    place = hit.index + hit[0].length;
  }
  line.append(text.slice(place, end), end < text.length ? " …" : "");
  return line;
}

function item(address, text, about, list, more) {
  const line = document.createElement("li"), link = document.createElement("a"), note = document.createElement("span");
  link.href = address;
  link.textContent = text;
  note.textContent = " " + about;
  note.className = "about";
  line.append(link, note, ...(more ? [more] : []));
  list.append(line);
}

document.querySelector("main input").value = query;
if (terms.length) {
  const identifiers = INDEX.identifiers.filter(([word]) => given.every((term) => word.toLowerCase().includes(term)));
  identifiers.sort((a, b) => a[0].length - b[0].length);
  const sections = search(), list = document.getElementById("results");
  for (const section of sections.slice(0, SHOWN)) {
    const [page, anchor, title, kind] = INDEX.sections[section];
    const [file, chapter] = INDEX.pages[page];
    item(file + (anchor ? "#" + anchor : ""), title, title === chapter ? "" : KINDS[kind] + chapter, list, snippet(section));
  }
  for (const [word, anchor] of identifiers.slice(0, 12)) item("identifiers.html#" + anchor, word, "identifier", list);
  const more = sections.length > SHOWN ? `, the first ${SHOWN} of them here` : "";
  document.getElementById("said").textContent =
      sections.length + identifiers.length ? `${sections.length} sections${more} and ${identifiers.length} identifiers` : "Nothing found.";
}
