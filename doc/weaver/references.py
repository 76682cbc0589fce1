"""Reads doc/bibliography.bib by pybtex and writes its entries as LaTeX for the book's last pages."""
import re
from collections.abc import Iterable

import pybtex.database
from pybtex.scanner import PybtexError

from problems import Problem

NEEDED = {"article": ("author", "title", "journal", "year"), "book": ("title", "publisher", "year"),
          "incollection": ("author", "title", "booktitle", "year"),
          "inproceedings": ("author", "title", "booktitle", "year"), "misc": ("title",),
          "phdthesis": ("author", "title", "school", "year"), "techreport": ("author", "title", "institution", "year")}


class Entry:
    """One entry: its kind, its fields, and its people as they sign."""

    def __init__(self, entry: pybtex.database.Entry) -> None:
        self.kind: str = entry.type
        self.fields = {name.lower(): text for name, text in entry.fields.items()}
        self.authors, self.editors = ([signed(person) for person in entry.persons.get(role, ())] for role in ("author", "editor"))
        first = (entry.persons.get("author") or entry.persons.get("editor") or [None])[0]
        self.family: str = family(first) if first else self.fields.get("title", "")

    def get(self, name: str, default: str = "") -> str:
        """A field that may be missing."""
        return self.fields.get(name, default)

    def has(self, name: str) -> bool:
        """Whether a needed field is there."""
        return bool(self.authors) if name == "author" else name in self.fields


def family(person: pybtex.database.Person) -> str:
    """'van de Hulst' of 'van de Hulst, Hendrik C.'"""
    return " ".join(person.prelast_names + person.last_names)


def signed(person: pybtex.database.Person) -> str:
    """'Hendrik C. van de Hulst'"""
    return " ".join(person.first_names + person.middle_names + person.prelast_names + person.last_names + person.lineage_names)


def read(path: str) -> dict[str, Entry]:
    """All entries by key; Problem if the file cannot be understood."""
    with open(path, encoding="utf-8") as file:
        text = "".join("\n" if line.startswith("%") else line for line in file)
    try:
        found = pybtex.database.parse_string(text, "bibtex").entries
    except PybtexError as error:
        raise Problem(path, getattr(error, "lineno", None) or line_of(text, str(error).rsplit(" ", maxsplit=1)[-1]), str(error)) from None
    entries = {key: Entry(entry) for key, entry in found.items()}
    for key, entry in entries.items():
        for name in NEEDED.get(entry.kind, ("an entry kind of references.py",)):
            if not entry.has(name):
                raise Problem(path, line_of(text, key), f"{key} lacks {name}")
    return entries


def line_of(text: str, key: str) -> int:
    """Where the last entry with a key begins, since the first of two is good."""
    begins = [match.start() for match in re.finditer(rf"@\w+\{{{re.escape(key)},", text)]
    return text.count("\n", 0, begins[-1]) + 1 if begins else 0


def people(names: list[str]) -> str:
    """'Max Born and Emil Wolf'"""
    return " and ".join(names) if len(names) < 3 else ", ".join(names[:-1]) + " and " + names[-1]


def ordered(keys: Iterable[str], entries: dict[str, Entry]) -> list[str]:
    """Keys in the order in which the book lists and numbers them: by name, then year."""
    return sorted(keys, key=lambda key: (re.sub(r"\W", "", entries[key].family).lower(), entries[key].get("year"), key))


def source(entry: Entry) -> list[str]:
    """Where the work appeared, after author and title."""
    get = entry.get
    if entry.kind == "article":
        number = f"({get('number')})" if get("number") else ""
        pages = f":{get('pages')}" if get("pages") else ""
        return [rf"\emph{{{get('journal')}}} {get('volume')}{number}{pages}", get("year")]
    if entry.kind in ("inproceedings", "incollection"):
        volume = f", volume {get('volume')}" if get("volume") else ""
        pages = f", pages {get('pages')}" if get("pages") else ""
        return [rf"In \emph{{{get('booktitle')}}}{volume}{pages}", get("publisher"), get("year")]
    if entry.kind == "phdthesis":
        return ["PhD thesis", get("school"), get("address"), get("year")]
    if entry.kind == "techreport":
        return [f"{get('type', 'Technical report')} {get('number')}".strip(), get("institution"), get("address"), get("year")]
    series = f"{get('series')} {get('number')}".strip() if get("series") else ""
    edition = f"{get('edition')} edition" if get("edition") else ""
    return [edition, series, get("publisher"), get("address"), get("howpublished"), get("year")]


def latex(entry: Entry) -> str:
    """One entry as a paragraph of LaTeX."""
    who = people(entry.authors or entry.editors)
    if who and not entry.authors:
        who += ", editors" if len(entry.editors) > 1 else ", editor"
    title = entry.get("title")
    if entry.kind not in ("article", "inproceedings", "incollection"):
        title = rf"\emph{{{title}}}"
    where = ", ".join(part for part in source(entry) if part)
    text = ". ".join(part for part in (who, title, where, entry.get("note")) if part) + "."
    if doi := entry.get("doi"):
        text += rf" \litextern{{https://doi.org/{doi}}}{{doi:{doi}}}".replace("_", r"\_")
    return text
