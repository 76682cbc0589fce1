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
import html
import os
import re
import sys
import urllib.parse

LEFT_BEHIND = ("ltx_ERROR", "ltx_missing", "lit-chunk", "lit-figure", 'href="chunk:', '"LABEL:')
SCRIPTED = "search.html"  # the only page that may load scripts; it has none of its own
LOADS = {"img": "src", "link": "href", "script": "src", "iframe": "src", "source": "src"}


class Page:
    """What one page defines and what it needs: (place in its text, kind, address)."""

    # a parser of HTML takes four times as long; these expect values between double quotes, as the weaver writes them
    TAG = re.compile(r'<([a-z]\w*)((?:[^>"]|"[^"]*")*)>', re.IGNORECASE)
    ATTRIBUTE = re.compile(r'([\w:-]+)="([^"]*)"')
    LOOKED_AT = re.compile(r'\s(?:id|href|src)\s*=(?P<otherwise>[^"])?', re.IGNORECASE)

    def __init__(self, path):
        self.path, self.places, self.needs, self.problems = path, set(), [], []
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        for tag in self.TAG.finditer(self.text):
            looked_at = self.LOOKED_AT.search(tag[2])
            if looked_at or tag[1].lower() in ("img", "svg", "script"):
                self.read(tag.start(), tag[1].lower(), dict(self.ATTRIBUTE.findall(tag[2])))
            if looked_at and looked_at["otherwise"]:
                self.problems.append((tag.start(), f"{tag[0]} has a value without double quotes"))
        for trace in LEFT_BEHIND:
            if trace in self.text:
                self.problems += [(match.start(), f"{trace} was left behind") for match in
                                  re.finditer(rf'alttext="[^"]*"|{re.escape(trace)}', self.text) if match[0] == trace]

    def line(self, place):
        return self.text.count("\n", 0, place) + 1

    def read(self, where, tag, attributes):
        if place := html.unescape(attributes.get("id", "")):
            if place in self.places:
                self.problems.append((where, f"two places are called {place}"))
            self.places.add(place)
        if tag == "script" and (os.path.basename(self.path) != SCRIPTED or not attributes.get("src")):
            self.problems.append((where, "a script"))
        if tag == "img" and not attributes.get("alt"):
            self.problems.append((where, f"the picture {attributes.get('src')} has no words"))
        if tag == "svg" and not attributes.get("aria-label"):
            self.problems.append((where, "a drawing has no words"))
        if address := attributes.get(LOADS.get(tag, "")):
            self.needs.append((where, "load", html.unescape(address)))
        elif tag == "a" and "href" in attributes:
            self.needs.append((where, "link", html.unescape(attributes["href"])))


def check_need(files, pages, page, kind, address):
    """What is wrong with an address, or nothing."""
    parts = urllib.parse.urlsplit(address)
    if parts.scheme or parts.netloc:
        return "is loaded from elsewhere" if kind == "load" else None
    name = urllib.parse.unquote(parts.path) or os.path.basename(page.path)
    if os.path.normpath(name) not in files:
        return "does not exist"
    place = urllib.parse.unquote(parts.fragment)
    if place and (name not in pages or place not in pages[name].places):
        return "names no place of that page"
    return None


def check(folder):
    """All problems as sentences, and the number of links."""
    pages = {os.path.basename(path): Page(path) for path in sorted(glob.glob(os.path.join(folder, "*.html")))}
    files = {os.path.relpath(os.path.join(below, name), folder) for below, _, names in os.walk(folder) for name in names}
    problems, count = [], 0
    if "index.html" not in pages:
        problems.append(f"{folder}: has no index.html")
    for page in pages.values():
        problems += [f"{page.path}:{page.line(place)}: {what}" for place, what in sorted(page.problems)]
        for place, kind, address in page.needs:
            count += 1
            if wrong := check_need(files, pages, page, kind, address):
                problems.append(f"{page.path}:{page.line(place)}: {address} {wrong}")
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
