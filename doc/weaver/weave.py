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
import filecmp
import os
import re
import shutil
import string
from html import escape, unescape

import book
import finder
import latexml
import listing
import references
from book import Page
from problems import Problem

FONTS = ["/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-regular.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-italic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bold.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bolditalic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre-math/texgyrepagella-math.otf"]

INDEXES = {"chunks": "Chunks", "identifiers": "Identifiers"}

# ---------------------------------------------------------------- from LaTeXML's HTML to a page's body
class Finisher:
    """Fills the holes in LaTeXML's HTML and makes it ours."""

    HOLE = re.compile(r'<div class="ltx_para">\s*<p class="ltx_p lit-chunk">([^<]*)</p>\s*</div>')
    BARE_HOLE = re.compile(r'<p class="ltx_p lit-chunk">([^<]*)</p>')
    HEADING = re.compile(r'(<section id="([^"]*)" class="ltx_(\w+)[^"]*">\s*)<h\d( class="ltx_title[^"]*")>(.*?)</h\d>',
                         re.DOTALL)
    FIGURE = re.compile(r'<span class="ltx_text lit-figure">([^<]*)</span>')
    TABLE = re.compile(r"<table\b.*?</table>", re.DOTALL)
    LONG_FORMULA = re.compile(r'<math[^>]*alttext="(?!\\displaystyle)[^"]{46,}" display="inline".*?</math>', re.DOTALL)
    GLUED = re.compile(r"""([(\[“‘]*)(<math\b[^>]*display="inline".*?</math>)([.,;:?!)\]”’]*)""", re.DOTALL)
    FENCE = re.compile(r"(<mo)(>[(\[|‖{]</mo><mtable)|(</mtable><mo)(>[)\]|‖}]</mo>)")
    PRIME = re.compile(r"<msup>(<m[io][^>]*>[^<]*</m[io]>)<mo>([′″])</mo></msup>")
    PRIME_AND_INDEX = re.compile(r"<msubsup>(<m[io][^>]*>[^<]*</m[io]>)(<m\w[^>]*>[^<]*</m\w>)<mo>([′″])</mo></msubsup>")
    KINDS = {"as derived": " cards errata", "left open": " cards left-open", "ltx_eqn": " formula"}  # what a table's head says
    LEVELS = {"chapter": 1, "section": 2, "subsection": 3, "subsubsection": 4, "paragraph": 5}

    def __init__(self, links, listings):
        self.links, self.listings = links, listings
        self.rendered = {}  # label -> the chunk as HTML

    def render_chunks(self, page):
        for chunk in page.chunks:
            self.rendered[chunk.label] = self.listings.chunk(chunk, self.links.anchors[chunk.label][1])

    def finish(self, page, html):
        fill = lambda match: self.rendered[match[1]]
        html = self.BARE_HOLE.sub(fill, self.HOLE.sub(fill, html))
        html = html.replace(' title=""', "").replace("\n\n", "\n")
        # paper's sizes: the style sheet says how small a table is and the browser how wide its columns are; a formula
        # whose every letter has a size would have no small indices
        html = re.sub(r' mathsize="\d+%"| style="font-size:\d+%;"| style="width:[\d.]+pt;"', "", html)
        # what may be wider than a phone scrolls by itself
        html = self.TABLE.sub(self.scroll, html)
        html = self.GLUED.sub(self.glue, html)
        html = self.LONG_FORMULA.sub(lambda formula: f'<span class="long">{formula[0]}</span>', html)
        html = re.sub(r'\s*<span class="ltx_tag ltx_tag_note">.*?</span>\s*', "", html)
        # as TeX does, a little space around what is in large brackets
        html = self.FENCE.sub(lambda fence: f'{fence[1]} lspace="0.17em"{fence[2]}' if fence[1] else
                              f'{fence[3]} rspace="0.17em"{fence[4]}', html)
        # the font's prime is raised already; raised again it would be small and high
        html = self.PRIME.sub(r'<mrow>\1<mo lspace="0" rspace="0">\2</mo></mrow>', html)
        html = self.PRIME_AND_INDEX.sub(r'<msub><mrow>\1<mo lspace="0" rspace="0">\3</mo></mrow>\2</msub>', html)
        self.above = 0
        html = self.HEADING.sub(lambda match: self.heading(page, match), html)
        html = self.FIGURE.sub(lambda match: self.figure(page, match, html), html)
        page.body = self.resolve(page, html)
        page.title = page.title or page.name

    @staticmethod
    def scroll(table):
        head = table[0][:table[0].find("</tr>")]
        kind = next((kind for words, kind in Finisher.KINDS.items() if words in head), "")
        return f'<div class="scroll{kind}">{table[0]}</div>'

    @staticmethod
    def glue(match):
        """A browser may break a line on either side of a formula; a bracket or a comma must not be left alone."""
        before, formula, after = match.groups()
        return f'<span class="glued">{before}{formula}{after}</span>' if before or after else formula

    def heading(self, page, match):
        before, anchor, kind, classes, title = match.groups()
        plain = re.sub(r"</?a\b[^>]*>", "", title).strip()
        if kind == "chapter":
            page.title = re.sub(r'<span class="ltx_tag[^>]*>.*?</span>', "", plain, flags=re.DOTALL).strip()
        elif kind == "section":
            page.sections.append((anchor, plain))
        level = min(self.LEVELS.get(kind, 6), self.above + 1)  # a paragraph may stand in a section or deeper
        self.above = level if kind != "paragraph" else self.above
        mark = f'<a class="permalink" href="#{anchor}" title="a link to this place" aria-label="a link to this place">§</a>'
        source = ""
        if kind == "chapter":
            source = f'\n<p class="source">Edit this chapter: <code>{escape(page.source)}</code></p>'
        return f"{before}<h{level}{classes}>{title.strip()} {mark}</h{level}>{source}"

    def figure(self, page, match, html):
        """A picture; its words for those who cannot see it are its caption. A drawing with links is put into the page."""
        name = unescape(match[1])
        path = self.links.figures[name]
        caption = re.search(r"<figcaption[^>]*>(.*?)</figcaption>", html[match.end():], re.DOTALL)
        words = ""
        if caption and "<figure" not in html[match.end():match.end() + caption.start()]:
            formulas = re.sub(r'<math[^>]*alttext="([^"]*)".*?</math>', r"\1", caption[1], flags=re.DOTALL)
            words = " ".join(unescape(re.sub(r"<[^>]*>", "", formulas)).split())
        if drawing := self.links.drawing(name):
            drawing = book.DRAWN_LINK.sub(lambda link: link[0].replace(link[1], self.address_of(page, link[1]), 1), drawing)
            return drawing.replace("<svg ", f'<svg class="drawn" role="group" aria-label="{escape(words, quote=True)}" ', 1)
        kind = os.path.splitext(path)[1]
        return f'<img src="figures/{escape(name)}{kind}" alt="{escape(words, quote=True)}"{size_of(path)}>'

    def address_of(self, page, label):
        home, anchor, _ = self.links.labels[label]
        return ("" if home is page else home.file) + "#" + anchor

    def resolve(self, page, html):
        """Addresses of chunks and items, now that it is known on which page each stands."""
        an_item = re.compile(r'<span class="ltx_text lit-item ([^"]*)"[^>]*>')
        html = an_item.sub(r'<span class="lit-item" id="item-\1">', html)

        def item(match):
            return f'href="{"" if self.links.inventory is page else self.links.inventory.file}#item-{match[1]}"'
        html = re.sub(r'href="item:([^"]*)"', item, html)

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
class HtmlBook(book.Book):
    """The book, laid out as pages of HTML."""

    def __init__(self, options):
        super().__init__(options)
        self.listings = listing.HtmlListing(self.chapters, self.names)
        with open(os.path.join(options.book, "page.html"), encoding="utf-8") as file:
            self.template = string.Template(file.read())

    def to_label(self, page):
        def address(label):
            home, anchor, number = self.links.labels[label]
            title = "" if home is page else home.source
            return ("" if home is page else home.file) + "#" + anchor, number or "here", title
        return address

    def to_entry(self, key):
        entry = self.links.bibliography[key]
        title = f"{references.family(entry)} {entry.get('year', '')}".strip()
        return f"bibliography.html#{key}", str(self.links.numbers[key]), title

    def convert(self):
        """Prose to HTML: check what it refers to, then LaTeXML's two steps, both for many chapters at once."""
        self.links.check(self.pages())
        self.back.append(self.links.bibliography_page())
        pages = self.pages()
        for page in pages:
            self.substitute(page)
        converter = latexml.Converter(self.options.work, self.options.book)

        finisher = Finisher(self.links, self.listings)
        for page in converter.to_xml(pages):
            for label, (anchor, number, _) in latexml.give_addresses(page.root).items():
                self.links.labels[label] = (page, anchor, number)
            finisher.render_chunks(page)  # there is time for it while LaTeXML works
        for page in pages:
            page.addresses = latexml.resolve(page.root, self.to_label(page), self.to_entry)
        for page, body in converter.to_html(pages):
            finisher.finish(page, body)
        self.number_entries(self.back[-1])
        for part in self.parts:
            part.page = self.part_page(part)
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
        tables = (self.listings.chunk_index(), self.listings.identifier_index())
        for (name, title), table in zip(INDEXES.items(), tables):
            page = Page(name, "", "")
            page.title = title
            page.body = finisher.resolve(page, f"<h1>{title}</h1>\n{table}")
            self.back.insert(-1, page)

    @staticmethod
    def part_page(part):
        """What a part is about, and how each of its chapters begins."""
        page = Page(part.folder, "", "")
        page.title = part.title
        chapters = "\n".join(f'<li value="{chapter.chapter}"><a href="{chapter.file}">{chapter.title}</a>'
                             f'{opening(chapter.body)}</li>' for chapter in part.pages)
        page.body = (f'<header class="part"><p class="kind">Part</p><h1>{part.title}</h1><p class="about">{part.about}</p></header>\n'
                     f'<ol class="chapters">\n{chapters}\n</ol>')
        return page

    def reading_order(self):
        """All pages as a reader turns them: a part begins with its own page."""
        parts = [page for part in self.parts for page in [part.page] + part.pages]
        return [self.title_page()] + self.front + parts + self.back

    def search_page(self):
        page = Page("search", "", "")
        page.title, page.body = "Search", finder.PAGE
        return page

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
            is_open = " open" if current is part.page or current in part.pages else ""
            here = ' aria-current="page"' if current is part.page else ""
            items = f'<li><a href="{part.page.file}"{here}>About this part</a></li>'
            items += "".join(self.entry(page, current) for page in part.pages)
            out.append(f"<details{is_open}><summary>{part.title}</summary><ol>{items}</ol></details>")
        out.append('<ol>' + "".join(self.entry(page, current) for page in self.back) + "</ol>")
        return "\n".join(out)

    def layout(self, page, before, after):
        def neighbour(other, kind):
            return f'<a rel="{kind}" href="{other.file}">{other.title}</a>' if other else "<span></span>"

        above = next((part.page for part in self.parts if page in part.pages), None)
        up = "" if page.name == "index" else neighbour(above, "up") if above else '<a rel="up" href="index.html">Title page</a>'
        turn = f"{neighbour(before, 'prev')} {up} {neighbour(after, 'next')}"
        title = " ".join(re.sub(r"<[^>]*>", "", page.title).split())
        return self.template.substitute(
            title=f"{title} - {self.about['book']['title']}" if page.name != "index" else title,
            book=self.about["book"]["title"], name=page.name, contents=self.contents(page), body=page.body,
            turn=turn)

    def title_page(self):
        """The first page: what the book is, and the house it describes, the ground floor below."""
        about, page = self.about["book"], Page("index", "", "")
        page.title = about["title"]
        floors = []
        for part in reversed(self.parts):
            chapters = "".join(f'<li><a href="{chapter.file}">{chapter.title}</a></li>' for chapter in part.pages)
            floors.append(f'<section class="floor"><h2><a href="{part.page.file}">{part.title}</a></h2><p>{part.about}</p>'
                          f'<ol start="{part.pages[0].chapter}">{chapters}</ol></section>')
        first = self.front[0] if self.front else self.parts[0].pages[0]
        page.body = (f'<header class="title-page"><h1>{about["title"]}</h1><p class="subtitle">{about["subtitle"]}</p>'
                     f'<p class="after">{about["after"]}</p>{self.title_picture()}'
                     f'<p class="begin"><a href="{first.file}">{about["begin"]}</a></p></header>'
                     f'<p class="map-says">{about["map"]}</p>\n<div class="map">\n' + "\n".join(floors) + "\n</div>")
        return page

    def title_picture(self):
        """One of the book's figures, if a chapter shows it; its caption leads there."""
        about = self.about["book"]
        name = about["picture"]
        path = self.links.figures.get(name)
        home = next((page for page in self.pages() if f'src="figures/{name}.' in page.body), None)
        if not path or not home:
            return ""
        words = re.sub(r"<[^>]*>", "", about["caption"])
        return (f'<figure><img src="figures/{name}{os.path.splitext(path)[1]}" alt="{escape(words, quote=True)}"{size_of(path)}>'
                f'<figcaption>{about["caption"]} <a href="{home.file}">{home.title}</a></figcaption></figure>')

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
            wanted.add(name)
            there = os.path.join(out, name)
            os.makedirs(os.path.dirname(there), exist_ok=True)
            if not os.path.exists(there) or not filecmp.cmp(path, there):  # looks into files only if their times differ
                shutil.copy2(path, there)

        pages = self.reading_order()
        for i, page in enumerate(pages):
            before, after = (pages[i - 1] if i else None), (pages[i + 1] if i + 1 < len(pages) else None)
            put(page.file, self.layout(page, before, after).encode())
        search = self.search_page()
        put(search.file, self.layout(search, None, None).encode())
        put("search-index.js", finder.index([page for page in self.pages() if page.name not in INDEXES],
                                            self.listings.identifiers).encode())
        copy("search.js", os.path.join(self.options.book, "search.js"))
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


def opening(body):
    """A paragraph with the first sentence of a chapter, without its links, citations and notes."""
    paragraph = re.search(r'<p class="ltx_p">(.*?)</p>', body, re.DOTALL)
    html = re.sub(r"\s*<cite\b.*?</cite>|</?a\b[^>]*>", "", paragraph[1] if paragraph else "", flags=re.DOTALL)
    sentence = re.match(r".{30,}?[a-z0-9)”>][.?!](?=\s+[A-Z“(]|\s*$)", html.split('<span class="ltx_note')[0].strip(), re.DOTALL)
    return f"<p>{sentence[0]}</p>" if sentence and balanced(sentence[0]) else ""


def balanced(html):
    """Whether what opens in a piece of HTML closes there."""
    return all(len(re.findall(rf"<{tag}\b", html)) == html.count(f"</{tag}>") for tag in ("span", "em", "math", "code", "i", "b"))


def main(options):
    whole = HtmlBook(options)
    whole.gather()
    whole.convert()
    whole.write()


if __name__ == "__main__":
    book.run(__doc__, main)
