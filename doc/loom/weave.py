#!/usr/bin/env python3
"""Weave the chapters of the book to HTML.

    weave.py --out DIR --work DIR --book DIR --report DIR --bibliography FILE.bib CHAPTER...

The chapters come in the order of the book; a chapter's folder is the part it
belongs to. --book holds the theme, the preface and the names of the parts
(book.ini); --report is where `malus reproduce` left its figures and
values.tex; --work keeps what LaTeXML made, so that only changed chapters are
converted again. Every problem is printed with its file and line, and leaves
the old book as it was.

noweb.py reads the chapters, listing.py renders their chunks, latexml.py
converts their prose, references.py reads the bibliography, and this program
joins them: it checks what the prose refers to, lays out the pages, and copies
the figures.
"""
import argparse
import concurrent.futures
import configparser
import os
import re
import shutil
import string
import sys
from html import escape, unescape

import latexml
import listing
import noweb
import references
from problems import Problem, Problems, stop_if_any

FONTS = ["/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-regular.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-italic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bold.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bolditalic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre-math/texgyrepagella-math.otf"]

LABEL = re.compile(r"\\label\{([^}]*)\}")
REFERENCE = re.compile(r"\\(?:eq)?ref\{([^}]*)\}")
CITATION = re.compile(r"\\cite(?:\[[^\]]*\])?\{([^}]*)\}")
VALUE = re.compile(r"\\val\{([^}]*)\}")
FIGURE = re.compile(r"\\includegraphics(?:\[[^\]]*\])?\{([^}]*)\}")
MALUSVAL = re.compile(r"\\malusval\{([^}]*)\}\{(.*)\}\s*$")


class Page:
    """One page of the book; source is the file to edit, chapter its number (0: none)."""

    def __init__(self, name, source, latex, chapter=0):
        self.name, self.source, self.latex, self.chapter = name, source, latex, chapter
        self.file = name + ".html"
        self.title = self.body = ""
        self.sections = []  # (anchor, title)
        self.root = None    # LaTeXML's XML


def line_of(text, place):
    return text.count("\n", 0, place) + 1


def without_comments(latex):
    """The same text, same length, comments blanked, so that what stands in them is not looked for."""
    return re.sub(r"(?<!\\)%[^\n]*", lambda match: " " * len(match[0]), latex)


# ---------------------------------------------------------------- what the prose refers to
class Links:
    """Labels, citations, values and figures of all pages: each must exist."""

    def __init__(self, options):
        self.options = options
        self.bibliography = references.read(options.bibliography)
        self.values = self.read_values(os.path.join(options.report, "values.tex"))
        self.labels = {}       # label -> (page, anchor, number)
        self.cited = {}        # key -> pages that cite it
        self.figures = {}      # name in \includegraphics -> file
        self.anchors = {}      # noweb's label -> (page file, anchor)

    @staticmethod
    def read_values(path):
        values = {}
        if os.path.exists(path):
            with open(path, encoding="utf-8") as lines:
                for number, line in enumerate(lines, 1):
                    if line.strip() and not line.startswith("%"):
                        entry = MALUSVAL.match(line)
                        if not entry:
                            raise Problem(path, number, r"expected \malusval{ID.name}{text}")
                        values[entry[1]] = entry[2]
        return values

    def find_figure(self, name):
        for folder in (self.options.report, os.path.join(self.options.book, "figures")):
            for ending in (".svg", ".png"):
                path = os.path.join(folder, name + ending)
                if os.path.isfile(path):
                    return path
        return None

    def check(self, pages):
        """Everything the prose refers to exists; all that does not is told at once."""
        problems, defined = [], {}
        for page in pages:
            for label in LABEL.finditer(without_comments(page.latex)):
                if label[1] in defined:
                    problems.append(Problem(page.source, line_of(page.latex, label.start()),
                                            f"label {label[1]} is also defined in {defined[label[1]]}"))
                defined[label[1]] = page.source
        for page in pages:
            text = without_comments(page.latex)

            def complain(match, sentence):
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
        stop_if_any(problems)

    def substitute(self, page):
        """Puts values into the prose and leaves a hole for each figure. (Comments may name what does not exist.)"""
        latex = VALUE.sub(lambda match: self.values.get(match[1], ""), page.latex)
        page.latex = FIGURE.sub(lambda match: rf"\litfigure{{{match[1]}}}", latex)

    def bibliography_page(self):
        keys = references.ordered(self.cited, self.bibliography)
        self.numbers = {key: number for number, key in enumerate(keys, 1)}
        entries = [rf"\litentry{{{key}}}{{{references.latex(self.bibliography[key])}}}" for key in keys]
        return Page("bibliography", self.options.bibliography, "\\chapter*{Bibliography}\n" + "\n".join(entries))

    def to_label(self, page):
        def address(label):
            home, anchor, number = self.labels[label]
            title = "" if home is page else home.source
            return ("" if home is page else home.file) + "#" + anchor, number or "here", title
        return address

    def to_entry(self, key):
        entry = self.bibliography[key]
        title = f"{references.family(entry)} {entry.get('year', '')}".strip()
        return f"bibliography.html#{key}", str(self.numbers[key]), title


# ---------------------------------------------------------------- from LaTeXML's HTML to a page's body
class Finisher:
    """Fills the holes in LaTeXML's HTML and makes it ours."""

    HOLE = re.compile(r'<div class="ltx_para">\s*<p class="ltx_p lit-chunk">([^<]*)</p>\s*</div>')
    BARE_HOLE = re.compile(r'<p class="ltx_p lit-chunk">([^<]*)</p>')
    HEADING = re.compile(r'(<section id="([^"]*)" class="ltx_(\w+)[^"]*">\s*)<h\d( class="ltx_title[^"]*")>(.*?)</h\d>',
                         re.DOTALL)
    FIGURE = re.compile(r'<span class="ltx_text lit-figure">([^<]*)</span>')
    PRIME = re.compile(r"<msup>(<m[io][^>]*>[^<]*</m[io]>)<mo>([′″])</mo></msup>")
    PRIME_AND_INDEX = re.compile(r"<msubsup>(<m[io][^>]*>[^<]*</m[io]>)(<m\w[^>]*>[^<]*</m\w>)<mo>([′″])</mo></msubsup>")
    LEVELS = {"chapter": 1, "section": 2, "subsection": 3, "subsubsection": 4, "paragraph": 5}

    def __init__(self, links, chapters, listings):
        self.links, self.listings = links, listings
        self.chunks = {chunk.label: chunk for chapter in chapters for chunk in chapter.chunks}

    def finish(self, page, html):
        fill = lambda match: self.listings.chunk(self.chunks[match[1]], self.links.anchors[match[1]][1])
        html = self.BARE_HOLE.sub(fill, self.HOLE.sub(fill, html))
        html = html.replace(' title=""', "").replace("\n\n", "\n")
        html = re.sub(r'\s*<span class="ltx_tag ltx_tag_note">.*?</span>\s*', "", html)
        # the font's prime is raised already; raised again it would be small and high
        html = self.PRIME.sub(r'<mrow>\1<mo lspace="0" rspace="0">\2</mo></mrow>', html)
        html = self.PRIME_AND_INDEX.sub(r'<msub><mrow>\1<mo lspace="0" rspace="0">\3</mo></mrow>\2</msub>', html)
        html = self.HEADING.sub(lambda match: self.heading(page, match), html)
        html = self.FIGURE.sub(lambda match: self.figure(match, html), html)
        page.body = self.resolve(page, html)
        page.title = page.title or page.name

    def heading(self, page, match):
        before, anchor, kind, classes, title = match.groups()
        plain = re.sub(r"</?a\b[^>]*>", "", title).strip()
        if kind == "chapter":
            page.title = re.sub(r'<span class="ltx_tag[^>]*>.*?</span>', "", plain, flags=re.DOTALL).strip()
        elif kind == "section":
            page.sections.append((anchor, plain))
        level = self.LEVELS.get(kind, 6)
        mark = f'<a class="permalink" href="#{anchor}" title="a link to this place" aria-label="a link to this place">§</a>'
        source = ""
        if kind == "chapter":
            source = f'\n<p class="source">Edit this chapter: <code>{escape(page.source)}</code></p>'
        return f"{before}<h{level}{classes}>{title.strip()} {mark}</h{level}>{source}"

    def figure(self, match, html):
        """A picture; its words for those who cannot see it are its caption."""
        name = unescape(match[1])
        path = self.links.figures[name]
        caption = re.search(r"<figcaption[^>]*>(.*?)</figcaption>", html[match.end():], re.DOTALL)
        words = ""
        if caption and "<figure" not in html[match.end():match.end() + caption.start()]:
            formulas = re.sub(r'<math[^>]*alttext="([^"]*)".*?</math>', r"\1", caption[1], flags=re.DOTALL)
            words = " ".join(unescape(re.sub(r"<[^>]*>", "", formulas)).split())
        kind = os.path.splitext(path)[1]
        return f'<img src="figures/{escape(name)}{kind}" alt="{escape(words, quote=True)}"{size_of(path)}>'

    def resolve(self, page, html):
        """Addresses of chunks, now that it is known on which page each stands."""
        def address(match):
            home, anchor = self.links.anchors[match[1]]
            return f'href="{"" if home == page.file else home}#{anchor}"'
        return re.sub(r'href="chunk:([^"]*)"', address, html)


def size_of(path):
    """Width and height of an SVG, so that the text does not jump when it arrives."""
    if not path.endswith(".svg"):
        return ""
    with open(path, encoding="utf-8") as file:
        head = file.read(2000)
    box = re.search(r'viewBox="\s*[\d.]+\s+[\d.]+\s+([\d.]+)\s+([\d.]+)', head)
    return f' width="{float(box[1]):.0f}" height="{float(box[2]):.0f}"' if box else ""


# ---------------------------------------------------------------- the book
class Part:
    """A floor of the house: its folder, title, what it is about, and its pages."""

    def __init__(self, folder, title, about):
        self.folder, self.title, self.about = folder, title, about
        self.pages = []


class Book:
    """All pages, in parts, and the layout around them."""

    def __init__(self, options):
        self.options = options
        self.about = configparser.ConfigParser()
        self.about.read(os.path.join(options.book, "book.ini"), encoding="utf-8")
        with open(os.path.join(options.book, "page.html"), encoding="utf-8") as file:
            self.template = string.Template(file.read())
        self.chapters = noweb.read(options.chapters)
        self.links = Links(options)
        self.listings = listing.Listing(self.chapters)
        self.parts, self.front, self.back = [], [], []

    def gather(self):
        """A page for each chapter. What is numbered as a chapter says \\chapter, the rest \\chapter*."""
        parts, number = {}, 0
        for chapter in self.chapters:
            folder = os.path.basename(os.path.dirname(chapter.path))
            name = os.path.splitext(os.path.basename(chapter.path))[0]
            latex = chapter.latex()
            numbered = re.search(r"\\chapter\{", latex) is not None
            number += numbered
            in_front = folder not in self.about
            page = Page(name if in_front else f"{folder}-{name}", chapter.path, latex, number if numbered else 0)
            if in_front:
                self.front.append(page)
            else:
                if folder not in parts:
                    about = self.about[folder]
                    parts[folder] = Part(folder, about["title"], about["about"])
                    self.parts.append(parts[folder])
                parts[folder].pages.append(page)
            self.name_chunks(chapter, page)

    def name_chunks(self, chapter, page):
        problems, taken = [], set()
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

    def pages(self):
        """In reading order."""
        return self.front + [page for part in self.parts for page in part.pages] + self.back

    def convert(self):
        """Prose to HTML: check what it refers to, then LaTeXML's two steps, both for many chapters at once."""
        self.links.check(self.pages())
        self.back.append(self.links.bibliography_page())
        pages = self.pages()
        for page in pages:
            self.links.substitute(page)
        converter = latexml.Converter(self.options.work, self.options.book)

        def first(page):
            page.root = converter.to_xml(page.name, page.source, page.latex, page.chapter)

        def second(page):
            latexml.resolve(page.root, self.links.to_label(page), self.links.to_entry)
            return converter.to_html(page.name, page.source, page.root)

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            all_of(pool, first, sorted(pages, key=lambda page: -len(page.latex)))  # the longest first: no long tail
            for page in pages:
                for label, (anchor, number, _) in latexml.give_addresses(page.root).items():
                    self.links.labels[label] = (page, anchor, number)
            bodies = all_of(pool, second, pages)
        finisher = Finisher(self.links, self.chapters, self.listings)
        for page, body in zip(pages, bodies):
            finisher.finish(page, body)
        self.number_entries(self.back[0])
        self.add_indexes(finisher)

    def number_entries(self, page):
        """The bibliography's entries get their numbers, and links to the chapters that cite them."""
        def entry(match):
            key = match[1]
            where = ", ".join(f'<a href="{cited.file}">{cited.title}</a>' for cited in self.links.cited[key])
            return (f'<p id="{key}" class="entry"><span class="number">[{self.links.numbers[key]}]</span> '
                    f'{match[2]} <span class="cited">Cited in {where}.</span></p>')
        page.body = re.sub(r'<p id="([^"]*)" class="ltx_p lit-entry">(.*?)</p>', entry, page.body, flags=re.DOTALL)

    def add_indexes(self, finisher):
        for name, title, table in (("chunks", "Chunks", self.listings.chunk_index()),
                                   ("identifiers", "Identifiers", self.listings.identifier_index())):
            page = Page(name, "", "")
            page.title = title
            page.body = finisher.resolve(page, f"<h1>{title}</h1>\n{table}")
            self.back.insert(-1, page)

    # ------------------------------------------------------------ layout
    def entry(self, page, current):
        number = f'<span class="number">{page.chapter}</span> ' if page.chapter else ""
        here = ' aria-current="page"' if page is current else ""
        out = f'<li><a href="{page.file}"{here}>{number}{page.title}</a>'
        if page is current and page.sections:
            items = "".join(f'<li><a href="#{anchor}">{title}</a></li>' for anchor, title in page.sections)
            out += f"<ol>{items}</ol>"
        return out + "</li>"

    def contents(self, current):
        """The navigation beside each page: the part that is being read stands open."""
        out = ['<ol>' + "".join(self.entry(page, current) for page in self.front) + "</ol>"]
        for part in self.parts:
            is_open = " open" if current in part.pages or not current else ""
            items = "".join(self.entry(page, current) for page in part.pages)
            out.append(f"<details{is_open}><summary>{part.title}</summary><ol>{items}</ol></details>")
        out.append('<ol>' + "".join(self.entry(page, current) for page in self.back) + "</ol>")
        return "\n".join(out)

    def layout(self, page, before, after):
        def neighbour(other, kind):
            return f'<a rel="{kind}" href="{other.file}">{other.title}</a>' if other else "<span></span>"
        title = " ".join(re.sub(r"<[^>]*>", "", page.title).split())
        return self.template.substitute(
            title=f"{title} - {self.about['book']['title']}" if page.name != "index" else title,
            book=self.about["book"]["title"], name=page.name, contents=self.contents(page), body=page.body,
            previous=neighbour(before, "prev"), next=neighbour(after, "next"))

    def title_page(self):
        """The first page: what the book is, and the house it describes, the ground floor below."""
        about, page = self.about["book"], Page("index", "", "")
        page.title = about["title"]
        floors = []
        for part in reversed(self.parts):
            chapters = "".join(f'<li><a href="{chapter.file}">{chapter.title}</a></li>' for chapter in part.pages)
            floors.append(f'<section class="floor"><h2>{part.title}</h2><p>{part.about}</p>'
                          f'<ol start="{part.pages[0].chapter}">{chapters}</ol></section>')
        first = self.front[0] if self.front else self.parts[0].pages[0]
        page.body = (f'<header class="title-page"><h1>{about["title"]}</h1><p class="subtitle">{about["subtitle"]}</p>'
                     f'<p class="after">{about["after"]}</p><p><a href="{first.file}">{about["begin"]}</a></p></header>'
                     f'<p class="map-says">{about["map"]}</p>\n<div class="map">\n' + "\n".join(floors) + "\n</div>")
        return page

    def write(self):
        """Writes what changed, and removes what no longer belongs to the book."""
        out, wanted = self.options.out, set()

        def put(name, content):
            wanted.add(name)
            path = os.path.join(out, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            if os.path.exists(path):
                with open(path, "rb") as old:
                    if old.read() == content:
                        return
            with open(path, "wb") as new:
                new.write(content)

        def copy(name, path):
            with open(path, "rb") as file:
                put(name, file.read())

        pages = [self.title_page()] + self.pages()
        for i, page in enumerate(pages):
            before, after = (pages[i - 1] if i else None), (pages[i + 1] if i + 1 < len(pages) else None)
            put(page.file, self.layout(page, before, after).encode())
        copy("book.css", os.path.join(self.options.book, "book.css"))
        for font in FONTS:
            if not os.path.exists(font):
                raise Problem(font, 0, "not found; Debian's packages fonts-texgyre and fonts-texgyre-math bring it")
            copy("fonts/" + os.path.basename(font), font)
        for name, path in self.links.figures.items():
            copy(f"figures/{name}{os.path.splitext(path)[1]}", path)
        for folder, _, files in os.walk(out, topdown=False):
            for file in files:
                if os.path.relpath(os.path.join(folder, file), out) not in wanted:
                    os.remove(os.path.join(folder, file))
            if not os.listdir(folder):
                os.rmdir(folder)


def all_of(pool, work, items):
    """Results of work on all items; the problems of all of them, if there are any."""
    results, problems = [], []
    for future in [pool.submit(work, item) for item in items]:
        try:
            results.append(future.result())
        except (Problem, Problems) as found:
            problems.append(found)
    stop_if_any(problems)
    return results


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("out", "work", "book", "report", "bibliography"):
        arguments.add_argument("--" + name, required=True)
    arguments.add_argument("chapters", nargs="+")
    options = arguments.parse_args()
    try:
        book = Book(options)
        book.gather()
        book.convert()
        book.write()
    except (Problem, Problems) as found:
        print(found, file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
