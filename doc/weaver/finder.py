"""The index behind the book's search page: for each word the sections that have it, and their text. Files, not a server.

Stems and spellings are the business of search.js: the index has the words as they are written.
"""
import json
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import lxml.html

import listing
import noweb
import tested

if TYPE_CHECKING:
    from book import Page

COMMON = frozenset("""about above after again all also and any are because been before below both but can could does each else
even every few for from get had has have her here him his how into its itself just may more most must not now off once one only
other our out over own same see she should since some such than that the their them then there these they this those through
too under until upon used uses was way were what when where which while who whose why will with without would yet you""".split())
HEADINGS = ("h1", "h2", "h3", "h4", "h5", "h6")
DIVISIONS = ("ltx_chapter", "ltx_section", "ltx_subsection")  # what is found; smaller ones belong to these
APART = HEADINGS + ("p", "li", "dt", "dd", "td", "th", "pre")  # no word goes on from one to the next
UNREAD_TAGS = ("math", "svg")
UNREAD_CLASSES = ("chunk-foot", "chunk-number", "defines", "permalink", "ltx_tag", "source", "folded", "tests")
WORD = re.compile(r"\w+")
GREEK = re.compile(r"\\((?:alpha|beta|gamma|delta|epsilon|varepsilon|zeta|eta|theta|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|phi|varphi"
                   r"|chi|psi|omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Phi|Psi|Omega))(?![a-zA-Z])")
STRING = re.compile(r'"((?:\\.|[^"\\\n])*)"')
DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"


class Section:
    """The text of one section: its pieces, and those of its heading."""

    def __init__(self, anchor: str, title: str = "") -> None:
        self.anchor, self.title = anchor, title
        self.pieces: list[str] = []
        self.symbols: list[str] = []  # names of Greek letters in its formulas

    @property
    def text(self) -> str:
        """All in one line."""
        return in_one_line("".join(self.pieces))


def in_one_line(text: str) -> str:
    """A text with single spaces."""
    return " ".join(text.split())


def base36(number: int) -> str:
    """A number in few letters."""
    out = ""
    while number or not out:
        number, digit = divmod(number, 36)
        out = DIGITS[digit] + out
    return out


def is_unread(element: Any) -> bool:
    """No code of chunks, no formulas, no marks."""
    is_chunk = element.tag == "pre" and not element.attrib  # other lines that are set as they are typed have a class
    return is_chunk or element.tag in UNREAD_TAGS or any(name in UNREAD_CLASSES for name in element.get("class", "").split())


def read_aloud(element: Any) -> Iterator[str]:
    """The pieces of text that are read."""
    if not isinstance(element.tag, str):
        return
    if is_unread(element):
        yield " "
        return
    yield element.text or ""
    for child in element:
        yield from read_aloud(child)
        yield child.tail or ""


def text_of(html: str) -> str:
    """The readable text of a piece of HTML."""
    return in_one_line("".join(read_aloud(lxml.html.fragment_fromstring(html, create_parent="div"))))


def fill(sections: list[Section], element: Any) -> None:
    """Goes through a page in its order; a section ends where the next begins, be it inside or behind."""
    if not isinstance(element.tag, str):
        return
    if is_unread(element):
        if element.tag == "math":
            sections[-1].symbols += [name.lower() for name in GREEK.findall(element.get("alttext", ""))]
        sections[-1].pieces.append(" ")
        return
    if element.tag == "section" and element.get("id") and any(name in DIVISIONS for name in element.get("class", "").split()):
        sections.append(Section(element.get("id")))
    if element.tag in HEADINGS and not sections[-1].title:
        sections[-1].title = in_one_line("".join(read_aloud(element)))
        return
    apart = " " if element.tag in APART else ""
    sections[-1].pieces.append(apart + (element.text or ""))
    for child in element:
        fill(sections, child)
        sections[-1].pieces.append(child.tail or "")
    sections[-1].pieces.append(apart)


def sections_of(page: "Page") -> list[Section]:
    """The sections of a page; what is above the first belongs to it."""
    sections = [Section("")]
    fill(sections, lxml.html.fragment_fromstring(page.body, create_parent="div"))
    if len(sections) > 1:
        sections[1].pieces = sections[0].pieces + sections[1].pieces
        sections[1].title = sections[0].title or sections[1].title
        del sections[0]
    for section in sections:
        section.title = section.title or page.title
    return sections


def messages_of(page: "Page", anchors: dict[str, tuple[str, str]]) -> Iterator[Section]:
    """The messages that a chapter's code may print, a section for each chunk with some: literals of several words."""
    for chunk in page.chunks:
        texts = [text for text in STRING.findall(chunk.text) if text.count(" ") > 1]
        if texts:
            section = Section(anchors[chunk.label][1], noweb.plain(chunk.name))
            section.pieces = [" \u2026 ".join(texts)]
            yield section


def tests_of(page: "Page", wording: tested.Wording) -> Iterator[Section]:
    """The page of a file of tests: a section for what its head says, and one for each test, with its comments and messages."""
    file = page.tests[0].file
    section = Section("", page.title)
    section.pieces = [file.head]
    yield section
    for test in page.tests:
        section = Section(test.full, wording.words(test))
        section.pieces = [" \u2026 ".join([test.full, test.sentence, *(said for said in STRING.findall(file.text[test.begin:test.end])
                                                                     if said.count(" ") > 1)])]
        yield section


def index(pages: list["Page"], wording: tested.Wording, identifiers: Iterable[listing.Identifier], anchors: dict[str, tuple[str, str]]) -> str:
    """A script that defines INDEX, as search.js expects it."""
    sections: list[tuple[int, str, str, int]] = []
    texts: list[str] = []
    words: dict[str, list[int]] = {}
    for number, page in enumerate(pages):
        if page.tests and not page.latex:  # a file of tests
            found = [(section, 2) for section in tests_of(page, wording)]
        else:
            found = [(section, 0) for section in sections_of(page)] + [(section, 1) for section in messages_of(page, anchors)]
        for section, kind in found:
            every = set(WORD.findall((section.text + " " + section.title).lower()))
            if page.name == "notation":
                every |= set(section.symbols)
            for word in every:
                if len(word) > 1 and not word[0].isdigit() and word not in COMMON:
                    words.setdefault(word, []).append(len(sections))
            sections.append((number, section.anchor, section.title, kind))
            texts.append(section.text)
    packed = {word: " ".join(base36(b - a) for a, b in zip([-1] + found, found)) for word, found in sorted(words.items())}
    data = {"pages": [(page.file, text_of(page.title)) for page in pages], "sections": sections, "words": packed, "texts": texts,
            "identifiers": [(word, listing.anchor_of(word)) for word, *_ in identifiers], "common": sorted(COMMON)}
    return "const INDEX = " + json.dumps(data, ensure_ascii=False, separators=(",", ":")) + ";\n"
