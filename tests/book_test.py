#!/usr/bin/python3
"""The woven book, looked at from outside: book_test.py [BOOK [HEADERS]]; default build/book and generated/malus.

Each page must be valid HTML, fit a phone, a tablet and a desk without sideways scrolling, and leave the browser's
console silent; its colours must be distinguishable in the light and the dark theme; every public name of every header
must be in the index with a description; every item of the inventory must be reachable from the last part, and
every test from a chapter.
(Broken links and anchors, and what LaTeXML complains of, stop the weaving itself.)

The HTML is checked by tidy, which verifies the nesting of elements, as a mere parser does not, and reads the whole book
in seconds. The negative controls at the end spoil one thing each.
"""
import csv
import glob
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import browser

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BOOK = os.path.join(ROOT, "build", "book")
HEADERS = os.path.join(ROOT, "generated", "malus")
WIDTHS = (360, 800, 1400)
LEAST_CONTRAST = 4.5  # of text on its ground, as WCAG 2 requires at level AA

# Messages of tidy 5.6 about valid pages: it lacks two attributes of newer standards, and those of drawings
# style and links; and empty elements that carry a meaning by their class are not errors.
EXPLAINED = re.compile(r'<math> proprietary attribute "alttext"|<a> proprietary attribute "(aria-current|href)"'
                       r"|trimming empty <span>|moved <style> tag to <head>")


def lacks(command: str | None, package: str) -> str:
    """Why a test cannot run here. Where CI is set nothing is skipped."""
    return "" if os.environ.get("CI") or command else f"not installed: {package}"


def pages() -> list[str]:
    return sorted(glob.glob(os.path.join(BOOK, "*.html")))


def read(path: str) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


def invalid(paths: list[str]) -> list[str]:
    """The problems that tidy finds in pages."""
    done = subprocess.run(["tidy", "-quiet", "-errors", "--gnu-emacs", "yes", "--show-warnings", "yes", *paths],
                          capture_output=True, text=True)
    return [line for line in done.stderr.splitlines() if line.strip() and not EXPLAINED.search(line)]


def headings_amiss(text: str) -> list[str]:
    """A page has one h1, first, and no level is left out on the way down."""
    levels = [int(level) for level in re.findall(r"<h([1-6])\b", text)]
    amiss = [f"h{a} is followed by h{b}" for a, b in zip(levels, levels[1:]) if b > a + 1]
    return amiss + (["no h1 at the beginning"] if levels[:1] != [1] else []) + (["two h1"] if levels.count(1) > 1 else [])


def luminance(colour: str) -> float:
    parts = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    linear: list[float] = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a: str, b: str) -> float:
    bright, dark = sorted((luminance(a), luminance(b)), reverse=True)
    return (bright + 0.05) / (dark + 0.05)


def faint(css: str) -> list[str]:
    """Pairs of text and ground in the dress of the book that are too close to each other."""
    out: list[str] = []
    for scheme in re.findall(r":root \{(.*?)\}", css, re.DOTALL):
        colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", scheme))
        grounds = {"paper": ("ink", "quiet", "link", "keyword", "comment", "string", "number"), "side": ("ink", "quiet", "link"),
                   "code": ("ink", "quiet", "link", "keyword", "comment", "string", "number"), "mark": ("ink", "link")}
        out += [f"{text} on {ground}: {contrast(colours[text], colours[ground]):.2f}" for ground, texts in grounds.items()
                for text in texts if contrast(colours[text], colours[ground]) < LEAST_CONTRAST]
    return out


def declared(folder: str) -> dict[str, str]:
    """{full name: header} of what the headers make public, by Universal Ctags."""
    headers = sorted(glob.glob(os.path.join(folder, "*", "*.hpp")))
    done = subprocess.run(["ctags", "--output-format=json", "--languages=C++", "--kinds-C++=+p-dn", "--fields=+as", "-f", "-",
                           *headers], capture_output=True, text=True, check=True)
    names = {}
    for line in done.stdout.splitlines():
        tag = json.loads(line)
        scope, name = tag.get("scope", ""), re.sub(r"^operator (?=\W)", "operator", tag["name"])
        if (scope.startswith("malus") and "detail" not in scope and "__anon" not in scope and tag["scopeKind"] != "function"
                and tag.get("access", "public") == "public" and name != scope.split("::")[-1]
                and not name.startswith("~") and name != "operator="
                and (tag["scopeKind"] == "namespace" or "access" in tag)):
            names["::".join(scope.split("::")[1:] + [name])] = os.path.relpath(tag["path"], folder)
    return names


def indexed(text: str) -> dict[str, str]:
    """{name: description} of the index of identifiers."""
    rows = re.findall(r'<tr id="id-[^"]*"><td><code>(.*?)</code></td><td>(.*?)</td>', text, re.DOTALL)
    return {html.unescape(name): about.strip() for name, about in rows}


def unmapped(chain: str, files: list[str]) -> list[str]:
    """Chapters of the floors to which no box of the page with the map leads."""
    boxes = set(re.findall(r'<a href="([^"#]*)#[^"]*"><rect', chain))
    return [file for file in files if "-" in file and file not in boxes]


def unshown(sources: dict[str, str], book: dict[str, str]) -> list[str]:
    """Tests of GoogleTest without a place on the page of their file, or to which no chapter leads."""
    linked = {link for name, text in book.items() if "-" in name for link in re.findall(r'<tr><td><a href="([^"#]*_test\.html#[^"]*)"', text)}
    out = []
    for path, text in sources.items():
        page = os.path.basename(path).replace(".cpp", ".html")
        places = set(re.findall(r' id="([^"]*)"', book.get(page, "")))
        for suite, name in re.findall(r"^(?:TEST|TEST_F|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)", text, re.MULTILINE):
            if f"{suite}.{name}" not in places or f"{page}#{suite}.{name}" not in linked:
                out.append(f"{path}: {suite}.{name}")
    return out


class Pages(unittest.TestCase):
    """Tests without a browser."""

    def test_the_book_is_there(self) -> None:
        self.assertTrue(os.path.isfile(os.path.join(BOOK, "index.html")), f"no book in {BOOK}: make book")

    @unittest.skipIf(lacks(shutil.which("tidy"), "tidy"), lacks(shutil.which("tidy"), "tidy"))
    def test_the_guide_shows_the_end_of_make(self) -> None:
        summary = {line.rstrip() for line in read(os.path.join(os.path.dirname(BOOK), "report", "summary.txt")).split("\n")}
        shown = read(os.path.join(ROOT, "doc", "guide.md")).split("    r reproduced")[1].split("    The report:")[0]
        lines = ["r reproduced" + shown.split("\n", 1)[0]] + [line[4:].rstrip() for line in shown.split("\n")[1:]]
        self.assertLessEqual({line for line in lines if line not in ("", "...")} - {"every claim: build/report/report.json"}, summary)
        self.assertNotIn(lines[-5].replace("reproduced", "produced"), summary, "the control: another line")

    def test_html_is_valid(self) -> None:
        self.assertEqual(invalid(pages()), [])

    def test_headings_are_in_order(self) -> None:
        self.assertEqual({os.path.basename(path): amiss for path in pages() if (amiss := headings_amiss(read(path)))}, {})

    def test_colours_are_told_apart_in_the_light_and_in_the_dark(self) -> None:
        css = read(os.path.join(BOOK, "book.css"))
        self.assertEqual(css.count(":root {"), 2)
        self.assertEqual(faint(css), [])

    @unittest.skipIf(lacks(shutil.which("ctags"), "universal-ctags"), lacks(shutil.which("ctags"), "universal-ctags"))
    def test_every_public_name_of_every_header_is_indexed_and_described(self) -> None:
        index = indexed(read(os.path.join(BOOK, "identifiers.html")))
        self.assertEqual({name: header for name, header in declared(HEADERS).items() if not index.get(name)}, {})

    def test_every_chapter_is_a_box_of_the_map(self) -> None:
        files = [os.path.basename(path) for path in pages()]
        self.assertGreater(len([file for file in files if "-" in file]), 80)
        self.assertEqual(unmapped(read(os.path.join(BOOK, "chain.html")), files), [])

    def test_every_test_has_its_source_and_a_chapter_that_leads_there(self) -> None:
        sources = {path: read(path) for path in glob.glob(os.path.join(ROOT, "tests", "*_test.cpp"))}
        book = {os.path.basename(path): read(path) for path in pages()}
        self.assertGreater(len(sources), 100)
        self.assertEqual(unshown(sources, book), [])

    def test_every_item_of_the_inventory_is_reachable_from_the_last_part(self) -> None:
        """A row of its table leads to chapter and code, or owns that nothing is built yet."""
        with open(os.path.join(ROOT, "validation", "inventory.csv"), encoding="utf-8") as file:
            items = [row["id"] for row in csv.DictReader(line for line in file if not line.startswith("#"))]
        rows = re.findall(r'<tr class="ltx_tr"[^>]*>.*?</tr>', read(os.path.join(BOOK, "thesis-Inventory.html")), re.DOTALL)
        leads = {match[1]: 'href="' in row or "not built" in row for row in rows if (match := re.search(r'id="item-([^"]*)"', row))}
        self.assertGreater(len(items), 80)
        self.assertEqual([item for item in items if not leads.get(item)], [])


# elements that extend beyond the window and cannot be scrolled in place
OVERFLOW = """(() => {
  const page = document.documentElement, width = page.clientWidth;
  if (page.scrollWidth <= width) return "";
  const kept = (e) => { for (let p = e.parentElement; p && p !== document.body; p = p.parentElement)
    if (getComputedStyle(p).overflowX !== "visible") return true; return false; };
  const out = [...document.querySelectorAll("main *, nav *, .top *")].filter((e) => e.getBoundingClientRect().right > width + 1 && !kept(e));
  return `${page.scrollWidth} pixels wide: ` + out.slice(-2).map((e) => e.tagName + "." + e.className + " " +
    e.textContent.trim().slice(0, 50)).join("; ");
})()"""


@unittest.skipIf(lacks(browser.program(), "chromium"), lacks(browser.program(), "chromium"))
class InABrowser(unittest.TestCase):
    """Every page at three widths, in one browser."""

    browser: browser.Browser

    @classmethod
    def setUpClass(cls) -> None:
        cls.browser = browser.Browser().__enter__()
        cls.addClassCleanup(cls.browser.__exit__)

    def amiss(self, path: str) -> list[str]:
        """The problems of a page, at any width."""
        self.browser.size(WIDTHS[0])
        self.browser.open("file://" + path)
        out = []
        for width in WIDTHS:
            self.browser.size(width)
            if overflow := self.browser.value(OVERFLOW):
                out.append(f"at {width}: {overflow}")
        return out + self.browser.complaints()

    def test_every_page_fits_and_the_console_is_silent(self) -> None:
        self.assertEqual({os.path.basename(path): amiss for path in pages() if (amiss := self.amiss(path))}, {})

    def found(self, query: str) -> list[str]:
        self.browser.open(f"file://{BOOK}/search.html?q={query}")
        self.assertEqual(self.browser.complaints(), [])
        leads: list[str] = self.browser.value('[...document.querySelectorAll("#results a")].map((a) => a.getAttribute("href"))')
        return leads

    def test_search_leads_to_places_that_exist(self) -> None:
        leads = self.found("brewster+angle")
        self.assertGreater(len(leads), 0)
        self.assertIn("identifiers.html#id-CDStokesVector", self.found("cdstokesvector"))
        for address in leads:
            page, _, anchor = address.partition("#")
            self.assertIn(f'id="{anchor}"', read(os.path.join(BOOK, page)), address)
        self.assertEqual(self.found("qwertyuiop"), [])

    def test_search_finds_tests_by_their_words_and_by_their_names(self) -> None:
        place = "LayeredLight_test.html#LayeredLightInvariant.EnergyIsConserved"
        for query in ("LayeredLightInvariant.EnergyIsConserved", "energy+is+conserved"):
            self.assertIn(place, self.found(query))

    def test_search_knows_stems_spellings_symbols_and_messages(self) -> None:
        for one, other in (("polarised+light", "polarized+light"), ("roughness", "rough"), ("the+colour+of+metres", "color+meter")):
            with self.subTest(one):
                self.assertEqual(set(self.found(one)) & set(self.found(other)[:5]), set(self.found(other)[:5]))
        self.assertEqual(self.found("%CF%83")[0].split("#")[0], "notation.html")  # the letter sigma
        self.assertTrue(any(address.startswith("files-SceneChecks.html#chunk-") for address in self.found("camera+is+below+the+ground")))
        self.assertTrue(self.found("torrance+sparrow")[0].startswith("surface-"), "sections come before identifiers")
        self.browser.open(f"file://{BOOK}/search.html?q=shadowing")
        self.assertIn("shadow", self.browser.value('document.querySelector("#results .snippet mark").textContent').lower())

    def test_negative_controls(self) -> None:
        good = read(os.path.join(BOOK, "search.html"))
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(os.path.join(BOOK, "book.css"), folder)
            shutil.copytree(os.path.join(BOOK, "fonts"), os.path.join(folder, "fonts"))

            def spoiled(what: str) -> str:
                path = os.path.join(folder, "spoiled.html")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(re.sub(r"<script.*?</script>", "", good).replace("</main>", what + "</main>"))
                return " ".join(self.amiss(path))
            self.assertEqual(spoiled(""), "")
            self.assertRegex(spoiled('<div style="width: 700px">wide</div>'), "at 360: .*DIV")
            self.assertRegex(spoiled('<script>console.error("planted")</script>'), "planted")
            self.assertRegex(spoiled('<script>nothing.at.all</script>'), "Uncaught")
            self.assertRegex(spoiled('<img src="lost.svg" alt="lost">'), "lost.svg")


class NegativeControls(unittest.TestCase):
    """Each check sees what it is there for."""

    @unittest.skipIf(lacks(shutil.which("tidy"), "tidy"), lacks(shutil.which("tidy"), "tidy"))
    def test_invalid_html(self) -> None:
        page = "<!DOCTYPE html>\n<html lang='en'><head><title>t</title></head><body>{}</body></html>\n"
        for body, complaint in (("<p>good</p>", ""), ("<p><em>open</p>", "em"), ("<p><div>block</div></p>", "implicit <p>"),
                                ("<p id='a'>1</p><p id='a'>2</p>", 'anchor "a" already defined'), ("<blink>x</blink>", "blink")):
            with tempfile.NamedTemporaryFile("w", suffix=".html") as file:
                file.write(page.format(body))
                file.flush()
                said = " ".join(invalid([file.name]))
            with self.subTest(body):
                self.assertTrue(complaint in said and bool(said) == bool(complaint), said)

    def test_headings(self) -> None:
        self.assertEqual(headings_amiss("<h1>a</h1><h2>b</h2><h3>c</h3><h2>d</h2>"), [])
        self.assertTrue(headings_amiss("<h1>a</h1><h3>c</h3>"))
        self.assertTrue(headings_amiss("<h2>a</h2>"))

    def test_contrast(self) -> None:
        self.assertAlmostEqual(contrast("#000000", "#ffffff"), 21)
        self.assertAlmostEqual(contrast("#777777", "#ffffff"), 4.48, places=2)
        css = read(os.path.join(BOOK, "book.css"))
        self.assertTrue(faint(re.sub(r"--quiet: #[0-9a-f]{6}", "--quiet: #a0a0a0", css)))

    def test_map(self) -> None:
        chain = '<a href="light-A.html#ch:A"><rect x="1"/></a> <a href="light-B.html#ch:B">B</a>'
        self.assertEqual(unmapped(chain, ["light-A.html", "light-B.html", "index.html"]), ["light-B.html"])

    def test_tests(self) -> None:
        sources = {"tests/A_test.cpp": "TEST(AIdentity, One) {\n}\nRC_GTEST_PROP(AIdentity, Two, ()) {\n}\n"}
        source = '<span id="AIdentity.One"></span><span id="AIdentity.Two"></span>'
        rows = '<tr><td><a href="A_test.html#AIdentity.One">One</a><tr><td><a href="A_test.html#AIdentity.Two">Two</a>'
        self.assertEqual(unshown(sources, {"light-A.html": rows, "A_test.html": source}), [])
        lost = ["tests/A_test.cpp: AIdentity.Two"]
        self.assertEqual(unshown(sources, {"light-A.html": rows, "A_test.html": source.replace("Two", "Too")}), lost)
        self.assertEqual(unshown(sources, {"light-A.html": rows.replace("Two", "Too"), "A_test.html": source}), lost)
        self.assertEqual(len(unshown(sources, {"light-A.html": rows})), 2)

    @unittest.skipIf(lacks(shutil.which("ctags"), "universal-ctags"), lacks(shutil.which("ctags"), "universal-ctags"))
    def test_names(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "light"))
            with open(os.path.join(folder, "light", "x.hpp"), "w", encoding="utf-8") as file:
                file.write("namespace malus {\nclass Open {\n public:\n  Open();\n  int seen() const;\n private:\n  int hidden;\n};\n"
                           "double free(int x);\nnamespace x_detail { int inner(); }\n}\n")
            self.assertEqual(set(declared(folder)), {"Open", "Open::seen", "free"})


if __name__ == "__main__":
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        BOOK = os.path.abspath(sys.argv.pop(1))
        if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
            HEADERS = os.path.abspath(sys.argv.pop(1))
    unittest.TestCase.maxDiff = None
    unittest.main()
