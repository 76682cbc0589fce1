#!/usr/bin/python3
"""Check a woven book from outside: every link leads somewhere, and the book needs nothing but itself.

    links.py DIR

Reads all pages in DIR and below. It fails on a link to a page or a place that does not
exist, a missing picture or font, a name given to two places of a
page, a picture without words, anything loaded from elsewhere (links one may
follow are allowed), scripts other than those of the search and of the live
figures, and what LaTeXML or the weaver leave behind when they could not do
their work.
"""
import glob
import os
import re
import sys
import urllib.parse
from typing import Any

import lxml.html

LEFT_BEHIND = re.compile(r"ltx_ERROR|ltx_missing|lit-chunk|lit-figure|lit-live|^chunk:|^LABEL:")
SEARCH = "search.html"  # may load scripts; no page has one in it
LIVE = ("live-program.js", "live.js")  # may be loaded by a page with live figures
LOADS = {"img": "src", "link": "href", "script": "src", "iframe": "src", "source": "src"}
PARSER = lxml.html.HTMLParser(encoding="utf-8")


class Page:
    """The names that one page defines and the addresses that it needs: (line, kind, address)."""

    def __init__(self, path: str, name: str) -> None:
        self.path, self.name = path, name  # from here, and from the folder
        self.places: set[str] = set()
        self.needs: list[tuple[int, str, str]] = []
        self.problems: list[tuple[int, str]] = []
        self.live = False  # whether it has a figure that moves
        for element in lxml.html.parse(path, PARSER).getroot().iter():
            if isinstance(element.tag, str):
                self.read(element)
            else:
                self.problems.append((element.sourceline, f"{element} was left behind"))

    def read(self, element: Any) -> None:
        """Takes notes of one element."""
        line, tag, attributes = element.sourceline, element.tag, dict(element.attrib)
        if place := attributes.get("id"):
            if place in self.places:
                self.problems.append((line, f"two places are called {place}"))
            self.places.add(place)
        for name, value in attributes.items():
            if name != "alttext" and (trace := LEFT_BEHIND.search(value)):
                self.problems.append((line, f"{trace[0]} was left behind"))
        self.live = self.live or "data-live" in attributes
        if tag == "script" and not self.may_load(attributes.get("src", "")):
            self.problems.append((line, "a script"))
        if tag == "img" and not attributes.get("alt"):
            self.problems.append((line, f"the picture {attributes.get('src')} has no words"))
        if tag == "svg" and not attributes.get("aria-label"):
            self.problems.append((line, "a drawing has no words"))
        if address := attributes.get(LOADS.get(tag, "")):
            self.needs.append((line, "load", address))
        elif tag == "a" and "href" in attributes:
            self.needs.append((line, "link", attributes["href"]))

    def may_load(self, script: str) -> bool:
        """Whether the page may load a script."""
        return script in LIVE if self.live else bool(script) and os.path.basename(self.path) == SEARCH


def check_need(files: set[str], pages: dict[str, Page], page: Page, kind: str, address: str) -> str:
    """The problem of an address, or nothing."""
    parts = urllib.parse.urlsplit(address)
    if parts.scheme or parts.netloc:
        return "is loaded from elsewhere" if kind == "load" else ""
    name = os.path.normpath(os.path.join(os.path.dirname(page.name), urllib.parse.unquote(parts.path))) if parts.path else page.name
    if name not in files:
        return "does not exist"
    place = urllib.parse.unquote(parts.fragment)
    if place and (name not in pages or place not in pages[name].places):
        return "names no place of that page"
    return ""


def check(folder: str) -> list[str]:
    """All problems as sentences."""
    paths = sorted(glob.glob(os.path.join(folder, "**", "*.html"), recursive=True))
    pages = {name: Page(path, name) for path in paths for name in [os.path.relpath(path, folder)]}
    files = {os.path.relpath(os.path.join(below, name), folder) for below, _, names in os.walk(folder) for name in names}
    problems = [] if "index.html" in pages else [f"{folder}: has no index.html"]
    for page in pages.values():
        problems += [f"{page.path}:{line}: {what}" for line, what in sorted(page.problems)]
        for line, kind, address in page.needs:
            if wrong := check_need(files, pages, page, kind, address):
                problems.append(f"{page.path}:{line}: {address} {wrong}")
    for path in glob.glob(os.path.join(folder, "*.css")):
        with open(path, encoding="utf-8") as file:
            for address in re.findall(r"url\(([^)]*)\)", file.read()):
                if not os.path.isfile(os.path.join(folder, address)):
                    problems.append(f"{path}: {address} does not exist")
    return problems


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems = check(sys.argv[1])
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
