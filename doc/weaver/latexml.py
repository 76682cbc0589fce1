"""LaTeX to HTML by LaTeXML, each chapter by itself, so that chapters convert side by side and are cached.

LaTeXML works in two steps, and latexml.pl runs each of them for many chapters
at once. The first turns LaTeX into XML; there we give every thing that can be
referred to its address and resolve all references, since only we see the
whole book. The second step turns that XML into HTML. The result of a step is kept with a digest of its input, and made
again only if the input changed.

An earlier version also replaced LaTeXML's parser of formulas, by one that
visits each place of a formula only once. It saved a quarter of the first step
and was larger than all that is here of Perl.
"""
import functools
import hashlib
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import lxml.html
from lxml import etree

from problems import Problem, stop_if_any

if TYPE_CHECKING:
    from book import Page

Element = Any                       # lxml brings no types
Parts = tuple[str, str, str, str]   # of a label: anchor, number, kind, title of a section without formulas

HERE = os.path.dirname(os.path.abspath(__file__))
DRIVER = os.path.join(HERE, "latexml.pl")

NAMESPACE = "http://dlmf.nist.gov/LaTeXML"
SECTIONS = ("chapter", "section", "subsection", "subsubsection", "paragraph")
BEGIN = r"\documentclass{book}\usepackage{malus}\begin{document}"  # on the first line, which keeps its number
XML, HTML = etree.XMLParser(remove_comments=True, remove_pis=True), lxml.html.HTMLParser(encoding="utf-8")
MESSAGE = re.compile(r"^(Warning|Error|Fatal):(.*)")
PLACE = re.compile(r"\.tex; (?:from )?line (\d+)")


class Address(NamedTuple):
    """Of a link: where it leads, its text, what a browser says of it, and whether the text is a title."""

    href: str
    text: str
    about: str
    is_title: bool


def ours(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def slug(text: str) -> str:
    """Words joined by hyphens, as allowed in an address."""
    return "-".join(re.findall(r"[a-z0-9]+", text.lower())) or "section"


def version(tool: str) -> str:
    """Changes when another LaTeXML is installed."""
    path = shutil.which(tool)
    if not path:
        raise Problem(tool, 0, "not found; Debian's package latexml brings it")
    status = os.stat(path)
    return f"{path} {status.st_size} {status.st_mtime_ns}"


def write(path: str, text: str) -> None:
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Job:
    """One file for LaTeXML: which page it is of, all that the result depends on, and where things lie.

    Its source text is computed only when it has to be made.
    """

    def __init__(self, page: "Page", depends: str, text: Callable[[], str], path: str, before: str, after: str) -> None:
        self.page, self.depends, self.text = page, depends, text
        self.source, self.destination, self.log = path + before, path + after, path + after + ".log"
        self.key = path + after + ".key"

    def is_made(self, digest: str) -> bool:
        """Whether the destination was made from this very text."""
        if not os.path.exists(self.destination) or not os.path.exists(self.key):
            return False
        with open(self.key, encoding="utf-8") as kept:
            return kept.read() == digest

    def problems(self, said: str) -> list[Problem]:
        """Every complaint of LaTeXML is a problem: of the chapter, at its line, since the lines are the chapter's."""
        lines: list[str] = []
        if os.path.exists(self.log):
            with open(self.log, encoding="utf-8", errors="replace") as file:
                lines = file.read().splitlines()
        found = []
        for i, line in enumerate(lines):
            if message := MESSAGE.match(line):
                place = PLACE.search(" ".join(lines[i:i + 3]))
                found.append(Problem(self.page.source, int(place[1]) if place else 0, f"LaTeXML: {message[1]}:{message[2]}"))
        if not found and not os.path.exists(self.destination):
            found.append(Problem(self.page.source, 0, f"LaTeXML: {said.strip() or 'made nothing, and does not say why'}"))
        return found


class Converter:
    """Runs LaTeXML in a separate directory."""

    def __init__(self, work: str, theme: str) -> None:
        os.makedirs(work, exist_ok=True)
        self.work, self.theme = work, theme
        self.context = version("latexml")
        for path in (os.path.join(theme, "malus.sty.ltxml"), DRIVER):
            with open(path, encoding="utf-8") as file:
                self.context += file.read()

    def run(self, step: str, jobs: list[Job]) -> Iterator[Job]:
        """Yields each job when it is made: at once those that are already made, while LaTeXML works on the others.

        Those begin with the longest, so that none is waited for at the end.
        """
        digests = {job: hashlib.sha256((job.depends + self.context).encode()).hexdigest() for job in jobs}
        wanted = [job for job in jobs if not job.is_made(digests[job])]
        for job in wanted:
            write(job.source, job.text())
            for old in (job.destination, job.log, job.key):
                if os.path.exists(old):
                    os.remove(old)
        worker = self.start(step, sorted(wanted, key=lambda job: -len(job.depends))) if wanted else None
        try:
            yield from (job for job in jobs if job not in wanted)
            said = worker.communicate()[1] if worker else ""
        finally:
            if worker and worker.poll() is None:
                worker.kill()
        problems: list[Problem] = []
        for job in wanted:
            if found := job.problems(said):
                problems += found
            else:
                write(job.key, digests[job])
        stop_if_any(problems)
        yield from wanted

    def start(self, step: str, jobs: list[Job]) -> subprocess.Popen[str]:
        """LaTeXML at work."""
        command = ["perl", DRIVER, step, self.theme, str(os.cpu_count())]
        worker = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        assert worker.stdin
        worker.stdin.write("".join(f"{job.source}\t{job.destination}\t{job.log}\n" for job in jobs))
        worker.stdin.close()
        worker.stdin = None  # nothing more to say: for communicate()
        return worker

    def to_xml(self, pages: list["Page"]) -> Iterator["Page"]:
        """First step, LaTeX to XML: yields each page when it has its root."""
        jobs = []
        for page in pages:  # page.chapter is its number, 0 for none
            page.tex = f"{BEGIN}\\setcounter{{chapter}}{{{max(page.chapter - 1, 0)}}}{page.latex}\n\\end{{document}}\n"
            jobs.append(Job(page, page.tex, functools.partial(getattr, page, "tex"), os.path.join(self.work, page.name), ".tex", ".xml"))
        for job in self.run("xml", jobs):
            job.page.root = etree.parse(job.destination, XML).getroot()
            yield job.page

    def to_html(self, pages: list["Page"]) -> Iterator["Page"]:
        """Second step, XML to HTML: yields each page when it has its tree."""
        jobs = [Job(page, page.tex + page.addresses, functools.partial(etree.tostring, page.root, encoding="unicode"),
                    os.path.join(self.work, page.name), ".ref.xml", ".html") for page in pages]
        for job in self.run("html", jobs):
            job.page.tree = lxml.html.parse(job.destination, HTML).find(".//article")
            yield job.page


def number_of(element: Element) -> str:
    """The number LaTeX gave it, or the tag the author gave it."""
    for tag in element.iterfind(f"{ours('tags')}/{ours('tag')}"):
        if tag.get("role") == "refnum":
            return "".join(tag.itertext()).strip()
    return ""


def words(title: Element | None) -> str:
    """The words of a title, without its number and its formulas."""
    if title is None:
        return ""
    parts = [title.text or ""]
    for child in title:
        if child.tag not in (ours("tag"), ours("Math")):
            parts.append(words(child))
        parts.append(child.tail or "")
    return "".join(parts)


def title_of(element: Element) -> str:
    """The title of a section; nothing if it has a formula, which a link could not show."""
    title = element.find(ours("title"))
    if title is None or title.find(f".//{ours('Math')}") is not None:
        return ""
    return " ".join(words(title).split())


def give_addresses(root: Element) -> dict[str, Parts]:
    """Names what can be linked to in this chapter; returns {label: (anchor, number, kind)}."""
    labels: dict[str, Parts] = {}
    taken: set[str] = set()
    for element in root.iter():
        kind = element.tag.removeprefix(f"{{{NAMESPACE}}}")
        names = [name.removeprefix("LABEL:") for name in element.get("labels", "").split()]
        if names:
            anchor = names[0]
        elif kind in SECTIONS:
            anchor = slug(words(element.find(ours("title"))))
        elif kind == "p" and element.get("class", "").startswith("lit-entry"):
            anchor = element.get("{http://www.w3.org/XML/1998/namespace}id")
        else:
            continue
        while anchor in taken:
            anchor += "-again"
        taken.add(anchor)
        element.set("fragid", anchor)
        for name in names:
            labels[name] = (anchor, number_of(element), kind, title_of(element) if kind in SECTIONS else "")
    return labels


COUNTED = re.compile(r"(^|[\s(])(?:[Cc]hapter|[Ss]ection)[\s\u00a0]+$")  # before a number


def link(element: Element, target: Address) -> None:
    """Makes an element a link. The title of a chapter takes the place of `chapter 31`, as the title of a work does."""
    if target.is_title:
        before = element.getprevious()
        text = (before.tail if before is not None else element.getparent().text) or ""
        text = COUNTED.sub(r"\1", text)
        if before is not None:
            before.tail = text
        else:
            element.getparent().text = text
    element.tag = ours("ref")
    element.clear(keep_tail=True)
    element.text = target.text
    element.set("href", target.href)
    if target.is_title:
        element.set("class", "lit-title")
    if target.about:
        element.set("title", target.about)


def resolve(root: Element, address: Callable[[str], Address], citation: Callable[[str], Address]) -> str:
    """Replaces references by links. address(label) and citation(key) say where; returns all of them."""
    used = []

    def link_to(element: Element, target: Address) -> None:
        used.append("\t".join(map(str, target)))
        link(element, target)

    for element in list(root.iter(ours("ref"))):
        if name := element.get("labelref"):
            link_to(element, address(name.removeprefix("LABEL:")))
    for bibref in list(root.iter(ours("bibref"))):
        *others, last = bibref.get("bibrefs").split(",")
        for key in others:
            cited = etree.Element(ours("ref"))
            bibref.addprevious(cited)
            link_to(cited, citation(key))
            cited.tail = ", "
        link_to(bibref, citation(last))
    return "\n".join(used)
