#!/usr/bin/env python3
"""Check a woven book from outside: every link leads somewhere, and the book needs nothing but itself.

    links.py DIR

Reads all pages of DIR as a browser would. It fails on a link to a page or a
place that does not exist, a picture or font that is not there, a name given
to two places of a page, a picture without words, anything loaded from
elsewhere (links one may follow are allowed), scripts on any page but the
search, and what LaTeXML or the
weaver leave behind when they could not do their work.
"""
import glob
import html.parser
import os
import re
import sys
import urllib.parse

LEFT_BEHIND = ("ltx_ERROR", "ltx_missing", "lit-chunk", "lit-figure", 'href="chunk:', '"LABEL:')
SCRIPTED = "search.html"  # the only page that may load scripts; it has none of its own
LOADS = {"img": "src", "link": "href", "script": "src", "iframe": "src", "source": "src"}


class Page(html.parser.HTMLParser):
    """What one page defines and what it needs: (line, kind, address)."""

    def __init__(self, path):
        super().__init__()
        self.path, self.places, self.needs, self.problems = path, set(), [], []
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.feed(text)
        for number, line in enumerate(text.splitlines(), 1):
            self.problems += [(number, f"{trace} was left behind") for trace in LEFT_BEHIND
                              if trace in re.sub(r'alttext="[^"]*"', "", line)]

    def handle_starttag(self, tag, attrs):
        line, attrs = self.getpos()[0], dict(attrs)
        if place := attrs.get("id"):
            if place in self.places:
                self.problems.append((line, f"two places are called {place}"))
            self.places.add(place)
        if tag == "script" and (os.path.basename(self.path) != SCRIPTED or not attrs.get("src")):
            self.problems.append((line, "a script"))
        if tag == "img" and not attrs.get("alt"):
            self.problems.append((line, f"the picture {attrs.get('src')} has no words"))
        if tag == "svg" and not attrs.get("aria-label"):
            self.problems.append((line, "a drawing has no words"))
        if address := attrs.get(LOADS.get(tag, "")):
            self.needs.append((line, "load", address))
        elif tag == "a" and attrs.get("href") is not None:
            self.needs.append((line, "link", attrs["href"]))


def check_need(folder, pages, page, kind, address):
    """What is wrong with an address, or nothing."""
    parts = urllib.parse.urlsplit(address)
    if parts.scheme or parts.netloc:
        return "is loaded from elsewhere" if kind == "load" else None
    name = urllib.parse.unquote(parts.path) or os.path.basename(page.path)
    if not os.path.isfile(os.path.join(folder, name)):
        return "does not exist"
    place = urllib.parse.unquote(parts.fragment)
    if place and (name not in pages or place not in pages[name].places):
        return "names no place of that page"
    return None


def check(folder):
    """All problems as sentences, and the number of links."""
    pages = {os.path.basename(path): Page(path) for path in sorted(glob.glob(os.path.join(folder, "*.html")))}
    problems, count = [], 0
    if "index.html" not in pages:
        problems.append(f"{folder}: has no index.html")
    for page in pages.values():
        problems += [f"{page.path}:{line}: {what}" for line, what in page.problems]
        for line, kind, address in page.needs:
            count += 1
            if wrong := check_need(folder, pages, page, kind, address):
                problems.append(f"{page.path}:{line}: {address} {wrong}")
    for path in glob.glob(os.path.join(folder, "*.css")):
        with open(path, encoding="utf-8") as file:
            for address in re.findall(r"url\(([^)]*)\)", file.read()):
                if not os.path.isfile(os.path.join(folder, address)):
                    problems.append(f"{path}: {address} does not exist")
    return problems, count


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems, count = check(sys.argv[1])
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
