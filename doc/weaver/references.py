"""Reads doc/bibliography.bib and writes its entries as LaTeX for the book's last pages.

Only what our file needs of BibTeX's language is understood: entries whose
fields are in braces. Anything else stops the book with the line.
"""
import re

from problems import Problem

BEGIN = re.compile(r"@(\w+)\{([\w:.-]+),\s*")
FIELD = re.compile(r"(\w+)\s*=\s*\{")
NEEDED = {"article": ("author", "title", "journal", "year"), "book": ("title", "publisher", "year"),
          "incollection": ("author", "title", "booktitle", "year"),
          "inproceedings": ("author", "title", "booktitle", "year"), "misc": ("title",),
          "phdthesis": ("author", "title", "school", "year"), "techreport": ("author", "title", "institution", "year")}


class Entry(dict):
    """The fields of one entry; kind and line beside them."""

    def __init__(self, kind, line):
        super().__init__()
        self.kind = kind
        self.line = line


def closing(text, start):
    """Where the brace closes that was opened just before start."""
    depth = 1
    for place in range(start, len(text)):
        if text[place] in "{}" and text[place - 1] != "\\":
            depth += 1 if text[place] == "{" else -1
            if depth == 0:
                return place
    return len(text)


def read(path):
    """All entries by key; Problem if the file cannot be understood."""
    with open(path, encoding="utf-8") as file:
        text = "".join("\n" if line.startswith("%") else line for line in file)
    entries = {}
    for begin in BEGIN.finditer(text):
        line = text.count("\n", 0, begin.start()) + 1
        entry = Entry(begin[1].lower(), line)
        if begin[2] in entries:
            raise Problem(path, line, f"a second entry has the key {begin[2]}")
        end, place = closing(text, begin.end(1) + 1), begin.end()
        while field := FIELD.search(text, place, end):
            place = closing(text, field.end())
            entry[field[1].lower()] = " ".join(text[field.end():place].split())
        for name in NEEDED.get(entry.kind, ("an entry kind that references.py knows",)):
            if name not in entry:
                raise Problem(path, line, f"{begin[2]} lacks {name}")
        entries[begin[2]] = entry
    return entries


def people(names):
    """'Born, Max and Wolf, Emil' as 'Max Born and Emil Wolf'."""
    turned = [" ".join(reversed(name.split(", ", 1))) for name in names.split(" and ")]
    if len(turned) < 3:
        return " and ".join(turned)
    return ", ".join(turned[:-1]) + " and " + turned[-1]


def family(entry):
    return entry.get("author", entry.get("editor", entry["title"])).split(",")[0]


def ordered(keys, entries):
    """Keys in the order in which the book lists and numbers them: by name, then year."""
    return sorted(keys, key=lambda key: (re.sub(r"\W", "", family(entries[key])).lower(), entries[key].get("year"), key))


def source(entry):
    """Where the work appeared, after author and title."""
    get = entry.get
    if entry.kind == "article":
        number = f"({get('number')})" if get("number") else ""
        pages = f":{get('pages')}" if get("pages") else ""
        return [rf"\emph{{{get('journal')}}} {get('volume', '')}{number}{pages}", get("year")]
    if entry.kind in ("inproceedings", "incollection"):
        volume = f", volume {get('volume')}" if get("volume") else ""
        pages = f", pages {get('pages')}" if get("pages") else ""
        return [rf"In \emph{{{get('booktitle')}}}{volume}{pages}", get("publisher"), get("year")]
    if entry.kind == "phdthesis":
        return ["PhD thesis", get("school"), get("address"), get("year")]
    if entry.kind == "techreport":
        return [f"{get('type', 'Technical report')} {get('number', '')}".strip(), get("institution"), get("address"),
                get("year")]
    series = f"{get('series')} {get('number', '')}".strip() if get("series") else None
    edition = f"{get('edition')} edition" if get("edition") else None
    return [edition, series, get("publisher"), get("address"), get("howpublished"), get("year")]


def latex(entry):
    """One entry as a paragraph of LaTeX."""
    who = people(entry.get("author") or entry.get("editor", ""))
    if who and not entry.get("author"):
        who += ", editors" if " and " in who else ", editor"
    title = entry["title"] if entry.kind in ("article", "inproceedings", "incollection") else rf"\emph{{{entry['title']}}}"
    where = ", ".join(part for part in source(entry) if part)
    text = ". ".join(part for part in (who, title, where, entry.get("note")) if part) + "."
    if doi := entry.get("doi"):
        text += rf" \litextern{{https://doi.org/{doi}}}{{doi:{doi}}}".replace("_", r"\_")
    return text
