"""A book before it is rendered: its pages in parts, their references, and its chunks.

Two renderers use this: weave.py makes the HTML, pdf.py the PDF.
"""
import argparse
import os
import re
import sys
from collections.abc import Callable, Container
from typing import Any

import contents
import latexml
import names
import noweb
import reference
import references
import tested
import verdicts
from problems import Problem, Problems, stop_if_any

LABEL = re.compile(r"\\label\{([^}]*)\}")
REFERENCE = re.compile(r"\\(?:eq)?ref\{([^}]*)\}")
CITATION = re.compile(r"\\cite(?:\[[^\]]*\])?\{([^}]*)\}")
VALUE = re.compile(r"\\val\{([^}]*)\}")
FIGURE = re.compile(r"\\includegraphics(?:\[[^\]]*\])?\{([^}]*)\}")
DRAWN_LINK = re.compile(r'<a href="([^"]*)"><rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)"')
SCIENTIFIC = re.compile(r"(-?\d+(?:\.\d+)?)e([+-])0*(\d+)")
MALUSVAL = re.compile(r"\\malusval\{([^}]*)\}\{(.*)\}\s*$")


class Page:
    """One page of the book; source is the file to edit, chapter its number (0: none)."""

    def __init__(self, name: str, source: str, latex: str, chapter: int = 0) -> None:
        self.name, self.source, self.latex, self.chapter = name, source, latex, chapter
        self.volume = 1
        self.file = name + ".html"
        self.title = self.body = ""
        self.sections: list[tuple[str, str]] = []  # (anchor, title)
        self.chunks: list[noweb.Chunk] = []
        self.tests: list[tested.Test] = []
        self.root: Any = None  # LaTeXML's XML
        self.tree: Any = None  # and its HTML
        self.tex = self.addresses = ""  # what that was made of, and what its references lead to


def line_of(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1


def without_comments(latex: str) -> str:
    """The same text, same length, comments blanked, so that their contents are not searched."""
    return re.sub(r"(?<!\\)%[^\n]*", lambda match: " " * len(match[0]), latex)


def power_of_ten(text: str) -> str:
    """A number as programs print it, 3.2e-05, as print has it; any other text as it is."""
    number = SCIENTIFIC.fullmatch(text)
    if not number:
        return text
    return rf"\ensuremath{{{number[1]}\cdot10^{{{number[2].replace('+', '')}{number[3]}}}}}"


# ---------------------------------------------------------------- what the prose refers to
class Links:
    """Labels, citations, values and figures of all pages: each must exist."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.bibliography = references.read(options.bibliography)
        self.values = self.read_values(os.path.join(options.report, "values.tex"))
        self.labels: dict[str, tuple[Page, str, str]] = {}  # label -> (page, anchor, number)
        self.cited: dict[str, list[Page]] = {}  # key -> pages that cite it
        self.figures: dict[str, str] = {}  # name in \includegraphics -> file
        self.anchors: dict[str, tuple[str, str]] = {}  # noweb's label -> (page file, anchor)
        self.inventory: Page | None = None  # the page with the table of all items
        self.numbers: dict[str, int] = {}  # of the bibliography's entries

    @staticmethod
    def read_values(path: str) -> dict[str, str]:
        values: dict[str, str] = {}
        if os.path.exists(path):
            with open(path, encoding="utf-8") as lines:
                for number, line in enumerate(lines, 1):
                    if line.strip() and not line.startswith("%"):
                        entry = MALUSVAL.match(line)
                        if not entry:
                            raise Problem(path, number, r"expected \malusval{ID.name}{text}")
                        values[entry[1]] = power_of_ten(entry[2])
        return values

    def find_figure(self, name: str) -> str:
        for folder in (self.options.report, self.options.drawn, os.path.join(self.options.book, "figures")):
            for ending in (".svg", ".png"):
                path = os.path.join(folder, name + ending)
                if os.path.isfile(path):
                    return path
        return ""

    def drawing(self, name: str) -> str:
        """The text of a figure that has links in it, whose addresses are labels; nothing for other figures."""
        path = self.figures[name]
        if not path or not path.endswith(".svg") or path.startswith(self.options.report):
            return ""
        with open(path, encoding="utf-8") as file:
            text = file.read()
        return text if DRAWN_LINK.search(text) else ""

    def check(self, pages: list[Page]) -> None:
        """Everything the prose refers to exists; all missing targets are reported at once."""
        problems: list[Problem] = []
        defined: dict[str, str] = {}
        for page in pages:
            for label in LABEL.finditer(without_comments(page.latex)):
                if label[1] in defined:
                    problems.append(Problem(page.source, line_of(page.latex, label.start()),
                                            f"label {label[1]} is also defined in {defined[label[1]]}"))
                defined[label[1]] = page.source
        for page in pages:
            problems += self.check_page(page, defined)
        stop_if_any(problems)

    def check_page(self, page: Page, defined: Container[str]) -> list[Problem]:
        """The references of one page; notes the citations, and the figures that are shown."""
        problems: list[Problem] = []
        text = without_comments(page.latex)

        def complain(match: re.Match[str], sentence: str) -> None:
            problems.append(Problem(page.source, line_of(text, match.start()), sentence))

        for match in REFERENCE.finditer(text):
            if match[1] not in defined:
                complain(match, rf"{match[0]}: no chapter has \label{{{match[1]}}}")
        for match in VALUE.finditer(text):
            if match[1] not in self.values:
                complain(match, rf"{match[0]}: `malus reproduce` left no such value")
        for match in CITATION.finditer(text):
            for key in match[1].split(","):
                if key not in self.bibliography:
                    complain(match, f"{match[0]}: {self.options.bibliography} has no entry {key}")
                elif page not in self.cited.setdefault(key, []):
                    self.cited[key].append(page)
        for match in FIGURE.finditer(text):
            self.figures[match[1]] = self.find_figure(match[1])
            if not self.figures[match[1]]:
                complain(match, rf"{match[0]}: neither {self.options.report} nor {self.options.book}/figures"
                                f" has {match[1]}.svg or .png")
            for link in DRAWN_LINK.finditer(self.drawing(match[1])):
                if link[1] not in defined:
                    complain(match, rf"{match[0]}: its drawing links to {link[1]}, but no chapter has that label")
        return problems

    def substitute(self, page: Page) -> None:
        """Puts values into the prose and leaves a hole for each figure. (Comments may name what does not exist.)"""
        latex = VALUE.sub(lambda match: self.values.get(match[1], ""), page.latex)
        page.latex = FIGURE.sub(lambda match: rf"\litfigure{{{match[1]}}}", latex)

    def bibliography_page(self) -> Page:
        """The entries that are cited, numbered by name and year."""
        keys = references.ordered(self.cited, self.bibliography)
        self.numbers = {key: number for number, key in enumerate(keys, 1)}
        entries = [rf"\litentry{{{key}}}{{{references.latex(self.bibliography[key])}}}" for key in keys]
        return Page("bibliography", self.options.bibliography, "\\chapter*{Bibliography}\n" + "\n".join(entries))


# ---------------------------------------------------------------- the book
class Part:
    """A part of the book: its pages, and what contents.py reads of it."""

    def __init__(self, about: contents.Part) -> None:
        self.name, self.title, self.about, self.volume, self.code = about.name, about.title, about.about, about.volume, about.code
        self.pages: list[Page] = []
        self.page = Page(self.name, "", "")  # what a renderer shows of the part itself
        self.page.volume = self.volume


class Book:
    """All pages, in parts of two volumes."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.contents = contents.Contents(os.path.join(options.book, "book.ini"))
        self.about = self.contents.about
        self.chapters = noweb.read(self.contents.ordered(options.chapters))
        read = {os.path.normpath(path) for path in options.chapters}  # a header may outlive its chapter
        public = names.public(options.headers) if options.headers else []
        self.names = [name for name in public if os.path.normpath(name.path) in read]
        self.links = Links(options)
        self.verdicts = verdicts.Verdicts(options.report, options.inventory)
        self.reference = reference.Reference(options.report)
        self.tests = tested.Tests(options.tests)
        self.wording = tested.Wording(part for chapter in self.chapters for part in chapter.parts if isinstance(part, str))
        self.parts: list[Part] = []
        self.front: list[Page] = []
        self.back: list[Page] = []

    def gather(self) -> None:
        """A page for each chapter. A numbered heading is \\chapter, the others are \\chapter*."""
        defined = {word for chapter in self.chapters for chunk in chapter.chunks for word, _ in chunk.defines}
        stop_if_any(names.check(self.names, defined))
        parts: dict[str, Part] = {}
        number = 0
        for chapter in self.chapters:
            key = contents.key_of(chapter.path)
            latex = chapter.latex()
            numbered = re.search(r"\\chapter\{", latex) is not None
            number += numbered
            home = self.contents.home(key)
            beside = key.startswith(("front/", "back/"))  # a page without a floor
            page = Page(os.path.basename(key) if beside else key.replace("/", "-"), chapter.path, latex, number if numbered else 0)
            page.chunks = chapter.chunks
            if home:
                if home.name not in parts:
                    parts[home.name] = Part(home)
                    self.parts.append(parts[home.name])
                parts[home.name].pages.append(page)
                page.volume = home.volume
            else:
                (self.front if key.startswith("front/") else self.back).append(page)
            self.name_chunks(chapter, page)
        homes = self.chapter_pages()
        self.tests.attach(list(homes))
        for name, page in homes.items():
            page.tests = self.tests.of(name)
        for page in self.pages():
            page.latex = page.latex.replace(r"\readerspath", self.readers_path_latex())

    def chapter_pages(self) -> dict[str, Page]:
        """The pages of the parts, in reading order, by their chapters' names."""
        return {os.path.basename(contents.key_of(page.source)): page for part in self.parts for page in part.pages}

    def readers_path(self) -> list[tuple[Page, str]]:
        """The chapters for a first reader, each with what it is read for."""
        homes = {contents.key_of(page.source): page for page in self.pages()}
        return [(homes[key], why) for key, why in self.contents.readers_path if key in homes]

    def readers_path_latex(self) -> str:
        """The same as a list in one line, for the preface."""
        items = []
        for page, why in self.readers_path():
            label = LABEL.search(page.latex)
            if not label:
                raise Problem(page.source, 0, "a chapter of the reader's path needs a label")
            items.append(rf"\item {self.chapter_link(label[1], page)}: {why}.")
        return rf"\begin{{enumerate}}{''.join(items)}\end{{enumerate}}" if items else ""

    def chapter_link(self, label: str, page: Page) -> str:  # pylint: disable=unused-argument
        """A link to a chapter outside of a sentence."""
        return rf"Chapter~\ref{{{label}}}"

    def name_chunks(self, chapter: noweb.Chapter, page: Page) -> None:
        """A place on the page for each chunk; every chunk that is used must be there."""
        problems: list[Problem] = []
        taken: set[str] = set()
        for chunk in chapter.chunks:
            anchor = "chunk-" + latexml.slug(noweb.plain(chunk.name))
            count = 1
            while (anchor if count == 1 else f"{anchor}-{count}") in taken:
                count += 1
            anchor = anchor if count == 1 else f"{anchor}-{count}"
            taken.add(anchor)
            self.links.anchors[chunk.label] = (page.file, anchor)
            problems += [Problem(chapter.path, 0, f"chunk <<{name}>> is used in <<{chunk.name}>> but never defined")
                         for name, label in chunk.used_chunks if not label]
        stop_if_any(problems)

    def substitute(self, page: Page) -> None:
        """Puts into the prose what the program computed."""
        if re.search(r"^\\inventory$", page.latex, re.MULTILINE):
            self.links.inventory = page
        self.verdicts.substitute(page, self.chapters, self.pages())
        self.reference.substitute(page)
        self.links.substitute(page)

    def pages(self) -> list[Page]:
        """In reading order."""
        return self.front + [page for part in self.parts for page in part.pages] + self.back


def run(description: str, render: Callable[[argparse.Namespace], None]) -> None:
    """The command line of both renderers; problems go to the standard error, and the exit status is then 1."""
    arguments = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("out", "work", "book", "report", "bibliography"):
        arguments.add_argument("--" + name, required=True)
    arguments.add_argument("--drawn", default="", help="the folder of the figures that the build draws of the chapters")
    arguments.add_argument("--tests", default="tests", help="the folder of the tests that the chapters list and the site has (default: tests)")
    arguments.add_argument("--live", default="", help="the program of the live figures; without it they are left out")
    arguments.add_argument("--headers", help="the folder of the tangled headers, whose public names the index must hold")
    arguments.add_argument("--inventory", help="the list of all items, those that are not built as well")
    arguments.add_argument("chapters", nargs="+")
    try:
        render(arguments.parse_args())
    except (Problem, Problems) as found:
        print(found, file=sys.stderr)
        sys.exit(1)
