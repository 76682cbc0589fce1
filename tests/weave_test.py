#!/usr/bin/python3
"""The weaver's own test: a book of two chapters is woven, looked at, and broken in every way the weaver promises to see; and
the page of a report (nw/thesis/Report.nw).

Identity: contents that the pages must have. Negative controls: each fault is put in alone, and the weaver must stop with
the file, the line and the name of what is missing; the checker of links must see a book that was spoiled afterwards.
"""
import fcntl
import argparse
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from typing import Any

import jinja2
import lxml.html

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
WEAVER = os.path.join(ROOT, "doc", "weaver")
sys.path.insert(0, WEAVER)
import book  # noqa: E402
import contents  # noqa: E402
import finder  # noqa: E402
import latexml  # noqa: E402
import listing  # noqa: E402
import names  # noqa: E402
import noweb  # noqa: E402
import problems  # noqa: E402
import references  # noqa: E402
import report  # noqa: E402
import tested  # noqa: E402
import verdicts  # noqa: E402
import weave  # noqa: E402
from problems import Problem  # noqa: E402

FIRST = r"""\chapter{Reflection}\label{ch:first}
The reflectance \cite{hecht1990} is computed by [[reflect_it]], which prints [[a < b -- 'c']]; see
\eqref{eq:first:rs} and chapter~\ref{ch:second}. At Brewster's angle, \val{F3.9.brewster} degrees, it is zero.
\begin{equation} R_s = |r_s|^2 \label{eq:first:rs} \tag{3.50} \end{equation}

\section{The code}
<<Reflect a ray>>=
double reflect_it(double n) {
  std::cerr @<< "n = " @<< n;
  <<Square [[n]]>>
}
@ %def reflect_it

Not a chunk: [[@<<only prose>>]]; and 1 < 2.

<<Square [[n]]>>=
return n * n;
@
\begin{figure}\centering\includegraphics{F3.9/fresnel}
\caption{Reflectances against $\theta_i$ for $n=2$.}\label{fig:F3.9}\end{figure}
"""

SECOND = r"""\chapter{Use}\label{ch:second}
Equation \eqref{eq:first:rs} again, and figure~\ref{fig:F3.9}.\footnote{A note.}

<<surface/use.cpp>>=
<<Reflect a ray>>
int main() { return reflect_it(2) > 0; }  // reflect_it is not linked here
@

<<Reflect a ray>>=
// more
@
"""

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 480"><rect width="640" height="480"/></svg>'


CONTENTS = """[book]
title = malus
subtitle = A trial
after = After <cite>A thesis</cite>
begin = Begin with
path = One chapter
says = For a first reader.
interface = The rest is on the site.
picture = none
caption = none
[volume 1]
title = What is needed
about = The first.
[volume 2]
title = What is more
about = The second.
[path]
chapters =
  light/first what a surface does
[light]
volume = 1
title = Light
about = Light, and what it does.
rest = light
[surface]
volume = 2
title = Surface
about = Where it is reflected.
chapters =
  surface/second How the reflectance is used.
"""


class Workshop(unittest.TestCase):
    """A scratch directory with a two-chapter book; weave() runs the weaver as CMake does."""

    shared: str
    theme: str

    @classmethod
    def setUpClass(cls) -> None:
        cls.shared = tempfile.mkdtemp()  # LaTeXML's work is kept from test to test, as it is from build to build
        cls.addClassCleanup(shutil.rmtree, cls.shared)
        cls.theme = os.path.join(cls.shared, "theme")
        shutil.copytree(os.path.join(ROOT, "doc", "book"), cls.theme)
        with open(os.path.join(cls.theme, "book.ini"), "w", encoding="utf-8") as file:
            file.write(CONTENTS)

    def setUp(self) -> None:
        self.dir = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.dir)
        self.put("nw/light/first.nw", FIRST)
        self.put("nw/surface/second.nw", SECOND)
        self.put("report/values.tex", "\\malusval{F3.9.brewster}{63.43}\n")
        self.put("report/F3.9/fresnel.svg", SVG)

    def put(self, name: str, text: str) -> None:
        path = os.path.join(self.dir, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def get(self, name: str) -> str:
        with open(os.path.join(self.dir, "book", name), encoding="utf-8") as file:
            return file.read()

    def weave(self, *more: str) -> tuple[int, str]:
        """(exit code, complaints)"""
        done = subprocess.run(
            [os.path.join(WEAVER, "weave.py"), "--out", "book", "--work", os.path.join(self.shared, "work"), "--book",
             self.theme, "--report", "report", "--bibliography",
             os.path.join(ROOT, "doc", "bibliography.bib"), "--headers", "generated", *more, "nw/light/first.nw", "nw/surface/second.nw"],
            cwd=self.dir, capture_output=True, text=True)
        return done.returncode, done.stderr

    def weave_pdf(self, *front: str) -> tuple[int, str]:
        """(exit code, complaints) of the second renderer"""
        done = subprocess.run(
            [os.path.join(WEAVER, "pdf.py"), "--out", "book.pdf", "--work", os.path.join(self.shared, "pdf"), "--book",
             self.theme, "--report", "report", "--bibliography",
             os.path.join(ROOT, "doc", "bibliography.bib"), *front, "nw/light/first.nw", "nw/surface/second.nw"],
            cwd=self.dir, capture_output=True, text=True)
        return done.returncode, done.stderr

    def check_links(self) -> tuple[int, str]:
        done = subprocess.run([os.path.join(WEAVER, "links.py"), "book"], cwd=self.dir, capture_output=True, text=True)
        return done.returncode, done.stderr


class WovenBook(Workshop):
    """Contents that a reader must find."""

    def setUp(self) -> None:
        super().setUp()
        self.assertEqual(self.weave(), (0, ""))
        self.first, self.second = self.get("light-first.html"), self.get("surface-second.html")

    def test_links_and_pictures_are_whole(self) -> None:
        self.assertEqual(self.check_links(), (0, ""))

    def test_equation_keeps_the_number_of_the_thesis_and_is_linked_from_the_other_chapter(self) -> None:
        self.assertIn('id="eq:first:rs"', self.first)
        self.assertIn("(3.50)", self.first)
        self.assertRegex(self.second, r'\(<a href="light-first.html#eq:first:rs"[^>]*>3.50</a>\)')

    def test_chapters_sections_and_figures_are_numbered_through_the_book(self) -> None:
        self.assertRegex(self.first, r'and <a href="surface-second.html#ch:second" title="chapter 2" [^>]*lit-title[^>]*>Use</a>\.')
        self.assertIn('<section id="the-code"', self.first)
        self.assertRegex(self.second, r'<a href="light-first.html#fig:F3.9"[^>]*>1.1</a>')

    def test_a_part_has_a_page_with_a_sentence_on_each_chapter_and_chapters_lead_up_to_it(self) -> None:
        part = self.get("light.html")
        self.assertIn("<h1>Light</h1>", part)
        self.assertRegex(part, r'(?s)<a href="light-first.html">Reflection</a><p>The reflectance is computed by .*<em>Use</em>\.</p></li>')
        self.assertIn('<a href="surface-second.html">Use</a><p>How the reflectance is used.</p></li>', self.get("surface.html"))
        self.assertIn('<a rel="up" href="light.html">Light</a>', self.first)
        self.assertIn('<a rel="prev" href="light.html">Light</a>', self.first)
        self.assertIn('<a rel="next" href="surface.html">Surface</a>', self.first)

    def test_the_title_page_begins_with_the_path_of_a_first_reader_and_has_both_volumes(self) -> None:
        title = self.get("index.html")
        self.assertIn('<li><a href="light-first.html">Reflection</a>: what a surface does.</li>', title)
        self.assertLess(title.index("Begin with Reflection"), title.index("Volume 1: What is needed"))
        self.assertLess(title.index("Volume 1: What is needed"), title.index("Volume 2: What is more"))

    def test_a_formula_keeps_its_brackets_and_its_comma(self) -> None:
        self.assertRegex(self.first, r'(?s)<span class="glued"><math[^>]*alttext="n=2".*?</math>\.</span>')
        line = lxml.html.fragment_fromstring('<p>a (<math display="inline">x</math>), <math display="inline">y</math> z</p>')
        for formula in line:
            self.finisher().glue(formula)
        self.assertEqual(weave.inner(line), 'a <span class="glued">(<math display="inline">x</math>),</span> '
                         '<math display="inline">y</math> z')

    @staticmethod
    def finisher() -> weave.Finisher:
        options = argparse.Namespace(bibliography=os.path.join(ROOT, "doc", "bibliography.bib"), report="nowhere")
        return weave.Finisher(book.Links(options), listing.HtmlListing([]))

    def test_heads_that_begin_sentences_run_in_and_terms_stay_terms(self) -> None:
        def list_of(head: str, body: str) -> str:
            line = lxml.html.fragment_fromstring(f'<div><dl class="ltx_description"><dt class="ltx_item">{head}</dt>'
                                                 f'<dd class="ltx_item"><div class="ltx_para"><p>{body}</p></div></dd></dl></div>')
            weave.Finisher.run_in(line[0])
            return weave.inner(line)
        self.assertEqual(list_of("<b>AoLP,</b>", "the angle."), '<ul class="run-in"><li class="ltx_item"><div class="ltx_para">'
                         '<p><span class="head"><b>AoLP,</b></span> the angle.</p></div></li></ul>')
        self.assertIn('class="run-in"', list_of("Four cameras", "look at it."))
        for head, body in (("A plate.", "A plate is flat."), ('<span class="ltx_font_typewriter">width</span>', "of the lobe")):
            self.assertIn('<dl class="ltx_description"><dt class="ltx_item">', list_of(head, body))

    def test_a_prime_is_not_raised_twice_and_large_brackets_keep_a_distance(self) -> None:
        line = lxml.html.fragment_fromstring("<math><msup><mi>f</mi><mo>′</mo></msup><msubsup><mi>g</mi><mn>1</mn><mo>′</mo></msubsup>"
                                             "<mo>(</mo><mtable><mtr></mtr></mtable><mo>)</mo><msup><mi>h</mi><mo>+</mo></msup></math>")
        for raised in line.xpath(".//msup | .//msubsup"):
            weave.Finisher.lower_prime(raised)
        weave.Finisher.space_in_brackets(line.find("mtable"))
        self.assertEqual(weave.inner(line), '<mrow><mi>f</mi><mo lspace="0" rspace="0">′</mo></mrow>'
                         '<msub><mrow><mi>g</mi><mo lspace="0" rspace="0">′</mo></mrow><mn>1</mn></msub><mo lspace="0.17em">(</mo>'
                         '<mtable><mtr></mtr></mtable><mo rspace="0.17em">)</mo><msup><mi>h</mi><mo>+</mo></msup>')

    def test_a_formula_that_stands_in_many_places_takes_nothing_from_one_to_the_other(self) -> None:
        formula = r"\begin{equation} ((a+b)(c+d))^{2} = |e_{i}|^{2} \label{eq:%s} \end{equation} $((a+b)(c+d))^{2}$ "
        self.put("nw/light/first.nw", FIRST + "\\section{More}\n" + formula % "one" + formula % "two" + r"\eqref{eq:one} \eqref{eq:three}")
        self.put("nw/surface/second.nw", SECOND + "\\section{More}\n" + formula % "three" + r"\eqref{eq:two}")
        self.assertEqual(self.weave(), (0, ""))
        self.assertEqual(self.check_links(), (0, ""))
        pages = [self.get("light-first.html"), self.get("surface-second.html")]
        for display in ("block", "inline"):
            found = [re.findall(rf'<math[^>]*alttext="[^"]*a\+b[^"]*" display="{display}">.*?</math>', page, re.DOTALL) for page in pages]
            self.assertEqual([len(formulas) for formulas in found], [2, 1])
            self.assertEqual(len(set(found[0] + found[1])), 1)
            self.assertNotIn(" id=", found[0][0])
        for page, labels in zip(pages, (("one", "two"), ("three",))):
            self.assertEqual(re.findall(r'id="eq:(one|two|three)"', page), list(labels))
        self.assertRegex(pages[0], r'\(<a href="#eq:one"[^>]*>1.1</a>\) \(<a href="surface-second.html#eq:three"[^>]*>2.1</a>\)')
        self.assertRegex(pages[1], r'\(<a href="light-first.html#eq:two"[^>]*>1.2</a>\)')

    def test_chunks_are_numbered_in_the_order_of_the_book_and_joined_both_ways(self) -> None:
        self.assertRegex(self.first, r'(?s)id="chunk-reflect-a-ray">.*?href="#chunk-reflect-a-ray">1</a>')
        self.assertRegex(self.first, r'class="use" href="#chunk-square-n">⟨Square <code>n</code> <span class="chunk-number">2<')
        self.assertRegex(self.first, r'Continued in <a href="surface-second.html#chunk-reflect-a-ray"[^>]*>4</a>')
        self.assertRegex(self.second, r'Continues <a href="light-first.html#chunk-reflect-a-ray"[^>]*>1</a>')
        self.assertRegex(self.first, r'Used in <a href="surface-second.html#chunk-surface-use-cpp"[^>]*>3</a>')
        self.assertIn("+≡", self.second)

    def test_identifiers_lead_from_each_use_to_the_definition_and_back(self) -> None:
        self.assertRegex(self.second, r'return <a class="identifier" href="light-first.html#chunk-reflect-a-ray"'.replace("return ", ""))
        self.assertIn("// reflect_it is not linked here", self.second)
        self.assertRegex(self.first, r'Defines <code>reflect_it</code>, used in <a href="surface-second.html#chunk-surface-use-cpp"')
        self.assertRegex(self.get("identifiers.html"), r"<code>reflect_it</code></td><td>Reflect a ray</td>"
                         r"<td><a [^>]*>1</a></td><td><a [^>]*>3</a>")
        self.assertIn("⟨Square <code>n</code>⟩", self.get("chunks.html"))

    def test_quotes_and_escapes_print_the_characters_that_were_meant(self) -> None:
        self.assertIn("a &lt; b -- 'c'", self.first)
        self.assertIn('std::cerr &lt;&lt; <span class="string">"n = "</span> &lt;&lt; n;', self.first)
        self.assertRegex(self.first, r"Not a chunk: <span [^>]*>&lt;&lt;only prose&gt;&gt;</span>; and 1 &lt; 2\.")
        self.assertRegex(self.first, r'href="#chunk-reflect-a-ray"[^>]*lit-identifier[^>]*>reflect_it</a>')

    def test_value_figure_citation_and_source_line(self) -> None:
        self.assertIn("63.43 degrees", self.first)
        self.assertRegex(self.first, r'<img src="figures/F3.9/fresnel.svg" alt="Figure 1.1: Reflectances against \\theta_\{i\}'
                                     r' for n=2." width="640" height="480">')
        self.assertRegex(self.first, r'\[<a href="bibliography.html#hecht1990"[^>]*>1</a>\]')
        self.assertRegex(self.get("bibliography.html"), r'\[1\]</span> Eugene Hecht\. <em[^>]*>Optics</em>')
        self.assertIn("Edit this chapter: <code>nw/light/first.nw</code>", self.first)

    def test_needs_no_script_and_no_network(self) -> None:
        """Only the search has scripts, in separate files."""
        names = [name for name in os.listdir(os.path.join(self.dir, "book")) if name.endswith(".html")]
        pages = "".join(map(self.get, names))
        self.assertEqual([name for name in names if "<script" in self.get(name)], ["search.html"])
        self.assertNotRegex(pages, r'src="https?:')

    def test_a_live_figure_needs_its_program(self) -> None:
        """Without the program the page has neither figure nor script; with it both, hidden until a script runs."""
        text = FIRST.replace("\\end{figure}\n", "\\end{figure}\n\\livefigure{fresnel}\n", 1)
        self.assertIn("livefigure", text)
        self.put("nw/light/first.nw", text)
        self.assertEqual(self.weave(), (0, ""))
        self.assertNotRegex(self.get("light-first.html"), "livefigure|lit-live|data-live|<script")
        self.assertEqual(self.check_links(), (0, ""))
        self.put("program.js", "")
        self.assertEqual(self.weave("--live", "program.js"), (0, ""))
        page = self.get("light-first.html")
        self.assertIn('<figure class="live" data-live="fresnel" hidden>', page)
        self.assertEqual(re.findall(r'<script defer src="([^"]*)">', page), ["live-program.js", "live.js"])
        self.assertNotIn("<script", self.get("surface-second.html"))
        self.assertEqual(self.check_links(), (0, ""))

    def test_a_page_that_no_longer_belongs_to_the_book_is_removed(self) -> None:
        self.put("book/old.html", "old")
        self.assertEqual(self.weave(), (0, ""))
        self.assertFalse(os.path.exists(os.path.join(self.dir, "book", "old.html")))


class BrokenBook(Workshop):
    """Negative controls of the weaver: one fault each."""

    def fails(self, *fragments: str) -> None:
        code, complaint = self.weave()
        self.assertEqual(code, 1)
        for fragment in fragments:
            self.assertIn(fragment, complaint)
        self.assertFalse(os.path.exists(os.path.join(self.dir, "book")), "half a book was written")

    def test_unknown_value(self) -> None:
        self.put("report/values.tex", "\\malusval{F3.9.brewstar}{63.43}\n")
        self.fails("nw/light/first.nw:3:", r"\val{F3.9.brewster}")

    def test_values_are_set_with_powers_of_ten(self) -> None:
        self.put("report/values.tex", "\\malusval{F3.9.brewster}{3.2e-05}\n")
        self.assertEqual(self.weave()[0], 0)
        self.assertIn("⋅", self.get("light-first.html"))
        self.assertNotIn("3.2e-05", self.get("light-first.html"))
        self.put("report/values.tex", "\\malusval{F3.9.brewster}{3.2e-05b}\n")
        self.assertEqual(self.weave()[0], 0)
        self.assertIn("3.2e-05b", self.get("light-first.html"), "the control: a text that is not a number")

    def test_tables_of_reference_are_what_the_program_says(self) -> None:
        flags = [{"name": "--help"}, {"name": "--step", "placed": False, "text": "a step, 1e-6 to -2e3; with --far", "required": True,
                                      "several": False, "value": "TEXT", "choices": ["near"]}]
        grey = {"name": "grey", "parameters": [{"name": "albedo", "meaning": "its share", "unit": "%", "range": "0 to 1", "default": "0.5",
                                                "optional": False}]}
        self.put("report/program.json", json.dumps({"commands": [{"name": "walk", "flags": flags}], "models": [grey], "skies": []}))
        self.put("report/schema.json", json.dumps({
            "properties": {"eye": {"description": "what sees", "properties": {"pupil_mm": {"$ref": "#/definitions/size"}}}},
            "definitions": {"size": {"description": "a size in mm"}}, "required": ["eye"]}))
        tables = "\n\n\\options{walk}\n\n\\parameters{grey}\n\n\\keys{eye size}\n"
        self.put("nw/surface/second.nw", SECOND + tables)
        self.assertEqual(self.weave(), (0, ""))
        page = re.sub(r"<[^>]*>|\s+", " ", self.get("surface-second.html"))
        for words in ("--step TEXT", "a step,", "; with --far : near ; required", "albedo its share [%] 0 to 1 0.5", "eye what sees; required",
                      "pupil_mm a size in mm", "size a size in mm"):
            self.assertIn(words, re.sub(" +", " ", page))
        self.assertNotIn("1e-6", page)
        self.assertNotIn("--help", page)

    def test_a_table_of_reference_that_the_program_does_not_have(self) -> None:
        self.put("nw/surface/second.nw", SECOND + "\n\\options{walk}\n")
        self.fails("nw/surface/second.nw:13:", "walk", "does not have")

    def test_missing_figure(self) -> None:
        os.remove(os.path.join(self.dir, "report/F3.9/fresnel.svg"))
        self.fails("nw/light/first.nw:19:", "F3.9/fresnel")

    def test_unknown_label_names_all_places(self) -> None:
        self.put("nw/light/first.nw", FIRST.replace(r"\label{eq:first:rs}", ""))
        self.fails("nw/light/first.nw:3:", "nw/surface/second.nw:2:", "eq:first:rs")

    def test_label_given_twice(self) -> None:
        self.put("nw/surface/second.nw", SECOND + "\\section{Again}\\label{ch:first}\n")
        self.fails("nw/surface/second.nw:12:", "ch:first", "nw/light/first.nw")

    def test_unknown_citation(self) -> None:
        self.put("nw/light/first.nw", FIRST.replace("hecht1990", "hecht1991"))
        self.fails("nw/light/first.nw:2:", "hecht1991")

    def test_undefined_chunk(self) -> None:
        self.put("nw/light/first.nw", FIRST.replace("<<Square [[n]]>>=", "<<Square of [[n]]>>="))
        self.fails("nw/light/first.nw", "Square [[n]]")

    def test_latex_command_that_does_not_exist_is_told_with_its_line(self) -> None:
        self.put("nw/light/first.nw", FIRST.replace(r"\section{The code}", r"\section{The code} \sectoin"))
        self.fails("nw/light/first.nw:6:", r"\sectoin")

    def test_public_name_that_the_index_lacks(self) -> None:
        self.put("generated/light/first.hpp", '#line 9 "nw/light/first.nw"\nnamespace malus {\nclass reflect_it;\ndouble orphan(int n);\n}\n')
        self.fails("nw/light/first.nw:11: orphan is public, but no `@ %def`")

    def test_value_in_a_comment_is_not_asked_for(self) -> None:
        self.put("nw/light/first.nw", FIRST.replace("it is zero.", "it is zero. % \\val{nothing}"))
        self.assertEqual(self.weave(), (0, ""))


class SpoiledBook(Workshop):
    """Negative controls of the checker of links."""

    def spoiled(self, name: str, old: str, new: str, complaint: str) -> None:
        self.assertEqual(self.weave(), (0, ""))
        text = self.get(name)
        self.assertIn(old, text)
        self.put("book/" + name, text.replace(old, new))
        code, said = self.check_links()
        self.assertEqual(code, 1)
        self.assertIn(complaint, said)

    def test_broken_anchor(self) -> None:
        self.spoiled("light-first.html", 'id="eq:first:rs"', 'id="eq:first:rp"', "#eq:first:rs names no place")

    def test_lost_picture(self) -> None:
        self.spoiled("light-first.html", "figures/F3.9/fresnel.svg", "figures/lost.svg", "lost.svg does not exist")

    def test_picture_without_words(self) -> None:
        self.spoiled("light-first.html", 'alt="Figure', 'data-alt="Figure', "has no words")

    def test_something_loaded_from_elsewhere(self) -> None:
        self.spoiled("light-first.html", 'href="book.css"', 'href="https://example.org/book.css"', "loaded from elsewhere")

    def test_script(self) -> None:
        self.spoiled("index.html", "</main>", "<script></script></main>", "a script")
        self.spoiled("light-first.html", "</main>", '<script src="live.js"></script></main>', "a script")


class Site(Workshop):
    """The files of make site, and those of the archive of make dist."""

    REPORT = '<!DOCTYPE html><html lang="en"><head><title>r</title></head><body><h1>r</h1><img src="F3.9/fresnel.svg" alt="a"></body></html>'

    def collect(self) -> tuple[int, str]:
        """(exit code, complaints)"""
        self.assertEqual(self.weave(), (0, ""))
        self.put("report/report.html", self.REPORT)
        self.put("malus-1.pdf", "%PDF-")
        self.put("deb/malus_1_amd64.deb", "!<arch>")
        done = subprocess.run([os.path.join(WEAVER, "collect.py"), "--out", "site", "--book", "book", "--report", "report", "--paper",
                               "malus-1.pdf", "malus-2.pdf", "--packages", "deb", "wheel"], cwd=self.dir, capture_output=True, text=True)
        return done.returncode, done.stderr

    def test_all_is_there_and_linked_from_the_title_page(self) -> None:
        self.assertEqual(self.collect(), (0, ""))
        with open(os.path.join(self.dir, "site", "index.html"), encoding="utf-8") as file:
            title = file.read()
        for address in ("malus-1.pdf", "report/report.html", "packages/index.html"):
            self.assertIn(f'href="{address}"', title)
            self.assertTrue(os.path.exists(os.path.join(self.dir, "site", address)))
        self.assertNotIn("malus-2.pdf", title)
        self.assertFalse(os.path.exists(os.path.join(self.dir, "site/report/values.tex")))
        with open(os.path.join(self.dir, "site/packages/index.html"), encoding="utf-8") as file:
            self.assertIn('<a href="malus_1_amd64.deb">', file.read())

    def test_negative_control_a_picture_that_the_report_lacks(self) -> None:
        self.REPORT = self.REPORT.replace("fresnel.svg", "lost.svg")  # pylint: disable=invalid-name
        code, said = self.collect()
        self.assertEqual(code, 1)
        self.assertIn("site/report/report.html:1: F3.9/lost.svg does not exist", said)


class Search(unittest.TestCase):
    """Results of the search."""

    BODY = """<section class="ltx_chapter" id="ch"><h1>Rough metal</h1><p>Many small facets.</p>
<section class="ltx_section" id="one"><h2>Slopes</h2><p>The angle <math alttext="\\sigma_{i}"><mi>s</mi></math> counts.</p>
<section class="ltx_paragraph" id="hand"><h3>By hand.</h3><p>Two steps.</p></section></section></section>"""

    def index(self, name: str = "notation") -> dict[str, Any]:
        """The index of one page with a chunk."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "code.nw")
            with open(path, "w", encoding="utf-8") as file:
                file.write('Text.\n<<Complain>>=\nthrow Error("the camera is below the ground", "x");\n@\n')
            chunks = noweb.read([path])[0].chunks
        page = book.Page(name, "", "")
        page.title, page.body, page.chunks = "Rough metal", self.BODY, chunks
        script = finder.index([page], tested.Wording([]), [], {chunks[0].label: ("page.html", "chunk-complain")})
        found: dict[str, Any] = json.loads(script.removeprefix("const INDEX = ").removesuffix(";\n"))
        return found

    def test_sections_have_their_text_and_small_parts_belong_to_them(self) -> None:
        index = self.index()
        self.assertEqual(index["sections"], [[0, "ch", "Rough metal", 0], [0, "one", "Slopes", 0], [0, "chunk-complain", "Complain", 1]])
        self.assertEqual(index["texts"][0], "Many small facets.")
        self.assertEqual(index["texts"][1], "The angle counts. By hand. Two steps.")

    def test_messages_of_the_program_are_found_and_greek_letters_in_the_notation(self) -> None:
        index = self.index()
        self.assertEqual(index["texts"][2], "the camera is below the ground")
        self.assertEqual(index["words"]["camera"], "3")
        self.assertEqual(index["words"]["sigma"], "2")
        self.assertNotIn("sigma", self.index("other")["words"])
        self.assertNotIn("the", index["words"])


PAPER = {"lualatex": "texlive-luatex", "rsvg-convert": "librsvg2-bin", "kpsewhich": "texlive-binaries"}


def lacks(commands: dict[str, str]) -> str:
    """The Debian packages that are missing, as a reason to skip; nothing if all are there."""
    missing = [package for command, package in commands.items() if not shutil.which(command)]
    return f"not installed: {' '.join(missing)}" if missing else ""


@unittest.skipIf(lacks(PAPER), lacks(PAPER) + " (make pdf installs it)")
class PrintedBook(Workshop):
    """The same book as PDF, and what must not get into it."""

    def fails(self, old: str, new: str, *fragments: str) -> None:
        self.assertIn(old, FIRST)
        self.put("nw/light/first.nw", FIRST.replace(old, new))
        code, complaint = self.weave_pdf()
        self.assertEqual(code, 1)
        for fragment in fragments:
            self.assertIn(fragment, complaint)
        self.assertFalse(os.path.exists(os.path.join(self.dir, "book-1.pdf")), "a bad book was delivered")

    def get_work(self, name: str) -> str:
        """A file that LuaLaTeX read or wrote."""
        with open(os.path.join(self.shared, "pdf", name), encoding="utf-8") as file:
            return file.read()

    def test_whole_book(self) -> None:
        self.assertEqual(self.weave_pdf(), (0, ""))
        for volume in (1, 2):
            with open(os.path.join(self.dir, f"book-{volume}.pdf"), "rb") as file:
                self.assertEqual(file.read(5), b"%PDF-")
        first, second = (self.get_work(f"malus-{volume}.aux") for volume in (1, 2))
        self.assertIn(r"\newlabel{eq:first:rs}{{{3.50}}", first)
        self.assertRegex(second, r"\\newlabel\{ch:second\}\{\{2\}")
        self.assertEqual([len(re.findall(r"\\newlabel\{chunk:", aux)) for aux in (first, second)], [2, 2])

    def test_a_volume_refers_to_the_other_by_its_numbers(self) -> None:
        self.assertEqual(self.weave_pdf(), (0, ""))
        self.assertIn(r"volume~2, chapter~\litfar{ch:second}.", self.get_work("light-first.tex"))
        self.assertIn(r"Volume~1, equation (\litfar{eq:first:rs}) again, and volume~1, figure~\litfar{fig:F3.9}.",
                      self.get_work("surface-second.tex"))
        self.assertIn(r"\litfardefine{ch:second}{2}{2}{chapter.2}{2}", self.get_work("far-1.tex"))
        self.assertIn(r"\litfardefine{fig:F3.9}{1.1}", self.get_work("far-2.tex"))
        self.assertRegex(self.get_work("identifiers.tex"), r"\\litidentifierentry\{reflect\\_it\}\{\\litpage\{1\}\{[^}]*\}\}")

    def test_a_chapter_before_the_parts_counts_as_on_the_site(self) -> None:
        self.put("front/rules.tex", "\\chapter{Rules}\\label{ch:rules}\nLeft is left.\n")
        self.assertEqual(self.weave_pdf("front/rules.tex"), (0, ""))
        for volume, label, number in ((1, "rules", 1), (1, "first", 2), (2, "second", 3)):
            self.assertIn(rf"\newlabel{{ch:{label}}}{{{{{number}}}", self.get_work(f"malus-{volume}.aux"))

    def test_a_volume_that_is_too_long(self) -> None:
        with open(os.path.join(self.theme, "book.ini"), "w", encoding="utf-8") as file:
            file.write(CONTENTS.replace("about = The first.", "about = The first.\npages = 2"))
        code, complaint = self.weave_pdf()
        with open(os.path.join(self.theme, "book.ini"), "w", encoding="utf-8") as file:
            file.write(CONTENTS)
        self.assertEqual(code, 1)
        self.assertRegex(complaint, "volume 1 has \\d+ pages, but at most 2 are allowed")

    def test_line_that_sticks_out(self) -> None:
        self.fails("it is zero.", r"it is zero. \rule{20cm}{1pt}", "nw/light/first.nw:", "Overfull")

    def test_character_that_the_font_lacks(self) -> None:
        self.fails("it is zero.", "it is \u4e00.", "nw/light/first.nw", "Missing character")

    def test_latex_error_is_told_with_the_line_of_the_chapter(self) -> None:
        self.fails(r"\section{The code}", r"\section{The code} \sectoin", "nw/light/first.nw:6:", "Undefined control sequence")


class Errata(unittest.TestCase):
    """The table of errata: the report and the chapter must have the same entries."""

    CLAIM = {"name": "a", "printed": "1", "ours": "2.0", "cause": "should read 2", "verdict": "erratum"}
    ROW = r"\erratum{eq.~1}{$x_{1}$}{$x_{2}$}{index}{N8/a}"

    def table(self, *rows: str, verdict: str = "erratum") -> str:
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "report.json"), "w", encoding="utf-8") as file:
                json.dump({"items": [{"id": "N8", "claims": [dict(self.CLAIM, verdict=verdict)]}]}, file)
            page = book.Page("errata", "errata.nw", "\n".join(("\\begin{errata}", *rows, "\\end{errata}")))
            verdicts.Verdicts(folder).errata(page)
        return page.latex

    def test_a_row_has_the_evidence_of_its_claim_and_keeps_its_line(self) -> None:
        lines = self.table(self.ROW).split("\n")
        self.assertEqual(len(lines), 3)
        self.assertEqual(lines[1], r"eq.~1 & $x_{1}$ & $x_{2}$ & \litto{N8}{N8/a}: 2.0; should read 2. & index \\")

    def test_negative_controls(self) -> None:
        for rows, verdict, complaint in (((), "erratum", "the report has the erratum N8/a"),
                                         ((self.ROW,), "differs", "errata.nw:2: N8/a is not an erratum"),
                                         ((self.ROW, self.ROW.replace("N8/a", "N8/b")), "erratum", "errata.nw:3: N8/b is not an erratum"),
                                         ((self.ROW, r"\erratum{a}{b}{N8/a}"), "erratum", "five arguments")):
            with self.subTest(complaint), self.assertRaisesRegex(problems.Problems, complaint):
                self.table(*rows, verdict=verdict)


class Claims(unittest.TestCase):
    """The table of what an item claims."""

    CLAIM = {"sentence": "it falls (page 9)", "quantity": "error", "criterion": "falls", "source": "sentence", "fit": "", "unknowns": 0,
             "repeats": "", "verdict": "differs"}

    def table(self, line: str, **changed: Any) -> str:
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "report.json"), "w", encoding="utf-8") as file:
                json.dump({"items": [{"id": "F1", "claims": [dict(self.CLAIM, name="a", **changed)]}]}, file)
            page = book.Page("one", "one.nw", f"Text.\n{line}\nText.")
            verdicts.Verdicts(folder).substitute(page, [], [])
        return page.latex

    def test_a_claim_is_a_row_and_the_page_keeps_its_lines(self) -> None:
        latex = self.table(r"\claims{F1}")
        self.assertEqual(latex.count("\n"), 2)
        self.assertIn(r"\litto{F1}{F1} & it falls (page 9): error & falls (sentence) & differs \\", latex)
        self.assertIn("fitted, 2 unknowns", self.table(r"\claims{F1}", fit="sun", unknowns=2))
        self.assertNotIn("it falls", self.table(r"\claims{F1}", repeats="F2/a"))

    def test_negative_control_an_item_that_is_not_there(self) -> None:
        with self.assertRaisesRegex(problems.Problems, "is not an item of the report"):
            self.table(r"\claims{F2}")


class Tangled(unittest.TestCase):
    """The files written into generated/, and those left unchanged there so that nothing is compiled needlessly."""

    CHAPTER = """Why.
<<light/Use.hpp>>=
inline int use() {
  <<Use it>>
}
<<Use it>>=
return 1;
<<light/Use.cpp>>=
#include <light/Use.hpp>
"""
    NAMES = ("light/Use.hpp", "light/Use.cpp")

    def setUp(self) -> None:
        self.dir = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.dir)
        self.tangle(self.CHAPTER)
        for name in self.NAMES:  # long ago, so that a second writing shows
            os.utime(self.path(name), (1, 1))

    def path(self, name: str) -> str:
        return os.path.join(self.dir, "generated", name)

    def command(self, *options: str) -> list[str]:
        return [os.path.join(WEAVER, "tangle.py"), *options, "generated", "Use.nw", *self.NAMES]

    def tangle(self, text: str, *options: str) -> None:
        with open(os.path.join(self.dir, "Use.nw"), "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run(self.command(*options), cwd=self.dir, check=True)

    def rewritten(self) -> list[str]:
        return [name for name in self.NAMES if os.stat(self.path(name)).st_mtime != 1]

    def text(self, name: str) -> str:
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def line_of_use(self) -> int:
        """As the index of the book has it."""
        row = self.text("light/Use.hpp").split("\n").index("inline int use() {")
        return names.places(self.path("light/Use.hpp"))[row][1]

    def test_the_same_chapter_touches_nothing(self) -> None:
        self.tangle(self.CHAPTER)
        self.assertEqual(self.rewritten(), [])

    def test_a_sentence_more_leaves_the_header_and_moves_the_lines_of_the_source(self) -> None:
        self.tangle("One more sentence.\n" + self.CHAPTER)
        self.assertEqual(self.rewritten(), ["light/Use.cpp"])
        self.assertIn('#line 10 "Use.nw"', self.text("light/Use.cpp"))
        self.assertEqual(self.line_of_use(), 4)  # the index of the book has the line of now

    def test_negative_control_the_line_of_then(self) -> None:
        self.tangle("One more sentence.\n" + self.CHAPTER)
        os.remove(self.path("light/Use.hpp.lines"))
        self.assertEqual(self.line_of_use(), 3)

    def test_a_changed_header_has_its_code_and_its_lines(self) -> None:
        self.tangle("One more sentence.\n" + self.CHAPTER.replace("return 1", "return 2"))
        self.assertEqual(self.rewritten(), ["light/Use.hpp", "light/Use.cpp"])
        self.assertIn('#line 8 "Use.nw"\nreturn 2;', self.text("light/Use.hpp"))
        self.assertEqual(self.line_of_use(), 4)

    def test_a_kept_header_whose_code_changes_at_last_has_one_text(self) -> None:
        self.tangle("One more sentence.\n" + self.CHAPTER)
        self.tangle("One more sentence.\n" + self.CHAPTER.replace("return 1", "return 2"))
        self.assertEqual(sorted(os.listdir(self.path("light"))), ["Use.cpp", "Use.hpp"])
        self.assertEqual(self.line_of_use(), 4)

    def test_exact_lines_when_they_are_counted(self) -> None:
        self.tangle("One more sentence.\n" + self.CHAPTER)
        self.tangle("One more sentence.\n" + self.CHAPTER, "--exact")
        self.assertEqual(self.rewritten(), ["light/Use.hpp", "light/Use.cpp"])
        self.assertEqual(sorted(os.listdir(self.path("light"))), ["Use.cpp", "Use.hpp"])

    def test_without_lines_none_are_kept(self) -> None:
        self.tangle(self.CHAPTER, "--plain")
        self.assertNotIn("#line", self.text("light/Use.hpp"))

    def test_another_build_waits_and_tangles_the_chapter_of_now(self) -> None:
        with open(os.path.join(self.dir, "Use.nw"), "w", encoding="utf-8") as file:
            file.write(self.CHAPTER.replace("return 1", "return 2"))
        folder = os.open(os.path.join(self.dir, "generated"), os.O_RDONLY)
        self.addCleanup(os.close, folder)
        fcntl.flock(folder, fcntl.LOCK_EX)
        with subprocess.Popen(self.command(), cwd=self.dir) as waiting:
            with self.assertRaises(subprocess.TimeoutExpired):
                waiting.wait(2)
            self.assertEqual(self.rewritten(), [])
            with open(os.path.join(self.dir, "Use.nw"), "w", encoding="utf-8") as file:
                file.write(self.CHAPTER.replace("return 1", "return 33"))
            fcntl.flock(folder, fcntl.LOCK_UN)
        self.assertEqual(waiting.returncode, 0)
        self.assertIn("return 33", self.text("light/Use.hpp"))

    def test_many_builds_at_once_leave_whole_files_and_nothing_else(self) -> None:
        builds = [subprocess.Popen(self.command(), cwd=self.dir) for _ in range(8)]
        self.assertEqual([build.wait() for build in builds], [0] * 8)
        self.assertEqual(sorted(os.listdir(os.path.join(self.dir, "generated", "light"))), ["Use.cpp", "Use.hpp"])
        self.assertEqual(self.rewritten(), [])


class Report(unittest.TestCase):
    """The page of a run, laid out from its JSON."""

    COUNTS: dict[str, Any] = {"reproduced": 1, "erratum": 0, "differs": 1, "not testable": 0, "input": 2, "implementation": 3}
    CLAIM: dict[str, Any] = {"name": "r", "sentence": "a < b", "quantity": "", "criterion": "half a unit", "source": "print", "repeats": "",
             "fit": "", "unknowns": 0, "printed": "1.25", "ours": "1.2512", "residual": 0.00123, "cause": "", "verdict": "reproduced"}
    OTHER = dict(CLAIM, name="d", sentence='seen "so"', printed="", residual=None, fit="sun", unknowns=2, verdict="differs")
    ITEM: dict[str, Any] = {"id": "T1", "title": "One & only", "place": "page 1", "failure": "", "counts": COUNTS, "claims": [CLAIM, OTHER],
            "pictures": [{"file": "T1/curve.svg", "caption": "A <curve>", "drawn": True}], "tables": ["T1/curve.csv"], "values": {}}
    RUN: dict[str, Any] = {"good": True, "whole": True, "counts": COUNTS, "own": COUNTS, "repeats": 0, "fitted": {"rows": 0, "counted": 0},
           "changes": [], "items": [ITEM]}

    def test_the_page_holds_each_claim_once_and_escapes_it(self) -> None:
        page = report.page(self.RUN)
        for name in "rd":
            self.assertEqual(page.count(f"<code>{name}</code>"), 1)
        for text in ("a &lt; b", "One &amp; only", "seen &#34;so&#34;", "A &lt;curve&gt;", '<img src="T1/curve.svg"', ">0.0012</td>",
                     "half a unit (print); fitted (sun, 2 unknowns)<", "2 sentences and printed numbers: 1 reproduced",
                     "2 inputs and 3 properties", '<a href="T1/curve.csv">curve.csv</a>', "Every verdict is the committed one."):
            self.assertIn(text, page)
        for text in ("{{", "{%", "a < b", "failed", "fitted rows", "rows repeat", "some items only", "gnuplot"):
            self.assertNotIn(text, page)
        self.assertLess(page.index('href="#T1"'), page.index('<section id="T1">'))

    def test_what_is_not_as_committed_is_told(self) -> None:
        broken = dict(self.ITEM, id="T2", failure="it <broke>", claims=[], pictures=[dict(self.ITEM["pictures"][0], drawn=False)])
        page = report.page(dict(self.RUN, good=False, whole=False, items=[self.ITEM, broken], repeats=7, fitted={"rows": 3, "counted": 1},
                                changes=[{"item": "T1", "claim": "r", "committed": "", "now": "differs"},
                                         {"item": "T1", "claim": "x", "committed": "erratum", "now": ""}]))
        for text in ("not what was committed", "some items only", "gnuplot is not installed", "T2 failed: it &lt;broke&gt;",
                     "T1 r: committed nothing, now differs", "T1 x: committed erratum, now gone", "3 fitted rows count as 1\n",
                     "7 rows repeat others"):
            self.assertIn(text, page)
        self.assertEqual(page.count("<img"), 1)

    @unittest.skipIf(not shutil.which("tidy"), "not installed: tidy")
    def test_the_page_is_valid_html(self) -> None:
        done = subprocess.run(["tidy", "-quiet", "-errors"], input=report.page(self.RUN), capture_output=True, text=True)
        self.assertEqual([line for line in done.stderr.splitlines() if "attribute \"loading\"" not in line], [])  # younger than tidy

    def test_negative_control_a_report_that_lacks_something_is_refused(self) -> None:
        for key in ("good", "whole", "own", "fitted", "changes", "items"):
            with self.subTest(key), self.assertRaises(jinja2.UndefinedError):
                report.page({name: value for name, value in self.RUN.items() if name != key})


class Parts(unittest.TestCase):
    """The weaver's parts by themselves."""

    def test_latex_has_the_lines_of_the_chapter(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "first.nw")
            with open(path, "w", encoding="utf-8") as file:
                file.write(FIRST)
            latex = noweb.read([path])[0].latex().split("\n")
        written = FIRST.split("\n")
        self.assertEqual(len(latex), len(written))
        for number, line in enumerate(written):
            if line.startswith("\\"):
                self.assertEqual(latex[number], line, f"line {number + 1}")

    def test_every_chapter_of_the_book_keeps_its_lines(self) -> None:
        for folder, _, files in os.walk(os.path.join(ROOT, "nw")):
            for name in files:
                path = os.path.join(folder, name)
                with open(path, encoding="utf-8") as file:
                    text = file.read()
                with self.subTest(name):
                    self.assertEqual(noweb.read([path])[0].latex().count("\n"), text.count("\n"))

    def test_coloured_code_loses_no_character(self) -> None:
        code = 'R"(a "raw" // string)" \'"\' 1\'000.5e-3 /* two\nlines */ #include <x>\n#include <y>\nauto s = "\\"//";'
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "code.nw")
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"Text.\n<<Code>>=\n{code}\n@\n")
            chapters = noweb.read([path])
        painted = listing.HtmlListing(chapters).code(chapters[0].chunks[0])
        self.assertEqual(html.unescape(re.sub(r"<[^>]*>", "", painted)), code)
        self.assertIn('<span class="comment">/* two\nlines */</span>', painted)
        self.assertIn('<span class="string">"\\"//"</span>', painted)

    def test_an_identifier_is_described_by_the_comment_at_its_declaration(self) -> None:
        lines = ["/// Rays of a pixel. All are cast.", "template <class T>", "int rays(T pixel);", "int bands;  ///< how many",
                 "int none;  // no", "// rays of nothing"]
        self.assertEqual(listing.comment_on("rays", lines), "Rays of a pixel")
        self.assertEqual(listing.comment_on("bands", lines), "how many")
        self.assertEqual(listing.comment_on("none", lines), "")
        self.assertEqual(listing.comment_on("ray", lines), "")

    def test_bibliography_entry_without_a_needed_field_stops_with_its_line(self) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".bib") as file:
            file.write("% comment\n@book{good, title = {A {B}}, publisher = {P}, year = {1999}}\n"
                       "@article{bad, author = {C, D}, title = {E}, year = {2000}}\n")
            file.flush()
            with self.assertRaisesRegex(Problem, r":3: bad lacks journal"):
                references.read(file.name)

    def test_names_of_people(self) -> None:
        self.assertEqual(references.people(["Max Born", "Emil Wolf"]), "Max Born and Emil Wolf")
        self.assertEqual(references.people(["B A", "D C", "F E"]), "B A, D C and F E")

    def test_slugs(self) -> None:
        self.assertEqual(latexml.slug("Add: the (two) Stokes_vectors!"), "add-the-two-stokes-vectors")


class Places(unittest.TestCase):
    """Where a chapter is: volumes, parts and their order."""

    def contents(self, text: str) -> contents.Contents:
        with tempfile.NamedTemporaryFile("w", suffix=".ini") as file:
            file.write(text)
            file.flush()
            return contents.Contents(file.name)

    def test_chapters_come_as_the_parts_name_them_and_new_ones_last_in_the_rest(self) -> None:
        found = self.contents(CONTENTS + "  light/moved\n[files]\nvolume = 2\ntitle = F\nabout = A.\nrest = files\n")
        paths = ["doc/back/open.tex", "nw/files/new.nw", "nw/light/moved.nw", "nw/surface/second.nw", "nw/light/first.nw", "doc/front/a.tex"]
        self.assertEqual(found.ordered(paths), ["doc/front/a.tex", "nw/light/first.nw", "nw/surface/second.nw", "nw/light/moved.nw",
                                                "nw/files/new.nw", "doc/back/open.tex"])

    def test_negative_controls(self) -> None:
        with self.assertRaisesRegex(Problem, "none takes the rest of air"):
            self.contents(CONTENTS).ordered(["nw/air/Sun.nw"])
        with self.assertRaisesRegex(Problem, "surface/second is in the parts surface and again"):
            self.contents(CONTENTS + "[again]\nvolume = 2\ntitle = A\nabout = A.\nchapters = surface/second\n")

    def test_the_order_of_the_floors_names_each_chapter_once(self) -> None:
        with open(os.path.join(ROOT, "nw", "order.txt"), encoding="utf-8") as file:
            named = [line.split()[0] for line in file if line.strip() and not line.startswith("#")]
        self.assertEqual(sorted(named), sorted(set(named)))

    def test_every_chapter_that_the_book_names_is_there(self) -> None:
        whole = contents.Contents(os.path.join(ROOT, "doc", "book", "book.ini"))
        named = list(whole.homes) + [key for key, _ in whole.readers_path]
        self.assertEqual([key for key in named if not os.path.exists(os.path.join(ROOT, "nw", key + ".nw"))
                          and not os.path.exists(os.path.join(ROOT, "doc", "book", key + ".tex"))], [])


class CheckTest(unittest.TestCase):
    """Rules that one chapter alone cannot see: floors, circles, names; lengths over the chunks that they consist of."""

    def said_of_chapters(self, chapters: dict[str, str]) -> list[str]:
        """The messages of the check for chapters by floor and name, each with the code of one header."""
        with tempfile.TemporaryDirectory() as directory:
            for name, code in chapters.items():
                path = os.path.join(directory, "nw", name + ".nw")
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "w", encoding="utf-8") as file:
                    file.write(f"\\chapter{{{name}}}\n\n<<{name}.hpp>>=\n{code}@\n")
            run = subprocess.run([os.path.join(WEAVER, "check.py"), *(f"nw/{name}.nw" for name in chapters)],
                                 cwd=directory, capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, int(bool(run.stderr)))
            return run.stderr.splitlines()

    def test_an_include_does_not_climb(self) -> None:
        includes = '#pragma once\n#include "malus/{}.hpp"\n'
        falls = {"base/Low": "struct Low {};\n", "light/High": includes.format("base/Low")}
        self.assertEqual(self.said_of_chapters(falls), [])
        climbs = {"base/Low": includes.format("light/High"), "light/High": "struct High {};\n"}
        self.assertEqual(self.said_of_chapters(climbs), ["nw/base/Low.nw:5: base must not include light: an include never climbs"])
        # python uses files, and is beside app
        self.assertEqual(self.said_of_chapters({"python/Me": includes.format("files/Cube"), "files/Cube": ""}), [])
        self.assertEqual(self.said_of_chapters({"python/Me": includes.format("app/Main"), "app/Main": ""}),
                         ["nw/python/Me.nw:5: python must not include app: an include never climbs"])

    def test_includes_make_no_circle(self) -> None:
        def includes(name: str) -> str:
            return f'#include "malus/base/{name}.hpp"\n'
        line = {"base/A": includes("B"), "base/B": includes("C"), "base/C": "struct C {};\n"}
        self.assertEqual(self.said_of_chapters(line), [])
        self.assertEqual(self.said_of_chapters(line | {"base/C": includes("A")}),
                         ["nw/base/A.nw: a circle of includes: base/A > base/B > base/C > base/A"])

    def test_cd_is_for_the_thesis(self) -> None:
        self.assertEqual(self.said_of_chapters({"base/Vector": "struct CDVector {};\n"}), [])
        self.assertEqual(self.said_of_chapters({"base/Vector": "struct Vector {\n  CDNew n;\n};\n"}),
                         ["nw/base/Vector.nw:5: CDNew is not a name of the thesis; leave out the CD"])

    def said_of(self, lines_of_a_function: int, functions: int) -> str:
        """The messages of the check for a chapter with so many functions, the middle of each in a separate chunk."""
        body = "  ++n;\n" * (lines_of_a_function - 3)
        chapter = "".join(f"<<Middle {i}>>=\n{body}@\n" for i in range(functions)) + "<<base/Long.cpp>>=\n"
        chapter += "".join(f"int count{i}(\n    int n) {{\n  // no code\n\n  <<Middle {i}>>\n}}\n" for i in range(functions))
        with tempfile.TemporaryDirectory() as directory:
            os.mkdir(os.path.join(directory, "base"))
            path = os.path.join(directory, "base", "Long.nw")
            with open(path, "w", encoding="utf-8") as file:
                file.write(chapter + "@\n")
            run = subprocess.run([os.path.join(WEAVER, "check.py"), path], capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, int(bool(run.stderr)))
            return run.stderr

    def test_limits_are_kept(self) -> None:
        self.assertEqual(self.said_of(70, 1), "")
        self.assertEqual(self.said_of(55, 10), "")

    def test_one_line_more_is_told(self) -> None:
        self.assertIn("71 lines in a function of base/Long.cpp: int count0(; part it", self.said_of(71, 1))
        self.assertIn("base/Long.cpp has 560 lines of code", self.said_of(56, 10))


if __name__ == "__main__":
    unittest.main()
