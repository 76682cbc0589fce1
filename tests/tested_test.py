#!/usr/bin/python3
"""The weaver's tests of the tests that it shows: beside the chapters, on separate pages, and on paper.

Identity: what must be on the pages of a book of two chapters, and that every test of the program is in a table. Negative
controls: a file of tests without a chapter, a chapter that does not exist, a link to a place that is missing.
"""
import html
import json
import os
import re
import unittest

import weave_test

# weave_test leads to the weaver
import tested

CPP_TESTS = """// Squares & roots (nw/light/first.nw).
#include "malus/light/first.hpp"

// ---- the suite
TEST(firstIdentity, AnyRootIsSmithsRoot) {
  EXPECT_LT(reflect_it(2), "a long <message>");
}

// Half a unit of the last digit. A second sentence.
TEST(firstPublished, TheSquare) {
  EXPECT_NE(Reflect(2), 5) << "negative control";
}
RC_GTEST_PROP(firstInvariant, NegativeControlAnotherSquare, ()) {  // negative control
}
"""

OTHER_TESTS = """// Two files for one chapter (nw/surface/second.nw).
TEST(OtherIdentity, Alone) {
}
"""

PYTHON_TESTS = '''"""Roots from Python (nw/light/first.nw)."""


class Roots:
    def test_the_root_of_four(self) -> None:
        """It is two."""
        assert 4 ** .5 == 2  # "by hand"
'''


class TestedBook(weave_test.Workshop):
    """Tests beside the code."""

    def setUp(self) -> None:
        super().setUp()
        self.put("tests/first_test.cpp", CPP_TESTS)
        self.put("tests/other_test.cpp", OTHER_TESTS)
        self.put("tests/python/test_roots.py", PYTHON_TESTS)
        self.put("tests/weaver_test.py", "def test_nothing() -> None:\n    pass\n")  # of the book itself
        self.put("tests/browser.py", "")
        self.put("nw/light/first.nw", weave_test.FIRST + "\\section{How it is tested}\n"
                 "See \\texttt{tests/first\\_test.cpp}.\n\\section{More}\nMore.\n")

    def woven(self) -> None:
        self.assertEqual(self.weave(), (0, ""))
        self.first, self.source = self.get("light-first.html"), self.get("first_test.html")

    def test_a_chapter_ends_its_section_with_the_tests_and_each_leads_to_its_source(self) -> None:
        self.woven()
        self.assertEqual(self.check_links(), (0, ""))
        section = re.search(r'(?s)<section id="how-it-is-tested".*?(?=<section id="more")', self.first)
        assert section
        self.assertIn('<a href="first_test.html"><span class="ltx_text ltx_font_typewriter">tests/first_test.cpp</span></a>', section[0])
        table = section[0][section[0].index('<details class="tests" id="tests-of-the-chapter" open>'):]
        self.assertIn("<summary>4 tests: 1 identity, 1 invariant, 1 published; 2 with a negative control</summary>", table)
        self.assertIn('<a href="first_test.html#firstPublished.TheSquare" title="firstPublished.TheSquare">The square</a>'
                      '<span class="about">Half a unit of the last digit.</span></td>'
                      '<td>published<span class="about">with a control</span>', table)
        self.assertIn('title="firstInvariant.NegativeControlAnotherSquare">Another square</a></td>'
                      '<td>invariant<span class="about">negative control', table)
        self.assertIn('<a href="test_roots.html#Roots.test_the_root_of_four" title="Roots.test_the_root_of_four">The root of four</a>'
                      '<span class="about">It is two.</span>', table)
        self.assertRegex(self.get("surface-second.html"), r'(?s)<details class="tests".*other_test\.html#OtherIdentity\.Alone.*</section>')

    def test_the_source_has_its_lines_its_colours_and_a_place_for_each_test(self) -> None:
        self.woven()
        code = re.search(r'(?s)<pre class="listing"><code>(.*)</code></pre>', self.source)
        assert code
        self.assertEqual(html.unescape(re.sub(r"<[^>]*>", "", code[1])), CPP_TESTS)
        numbers = re.search(r'<pre class="line-numbers" aria-hidden="true">([\d\n]*)</pre>', self.source)
        self.assertEqual(numbers and numbers[1].split("\n"), [str(line + 1) for line in range(CPP_TESTS.count("\n"))])
        self.assertIn('<span class="test" id="firstPublished.TheSquare">TEST(', code[1])
        self.assertIn('<span class="string">"a long &lt;message&gt;"</span>', code[1])
        self.assertIn('<a rel="up" href="light-first.html">Reflection</a>', self.source)
        self.assertIn('<p>3 tests: 1 identity, 1 invariant, 1 published; 2 with a negative control, for '
                      '<a href="light-first.html#tests-of-the-chapter">Reflection</a>.</p>', self.source)
        self.assertIn('<span class="keyword">assert</span> <span class="number">4</span>', self.get("test_roots.html"))
        self.assertIn('<span class="comment"># "by hand"</span>', self.get("test_roots.html"))
        self.assertRegex(self.get("tests.html"), r'<td><a href="other_test.html">tests/other_test.cpp</a></td><td>1 test, identity</td>')
        self.assertNotIn("weaver_test", self.get("tests.html"))

    def test_search_finds_tests_by_words_and_by_name(self) -> None:
        self.woven()
        index = json.loads(self.get("search-index.js").removeprefix("const INDEX = ").removesuffix(";\n"))
        tests = {section[1]: section for section in index["sections"] if section[3] == 2}
        self.assertEqual(tests["firstPublished.TheSquare"][2], "The square")
        self.assertEqual(index["pages"][tests["firstPublished.TheSquare"][0]], ["first_test.html", "tests/first_test.cpp"])
        for word in ("anyrootissmithsroot", "message"):
            self.assertIn(word, index["words"])
        chapter = [text for section, text in zip(index["sections"], index["texts"]) if section[1] == "how-it-is-tested"]
        self.assertEqual(chapter, ["See tests/first_test.cpp."])  # the table is found at the tests themselves

    def test_a_changed_test_is_woven_again_and_a_table_of_many_is_closed(self) -> None:
        self.woven()
        self.put("tests/first_test.cpp", CPP_TESTS + "".join(f"TEST(firstIdentity, Case{i}) {{\n}}\n" for i in range(5)))
        self.woven()
        self.assertIn('id="firstIdentity.Case4"', self.source)
        self.assertIn('<details class="tests" id="tests-of-the-chapter">\n<summary>9 tests: 6 identities, ', self.first)

    def test_names_as_words(self) -> None:
        wording = tested.Wording(["In general Smith and the BRDF of Torrance-Sparrow are a mirror's root."])

        def words(name: str) -> str:
            file = tested.TestFile(os.path.join(self.dir, "tests/first_test.cpp"))
            return wording.words(tested.Test(file, "", name, 0, 0, ""))
        for name, expected in (("ASmithsRootIsSmith", "A Smith's root is Smith"), ("ABRDFOfS3IsNaN", "A BRDF of S3 is NaN"),
                               ("TorranceAndSparrowsMirrorsRoots", "Torrance and Sparrow's mirror's roots"), ("Section71", "Section 71"),
                               ("NegativeControlABRDF", "A BRDF"), ("test_brdf_of_a_root", "BRDF of a root")):
            self.assertEqual(words(name), expected)

    def test_the_sentence_above_a_test(self) -> None:
        for comment, expected in (("negative control", ""), ("bands.", ""), ("claim C3", "Claim C3."), ("f E cos. Half", "f E cos."),
                                  ("1e-6: rounding. More.", "1e-6: rounding."), ("Is it so? It is.", "Is it so?"),
                                  ("The other has the opposite U. One, i.e. alone", "The other has the opposite U.")):
            self.assertEqual(tested.first_sentence(comment), expected)

    def fails(self, *fragments: str) -> None:
        code, complaint = self.weave()
        self.assertEqual(code, 1)
        for fragment in fragments:
            self.assertIn(fragment, complaint)
        self.assertFalse(os.path.exists(os.path.join(self.dir, "book")), "half a book was written")

    def test_negative_control_a_file_that_belongs_to_no_chapter(self) -> None:
        self.put("tests/other_test.cpp", OTHER_TESTS.replace(" (nw/surface/second.nw)", ""))
        self.put("tests/python/test_roots.py", PYTHON_TESTS.replace("(nw/light/first.nw)", ""))
        self.fails("tests/other_test.cpp:1: belongs to no chapter", "tests/python/test_roots.py:1: belongs to no chapter")

    def test_negative_control_a_chapter_that_does_not_exist(self) -> None:
        self.put("tests/other_test.cpp", OTHER_TESTS.replace("second.nw", "third.nw"))
        self.fails("tests/other_test.cpp:1: its head names third.nw, but there is no such chapter")

    def test_negative_control_a_test_whose_place_is_missing(self) -> None:
        self.woven()
        self.put("book/first_test.html", self.source.replace(' id="firstPublished.TheSquare"', ""))
        code, complaint = self.check_links()
        self.assertEqual(code, 1)
        self.assertRegex(complaint, "light-first.html:.*: first_test.html#firstPublished.TheSquare names no place of that page")


@unittest.skipIf(weave_test.lacks(weave_test.PAPER), weave_test.lacks(weave_test.PAPER) + " (make pdf installs it)")
class PrintedTests(weave_test.Workshop):
    """The same on paper, in a few words."""

    def test_the_tests_of_a_chapter_are_in_its_section_in_a_few_words(self) -> None:
        self.put("tests/first_test.cpp", CPP_TESTS)
        self.put("nw/light/first.nw", weave_test.FIRST + "\\section{How it is tested}\nBy hand.\n\\section{Exercises}\nNone.\n")
        self.assertEqual(self.weave_pdf(), (0, ""))
        first, second = map(self.get_work, ("light-first.tex", "surface-second.tex"))
        self.assertRegex(first, r"By hand\.\n\\littests\{\\litcode\{tests/first\\_test\.cpp\}, 3 tests: 1 identity, 1 invariant, 1 published;"
                         r" 2 with a negative control\.\}\{.*\\emph\{Published:\} The square \(with a control\)\.\}\\section\{Exercises\}")
        self.assertNotIn("littests", second)

    def get_work(self, name: str) -> str:
        """A file that LuaLaTeX read."""
        with open(os.path.join(self.shared, "pdf", name), encoding="utf-8") as file:
            return file.read()


class AllTests(unittest.TestCase):
    """The tests of the program and their chapters."""

    def setUp(self) -> None:
        self.tests = tested.Tests(os.path.join(weave_test.ROOT, "tests"))
        paths = [os.path.join(folder, file) for folder, _, files in os.walk(os.path.join(weave_test.ROOT, "nw")) for file in files]
        self.chapters = [os.path.basename(path).removesuffix(".nw") for path in paths if path.endswith(".nw")]
        self.tests.attach(self.chapters)

    def test_every_test_is_in_the_table_of_a_chapter(self) -> None:
        listed = {(test.file.path, test.full) for chapter in self.chapters for test in self.tests.of(chapter)}
        missing = []
        for file in self.tests.files:
            if not file.is_python:
                with open(file.path, encoding="utf-8") as lines:
                    begun = re.findall(r"^\w*(?:TEST\w*|PROP)\(\s*(\w+),\s*(\w+)", lines.read(), re.MULTILINE)
                self.assertGreater(len(begun), 0, file.path)
                missing += [f"{file.path}: {suite}.{name}" for suite, name in begun if (file.path, f"{suite}.{name}") not in listed]
        self.assertEqual(missing, [])

    def test_a_chapter_after_which_a_suite_is_called_has_only_its_tests(self) -> None:
        self.assertEqual({test.subject for test in self.tests.of("CubeView")}, {"CubeView"})
        self.assertLess(len(self.tests.of("CubeView")), len(self.tests.of("Cube")) + len(self.tests.of("Quicklooks")))


if __name__ == "__main__":
    unittest.main()
