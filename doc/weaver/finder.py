"""The index behind the book's search page: for each word the sections that have it. It is a file, not a server."""
import json
import re
from html import unescape

import listing

COMMON = frozenset("""about above after again all also and any are because been before below both but can could does each else
even every few for from get had has have her here him his how into its itself just may more most must not now off once one only
other our out over own same see she should since some such than that the their them then there these they this those through
too under until upon used uses was way were what when where which while who whose why will with without would yet you""".split())
SECTION = re.compile(r'<section id="([^"]*)"')
HEADING = re.compile(r"<h[1-6][^>]*>(.*?)</h[1-6]>", re.DOTALL)
UNREAD = re.compile(r'<pre>.*?</pre>|<math.*?</math>|<svg.*?</svg>|<p class="chunk-foot">.*?</p>|<a class="permalink".*?</a>'
                    r'|<span class="ltx_tag[^>]*>.*?</span>', re.DOTALL)
TAG = re.compile(r"<[^>]*>")
WORD = re.compile(r"\w+")
DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"


def base36(number):
    out = ""
    while number or not out:
        number, digit = divmod(number, 36)
        out = DIGITS[digit] + out
    return out


def text_of(html):
    """What is read aloud: no code of chunks, no formulas, no marks."""
    return " ".join(unescape(TAG.sub("", UNREAD.sub(" ", html))).split())


def sections_of(page):
    """(anchor, title, html) of each section of a page; the first has the page's own title."""
    begins = [(match.start(), match[1]) for match in SECTION.finditer(page.body)] or [(0, "")]
    begins[0] = (0, begins[0][1])
    for (begin, anchor), (end, _) in zip(begins, begins[1:] + [(len(page.body), "")]):
        html = page.body[begin:end]
        heading = HEADING.search(html)
        yield anchor, text_of(heading[1]) if heading else page.title, html


def index(pages, identifiers):
    """A script that defines INDEX, as search.js wants it."""
    sections, words = [], {}
    for number, page in enumerate(pages):
        for anchor, title, html in sections_of(page):
            for word in set(WORD.findall(text_of(html).lower())):
                if len(word) > 2 and not word[0].isdigit() and word not in COMMON:
                    words.setdefault(word, []).append(len(sections))
            sections.append((number, anchor, title))
    packed = {word: " ".join(base36(b - a) for a, b in zip([-1] + found, found)) for word, found in sorted(words.items())}
    data = {"pages": [(page.file, text_of(page.title)) for page in pages], "sections": sections, "words": packed,
            "identifiers": [(word, listing.anchor_of(word)) for word, *_ in identifiers]}
    return "const INDEX = " + json.dumps(data, ensure_ascii=False, separators=(",", ":")) + ";\n"


PAGE = """<h1>Search</h1>
<form class="search" role="search" action="search.html"><label>Words or the beginnings of words
<input type="search" name="q"></label> <button>Search</button></form>
<noscript><p>Searching needs JavaScript, reading does not. The <a href="identifiers.html">index of identifiers</a>,
the <a href="chunks.html">index of chunks</a> and the contents lead to everything as well.</p></noscript>
<p id="said" role="status"></p>
<ol id="results" class="results"></ol>
<script src="search-index.js"></script>
<script src="search.js"></script>
"""
