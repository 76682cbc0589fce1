#!/usr/bin/python3
"""Weave the chapters of the book to HTML.

    weave.py --out DIR --work DIR --book DIR --report DIR --bibliography FILE.bib CHAPTER...

--book holds the theme, the preface and book.ini, which says to which part of
which volume a chapter belongs and in which order they are read; --report is where `malus reproduce` left its figures and
values.tex; --work keeps what LaTeXML made, so that only changed chapters are
converted again. Every problem is printed with its file and line, and leaves
the old book as it was.

noweb.py reads the chapters, listing.py renders their chunks, latexml.py
converts their prose, references.py reads the bibliography, tested.py the tests, and this program
joins them: it checks what the prose refers to, finishes the trees of the
pages, fills in the templates of the theme, and copies the figures.
"""
import argparse
import copy
import filecmp
import functools
import os
import re
import shutil
from html import escape
from typing import Any

import jinja2
import lxml.html
from lxml import etree
from lxml.builder import E

import book
import contents
import finder
import latexml
import listing
import tested
from book import Page
from problems import Problem

FONTS = ["/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-regular.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-italic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bold.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre/texgyrepagella-bolditalic.otf",
         "/usr/share/texmf/fonts/opentype/public/tex-gyre-math/texgyrepagella-math.otf"]

INDEXES = {"chunks": "Chunks", "identifiers": "Identifiers", "tests": "Tests"}
TESTED = "How it is tested"  # the section that ends with the table of the tests
Element = Any  # lxml brings no types


# ---------------------------------------------------------------- trees
def inner(element: Element) -> str:
    """The HTML between the tags of an element."""
    text: str = lxml.html.tostring(element, encoding="unicode", with_tail=False)
    return text[text.index(">") + 1:text.rindex("<")]


def has_class(element: Element, name: str) -> bool:
    """Whether it is one of the element's classes."""
    return name in element.get("class", "").split()


def replace(old: Element, new: Element) -> None:
    """Puts an element in the place of another."""
    new.tail = old.tail
    old.getparent().replace(old, new)


def wrap(element: Element, wrapper: Element) -> None:
    """Puts an element into a new one, which takes its place."""
    replace(element, wrapper)
    element.tail = None
    wrapper.append(element)


def text_before(element: Element) -> str:
    """The text between an element and the tag before it."""
    before = element.getprevious()
    return (before.tail if before is not None else element.getparent().text) or ""


def set_text_before(element: Element, text: str) -> None:
    """Replaces the text between an element and the tag before it."""
    before = element.getprevious()
    if before is not None:
        before.tail = text
    else:
        element.getparent().text = text


def is_bare(element: Element, tags: tuple[str, ...], letters: str) -> bool:
    """Whether an element has one of these tags, no attributes, and one of these letters as its text."""
    return (element is not None and element.tag in tags and not element.attrib and len(element) == 0
            and bool(element.text) and len(element.text) == 1 and element.text in letters)


# ---------------------------------------------------------------- from LaTeXML's HTML to a page's body
class Finisher:
    """Fills the holes in LaTeXML's HTML and makes it ours."""

    OPENING, CLOSING = "([“‘", ".,;:?!)]”’"  # what must not be parted from a formula by the end of a line
    LONG = 46  # a formula whose source has more letters may be broken
    KINDS = {"as derived": " cards errata", "left open": " cards left-open"}  # what a table's head says
    LEVELS = {"chapter": 1, "section": 2, "subsection": 3, "subsubsection": 4, "paragraph": 5}
    HOLE = re.compile(r"<!--hole (\d+)-->")
    PAPER = re.compile(r"font-size:\d+%;|width:[\d.]+pt;")

    def __init__(self, links: book.Links, listings: listing.HtmlListing) -> None:
        self.links, self.listings = links, listings
        self.rendered: dict[str, str] = {}  # label -> the chunk as HTML
        self.test_pages: dict[str, str] = {}  # path of a file of tests -> its page
        self.holes: list[str] = []  # what is HTML already, chunks and drawings; put in when the tree becomes text

    def render_chunks(self, page: Page) -> None:
        """The chunks of a page as HTML."""
        for chunk in page.chunks:
            self.rendered[chunk.label] = self.listings.chunk(chunk, self.links.anchors[chunk.label][1])

    def finish(self, page: Page) -> None:
        """All that is done to the tree of a page."""
        for chunk in page.tree.xpath('.//p[@class="ltx_p lit-chunk"]'):
            self.chunk(chunk)
        for figure in page.tree.xpath('.//p[@class="ltx_p lit-live"]'):
            self.live_figure(figure)
        for element in page.tree.iter(etree.Element):
            self.without_paper(element)
        for table in page.tree.xpath(".//table"):
            self.scroll(table)
        for formula in page.tree.xpath('.//math[@display="inline"]'):
            self.glue(formula)
        for tag in page.tree.xpath('.//span[@class="ltx_tag ltx_tag_note"]'):
            self.drop_with_space(tag)
        for matrix in page.tree.xpath(".//mtable"):
            self.space_in_brackets(matrix)
        for raised in page.tree.xpath(".//msup | .//msubsup"):
            self.lower_prime(raised)
        for terms in page.tree.xpath('.//dl[@class="ltx_description"]'):
            self.run_in(terms)
        self.headings(page)
        for figure in page.tree.xpath('.//span[@class="ltx_text lit-figure"]'):
            self.figure(page, figure)
        self.link_items(page)
        for code in page.tree.xpath('.//span[contains(@class, "ltx_font_typewriter") or contains(@class, "lit-code")]'):
            self.test_file(code)
        page.title = page.title or page.name

    def hole(self, html: str) -> Element:
        """Represents finished HTML."""
        self.holes.append(html)
        return etree.Comment(f"hole {len(self.holes) - 1}")

    def text(self, page: Page) -> str:
        """The tree as HTML, with the chunks and drawings in it."""
        html = inner(page.tree).removeprefix("\n").replace("\n\n", "\n")
        return self.resolve(page, self.HOLE.sub(lambda match: self.holes[int(match[1])], html))

    def chunk(self, place: Element) -> None:
        """A chunk is not in a paragraph."""
        around = place.getparent()
        hole = self.hole(self.rendered[place.text].replace("\n\n", "\n"))
        alone = len(around) == 1 and not (around.text or "").strip() and not (place.tail or "").strip()
        replace(around if around.get("class") == "ltx_para" and alone else place, hole)

    def without_paper(self, element: Element) -> None:
        """Drops paper's sizes: the style sheet says how small a table is and the browser how wide its columns are; a
        formula whose every letter has a size would have no small indices."""
        if element.get("title") == "":
            del element.attrib["title"]
        if re.fullmatch(r"\d+%", element.get("mathsize", "")):
            del element.attrib["mathsize"]
        if self.PAPER.fullmatch(element.get("style", "")):
            del element.attrib["style"]

    def scroll(self, table: Element) -> None:
        """Elements that may be wider than a phone scroll separately."""
        head = table.find(".//tr").text_content()
        kind = next((kind for words, kind in self.KINDS.items() if words in head), "")
        if not kind and "ltx_eqn" in table.get("class", ""):
            kind = " formula"
        wrap(table, E.div({"class": "scroll" + kind}))

    def glue(self, formula: Element) -> None:
        """A browser may break a line on either side of a formula; a bracket or a comma must not be left alone."""
        text, tail = text_before(formula), formula.tail or ""
        before, after = text[len(text.rstrip(self.OPENING)):], tail[:len(tail) - len(tail.lstrip(self.CLOSING))]
        source = formula.get("alttext", "")
        if before or after:
            set_text_before(formula, text[:len(text) - len(before)])
            formula.tail = tail[len(after):]
            glued = E.span({"class": "glued"})
            wrap(formula, glued)
            glued.text, formula.tail = before, after
        if len(escape(source, quote=False)) >= self.LONG and not source.startswith(r"\displaystyle"):
            after, formula.tail = formula.tail, None
            wrap(formula, E.span({"class": "long"}))
            formula.getparent().tail = after

    @staticmethod
    def drop_with_space(element: Element) -> None:
        """Drops an element and the space around it."""
        set_text_before(element, text_before(element).rstrip())
        element.tail = (element.tail or "").lstrip()
        element.drop_tree()

    @staticmethod
    def space_in_brackets(matrix: Element) -> None:
        """As TeX does, a little space around what is in large brackets."""
        if is_bare(matrix.getprevious(), ("mo",), "([|‖{"):
            matrix.getprevious().set("lspace", "0.17em")
        if is_bare(matrix.getnext(), ("mo",), ")]|‖}"):
            matrix.getnext().set("rspace", "0.17em")

    @staticmethod
    def lower_prime(raised: Element) -> None:
        """The font's prime is raised already; raised again it would be small and high."""
        base, *index, prime = raised
        if raised.attrib or base.tag not in ("mi", "mo") or len(base) or not is_bare(prime, ("mo",), "′″"):
            return
        if any(len(element) for element in index):
            return
        prime.set("lspace", "0")
        prime.set("rspace", "0")
        if raised.tag == "msup":
            raised.tag = "mrow"
        else:
            raised.tag = "msub"
            wrap(base, etree.Element("mrow"))
            base.getparent().append(prime)

    @staticmethod
    def run_in(terms: Element) -> None:
        """A list whose heads begin the sentences of its items becomes a list of sentences. A list of terms stays as it is."""
        pairs = list(zip(terms.findall("dt"), terms.findall("dd")))
        paragraphs = [body.find(".//p") for _, body in pairs]

        def begins(head: Element, paragraph: Element) -> bool:
            if head.xpath('.//*[contains(@class, "typewriter")]'):
                return False
            words, rest = head.text_content().strip(), paragraph.text_content().strip()
            return bool(words.endswith(",") or (words[-1:].isalpha() and rest[:1].islower()))
        if len(terms) != 2 * len(pairs) or None in paragraphs or not any(begins(head, p) for (head, _), p in zip(pairs, paragraphs)):
            return
        for (head, body), paragraph in zip(pairs, paragraphs):
            words = E.span({"class": "head"})
            words.text = head.text
            words.extend(list(head))
            words.tail, paragraph.text = " " + (paragraph.text or "").lstrip(), None
            paragraph.insert(0, words)
            body.tag = "li"
            body.attrib.update({name: value for name, value in head.attrib.items() if name == "id"})
            head.drop_tree()
        terms.tag = "ul"
        terms.set("class", "run-in")

    # ------------------------------------------------------------ headings and figures
    def headings(self, page: Page) -> None:
        """The headings get the levels of one page, and links to themselves."""
        above = 0
        for section in page.tree.xpath(".//section[@id]"):
            title = section[0]
            if not re.fullmatch(r"h\d", title.tag):
                continue
            kind = section.get("class").split()[0].removeprefix("ltx_")
            level = min(self.LEVELS.get(kind, 6), above + 1)  # a paragraph may be in a section or deeper
            above = level if kind != "paragraph" else above
            self.name(page, kind, section.get("id"), title)
            self.heading(section.get("id"), title, level)
            if kind == "chapter":
                source = E.p({"class": "source"}, "Edit this chapter: ", E.code(page.source))
                after, title.tail = title.tail, None
                title.addnext(source)
                title.tail, source.tail = "\n", after

    @staticmethod
    def name(page: Page, kind: str, anchor: str, title: Element) -> None:
        """The table of contents."""
        title = copy.deepcopy(title)
        etree.strip_tags(title, "a")
        if kind == "section":
            page.sections.append((anchor, inner(title).strip()))
        elif kind == "chapter":
            for tag in title.xpath('.//span[starts-with(@class, "ltx_tag")]'):
                tag.drop_tree()
            page.title = inner(title).strip()

    @staticmethod
    def heading(anchor: str, title: Element, level: int) -> None:
        """One heading."""
        title.tag = f"h{level}"
        title.text = (title.text or "").lstrip()
        mark = E.a({"class": "permalink", "href": "#" + anchor, "title": "a link to this place", "aria-label": "a link to this place"}, "§")
        title.append(mark)
        set_text_before(mark, text_before(mark).rstrip() + " ")

    def figure(self, page: Page, place: Element) -> None:
        """A picture; its words for those who cannot see it are its caption. A drawing with links is put into the page."""
        name = place.text
        path = self.links.figures[name]
        after = place.xpath("following::*[self::figcaption or self::figure][1]")
        words = ""
        if after and after[0].tag == "figcaption":
            caption = copy.deepcopy(after[0])
            for formula in caption.xpath(".//math"):
                tail, source = formula.tail, formula.get("alttext")
                formula.clear()
                formula.text, formula.tail = source, tail
            words = " ".join(caption.text_content().split())
        if drawing := self.links.drawing(name):
            drawing = book.DRAWN_LINK.sub(lambda link: link[0].replace(link[1], self.address_of(page, link[1]), 1), drawing)
            begin = f'<svg class="drawn" role="group" aria-label="{escape(words, quote=True)}" '
            replace(place, self.hole(drawing.replace("<svg ", begin, 1)))
        else:
            replace(place, E.img({"src": f"figures/{name}{os.path.splitext(path)[1]}", "alt": words}, size_of(path)))

    def live_figure(self, place: Element) -> None:
        """Where a script puts a figure that moves; nothing without the program that it needs."""
        figure = f'<figure class="live" data-live="{escape(place.text, quote=True)}" hidden>\n<p>Live figure</p>\n</figure>'
        around = place.getparent()
        alone = around.get("class") == "ltx_para" and len(around) == 1
        replace(around if alone else place, self.hole(figure if self.links.options.live else ""))

    # ------------------------------------------------------------ tests
    def test_file(self, code: Element) -> None:
        """A file of tests that is named in the prose leads to its page."""
        page = self.test_pages.get(code.text_content())
        if page and not code.xpath("ancestor::a"):
            wrap(code, E.a({"href": page}))

    def put_tests(self, page: Page, table: str) -> None:
        """The table of a chapter's tests, at the end of the section about them or of the chapter."""
        chapter = page.tree.xpath('.//section[starts-with(@class, "ltx_chapter")]')[0]
        sections = [section for section in chapter.xpath('.//section[starts-with(@class, "ltx_section")]')
                    if TESTED in section[0].text_content()]
        (sections[-1] if sections else chapter).append(self.hole(table))

    # ------------------------------------------------------------ links
    def address_of(self, page: Page, label: str) -> str:
        """Where a label is, seen from a page."""
        home, anchor, _ = self.links.labels[label]
        return ("" if home is page else home.file) + "#" + anchor

    def link_items(self, page: Page) -> None:
        """The rows of the inventory are places, and items lead to them."""
        for place in page.tree.xpath('.//span[starts-with(@class, "ltx_text lit-item ")]'):
            item = place.get("class").split()[2]
            place.attrib.clear()
            place.set("class", "lit-item")
            place.set("id", "item-" + item)
        for link in page.tree.xpath('.//a[starts-with(@href, "item:")]'):
            home = self.links.inventory
            assert home
            link.set("href", f"{'' if home is page else home.file}#item-{link.get('href').removeprefix('item:')}")

    def resolve(self, page: Page, html: str) -> str:
        """Addresses of chunks, now that it is known on which page each is."""
        def address(match: re.Match[str]) -> str:
            home, anchor = self.links.anchors[match[1]]
            return f'href="{"" if home == page.file else home}#{anchor}"'
        return re.sub(r'href="chunk:([^"]*)"', address, html)


def size_of(path: str) -> dict[str, str]:
    """Width and height of an SVG, so that the text does not jump when it arrives."""
    if not path.endswith(".svg"):
        return {}
    with open(path, encoding="utf-8") as file:
        head = file.read(2000)
    box = re.search(r'viewBox="\s*[\d.]+\s+[\d.]+\s+([\d.]+)\s+([\d.]+)', head)
    return {"width": f"{float(box[1]):.0f}", "height": f"{float(box[2]):.0f}"} if box else {}


def opening(tree: Element) -> str:
    """A paragraph with the first sentence of a chapter, without its links, citations and notes."""
    paragraph = copy.deepcopy(next(iter(tree.xpath('.//p[@class="ltx_p"]')), E.p()))
    for citation in paragraph.xpath(".//cite"):
        set_text_before(citation, text_before(citation).rstrip())
        citation.drop_tree()
    for title in paragraph.xpath('.//a[contains(@class, "lit-title")]'):
        title.tag = "em"
        title.attrib.clear()
    etree.strip_tags(paragraph, "a")
    html = inner(paragraph).split('<span class="ltx_note')[0].strip()
    sentence = re.match(r".{30,}?[a-z0-9)”>][.?!](?=\s+[A-Z“(]|\s*$)", html, re.DOTALL)
    return f"<p>{sentence[0]}</p>" if sentence and balanced(sentence[0]) else ""


def balanced(html: str) -> bool:
    """Whether what opens in a piece of HTML closes there."""
    return all(len(re.findall(rf"<{tag}\b", html)) == html.count(f"</{tag}>") for tag in ("span", "em", "math", "code", "i", "b"))


# ---------------------------------------------------------------- the book
class HtmlBook(book.Book):
    """The book, laid out as pages of HTML."""

    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__(options)
        self.listings = listing.HtmlListing(self.chapters, self.names)
        self.test_pages: list[Page] = []
        self.titles: dict[str, tuple[str, str]] = {}  # label of a chapter or section -> (which of these, title)
        # the titles and bodies that the templates of the theme show are HTML already
        self.templates = jinja2.Environment(loader=jinja2.FileSystemLoader(options.book), autoescape=False,
                                            undefined=jinja2.StrictUndefined)
        self.templates.globals.update(about=self.about, volumes=self.contents.volumes, parts=self.parts, front=self.front, back=self.back)

    def render(self, template: str, **values: Any) -> str:
        """A template of the theme, filled in."""
        return self.templates.get_template(template).render(values)

    def convert(self) -> None:
        """Prose to HTML: check what it refers to, then LaTeXML's two steps, both for many chapters at once."""
        self.links.check(self.pages())
        self.back.append(self.links.bibliography_page())
        pages = self.pages()
        for page in pages:
            self.substitute(page)
        converter = latexml.Converter(self.options.work, self.options.book)

        finisher = Finisher(self.links, self.listings)
        finisher.test_pages = {file.path: file.page for file in self.tests.files}
        for page in converter.to_xml(pages):
            for label, (anchor, number, kind, title) in latexml.give_addresses(page.root).items():
                self.links.labels[label] = (page, anchor, number)
                if title:
                    self.titles[label] = (kind, title)
            finisher.render_chunks(page)  # there is time for it while LaTeXML works
        for page in pages:
            page.addresses = latexml.resolve(page.root, functools.partial(self.to_label, page), self.to_entry)
        for page in converter.to_html(pages):
            finisher.finish(page)
            if page.tests:
                finisher.put_tests(page, self.render("tests.html", count=len(page.tests), summary=tested.summary(page.tests),
                                                     groups=list(tested.by_file(page.tests)), words=self.wording.words))
        self.number_entries(self.back[-1])
        for page in pages:
            page.body = finisher.text(page)
        for part in self.parts:
            part.page.title = part.title
            part.page.body = self.render("part.html", part=part, sentences={page: self.sentence(page) for page in part.pages})
        self.add_indexes(finisher)
        self.test_pages = [self.test_page(finisher, file) for file in self.tests.files]

    def test_page(self, finisher: Finisher, file: tested.TestFile) -> Page:
        """The source of a file of tests, with a place for each test."""
        page = Page(file.name, file.path, "")
        page.title, page.tests = file.path, file.tests
        pages = self.chapter_pages()
        links = self.listings.links_from(file.text)
        pieces, last = [], 0
        for test in file.tests:
            pieces += [self.listings.coloured(file.text[last:test.begin], links, python=file.is_python),
                       f'<span class="test" id="{escape(test.full)}">',
                       self.listings.coloured(file.text[test.begin:test.end], links, python=file.is_python), "</span>"]
            last = test.end
        pieces.append(self.listings.coloured(file.text[last:], links, python=file.is_python))
        numbers = "\n".join(map(str, range(1, file.text.count("\n") + 1)))
        body = self.render("testfile.html", file=file, summary=tested.summary(file.tests), numbers=numbers, code="".join(pieces),
                           homes=[pages[name] for name in self.tests.homes[file.path]])
        page.body = finisher.resolve(page, body)
        return page

    def sentence(self, page: Page) -> str:
        """A paragraph that says what a chapter is about."""
        own = self.contents.sentence(contents.key_of(page.source))
        return f"<p>{own}</p>" if own else opening(page.tree)

    def to_label(self, page: Page, label: str) -> latexml.Address:
        """How a page leads to a label."""
        home, anchor, number = self.links.labels[label]
        address = ("" if home is page else home.file) + "#" + anchor
        if label in self.titles:
            kind, title = self.titles[label]
            return latexml.Address(address, title, f"{kind} {number}".strip(), True)
        return latexml.Address(address, number or "here", "" if home is page else home.source, False)

    def to_entry(self, key: str) -> latexml.Address:
        """How a page leads to an entry of the bibliography."""
        entry = self.links.bibliography[key]
        return latexml.Address(f"bibliography.html#{key}", str(self.links.numbers[key]), f"{entry.family} {entry.get('year')}".strip(), False)

    def number_entries(self, page: Page) -> None:
        """The bibliography's entries get their numbers, and links to the chapters that cite them."""
        for entry in page.tree.xpath('.//p[@class="ltx_p lit-entry"]'):
            key = entry.get("id")
            entry.set("class", "entry")
            number = E.span({"class": "number"}, f"[{self.links.numbers[key]}]")
            number.tail, entry.text = " " + (entry.text or ""), None
            entry.insert(0, number)
            cited = lxml.html.fragment_fromstring('<span class="cited">Cited in ' + ", ".join(
                f'<a href="{home.file}">{home.title}</a>' for home in self.links.cited[key]) + ".</span>")
            entry.append(cited)
            set_text_before(cited, text_before(cited) + " ")

    def add_indexes(self, finisher: Finisher) -> None:
        """The indexes, before the bibliography."""
        tables = (self.listings.chunk_index(), self.listings.identifier_index(), self.test_index())
        for (name, title), table in zip(INDEXES.items(), tables):
            if name == "tests" and not self.tests.files:
                continue
            page = Page(name, "", "")
            page.title = title
            page.body = finisher.resolve(page, f"<h1>{title}</h1>\n{table}")
            self.back.insert(-1, page)

    def test_index(self) -> str:
        """All files of tests with their chapters."""
        pages = self.chapter_pages()

        def row(file: tested.TestFile) -> str:
            homes = ", ".join(f'<a href="{page.file}#tests-of-the-chapter">{page.title}</a>'
                              for page in (pages[name] for name in self.tests.homes[file.path]))
            number = tested.summary(file.tests).split(":", maxsplit=1)[0]
            return f'<tr><td><a href="{file.page}">{escape(file.path)}</a></td><td>{number}</td><td>{homes}</td></tr>'
        return listing.table(("File", "tests", "chapters"), map(row, self.tests.files))

    def reading_order(self) -> list[Page]:
        """All pages as a reader turns them: a part begins with its own page."""
        parts = [page for part in self.parts for page in [part.page] + part.pages]
        return [self.title_page()] + self.front + parts + self.back

    def search_page(self) -> Page:
        """The page with the search."""
        page = Page("search", "", "")
        page.title, page.body = "Search", self.render("search.html")
        return page

    # ------------------------------------------------------------ layout
    def layout(self, page: Page, before: Page | None, after: Page | None) -> str:
        """A whole page, with the contents beside it."""
        title = " ".join(re.sub(r"<[^>]*>", "", page.title).split())
        if page.name != "index":
            title += f" - {self.about['title']}"
        above = next((part.page for part in self.parts if page in part.pages), None)
        if page in self.test_pages:
            above = self.chapter_pages()[self.tests.homes[page.source][0]]
        return self.render("page.html", page=page, before=before, after=after, above=above, title=title) + "\n"

    def title_page(self) -> Page:
        """The first page."""
        page = Page("index", "", "")
        page.title = self.about["title"]
        path = self.readers_path()
        first = path[0][0] if path else self.pages()[0]
        page.body = self.render("title.html", first=first, path=path, picture=self.title_picture())
        return page

    def title_picture(self) -> dict[str, Any] | None:
        """One of the book's figures, if a chapter shows it; its caption leads there."""
        name = self.about["picture"]
        path = self.links.figures.get(name)
        home = next((page for page in self.pages() if f'src="figures/{name}.' in page.body), None)
        if not path or not home:
            return None
        return {"address": f"figures/{name}{os.path.splitext(path)[1]}", "size": size_of(path), "home": home}

    # ------------------------------------------------------------ files
    def write(self) -> None:
        """Writes what changed, and removes what no longer belongs to the book."""
        out = Folder(self.options.out)
        pages = self.reading_order()
        for page, before, after in zip(pages, [None, *pages], [*pages[1:], None]):
            out.put(page.file, self.layout(page, before, after))
        search = self.search_page()
        for page in [search, *self.test_pages]:
            out.put(page.file, self.layout(page, None, None))
        searched = [page for page in self.pages() if page.name not in INDEXES]
        out.put("search-index.js", finder.index(searched + self.test_pages, self.wording, self.listings.identifiers, self.links.anchors))
        for name in ("search.js", "book.css"):
            out.copy(name, os.path.join(self.options.book, name))
        if self.options.live:
            out.copy("live.js", os.path.join(self.options.book, "live.js"))
            out.copy("live-program.js", self.options.live)
        for font in FONTS:
            if not os.path.exists(font):
                raise Problem(font, 0, "not found; Debian's packages fonts-texgyre and fonts-texgyre-math bring it")
            out.copy("fonts/" + os.path.basename(font), font)
        for name, path in self.links.figures.items():
            out.copy(f"figures/{name}{os.path.splitext(path)[1]}", path)
        out.remove_others()


class Folder:
    """The folder of the book, whose files are written only if they changed."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.wanted: set[str] = set()

    def place(self, name: str) -> str:
        """Where a file of the book is to be."""
        self.wanted.add(name)
        path = os.path.join(self.path, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        return path

    def put(self, name: str, text: str) -> None:
        """Writes a file."""
        path = self.place(name)
        if os.path.exists(path):
            with open(path, "rb") as old:
                if old.read() == text.encode():
                    return
        with open(path, "wb") as new:
            new.write(text.encode())

    def copy(self, name: str, path: str) -> None:
        """Copies a file; looks into files only if their times differ."""
        there = self.place(name)
        if not os.path.exists(there) or not filecmp.cmp(path, there):
            shutil.copy2(path, there)

    def remove_others(self) -> None:
        """Removes what was not put or copied."""
        for folder, _, files in os.walk(self.path, topdown=False):
            for file in files:
                if os.path.relpath(os.path.join(folder, file), self.path) not in self.wanted:
                    os.remove(os.path.join(folder, file))
            if not os.listdir(folder):
                os.rmdir(folder)


def main(options: argparse.Namespace) -> None:
    whole = HtmlBook(options)
    whole.gather()
    whole.convert()
    whole.write()


if __name__ == "__main__":
    book.run(__doc__, main)
