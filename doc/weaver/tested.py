"""The tests beside the code: which test files there are, what each test is, and to which chapters it belongs.

A file of tests names its chapters in the comment at its head, as nw/floor/Name.nw or Name.nw, and belongs to the
chapter of its name as well. A test that is called after a chapter, by its suite (CubeView: CubeViewIdentity) or by its
first words, is listed in that chapter; others in the chapter of the file's name. A chapter that the head names, and after which no test
is called, has all. The end of a suite's name is the kind of its tests. A file without a chapter stops the book.
"""
import ast
import glob
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from problems import Problem, stop_if_any

KINDS = {"Identity": "identity", "Invariant": "invariant", "Published": "published", "Printed": "published", "Regression": "regression",
         "Refusal": "refusal", "Refusals": "refusal", "ByHand": "by hand", "Control": "control"}
PLURALS = {"identity": "identities", "invariant": "invariants", "refusal": "refusals"}
SUITE = re.compile(rf"(\w+?)({'|'.join(KINDS)})$")
BEGINS = re.compile(r"^(?:TEST|TEST_F|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)", re.MULTILINE)
ABOVE = re.compile(r"(?:^(?://|#)(?! ?----).*\n)+\Z", re.MULTILINE)  # the comment that ends where a test begins
CONTROL = re.compile(r"negative[ _]?control|(?://|#).*\bcontrols?\b", re.IGNORECASE)
TOLD = re.compile(r"NegativeControl(?=[A-Z])|test_negative_control_(?=[a-z])")  # what a name says that the kind says
CHAPTER = re.compile(r"(\w+)\.nw\b")
WORD = re.compile(r"NaNs?|[A-Z]\d+|[A-Z]{2,}s?(?![a-z])|[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
SENTENCE = re.compile(r"(?<=[^.][^.][.!?])\s+(?=[A-Z(\[])")


class Test:
    """One test: where it begins and ends in its file, its kind, whether it is or has a negative control, and the sentence above it."""

    def __init__(self, file: "TestFile", suite: str, name: str, begin: int, end: int, above: str) -> None:
        self.file, self.suite, self.name = file, suite, name
        self.begin, self.end = begin, end  # in letters of the text, whole lines
        self.full = f"{suite}.{name}" if suite else name  # as GoogleTest and Python call it
        parts = SUITE.match(suite)
        self.subject, self.kind = (parts[1], KINDS[parts[2]]) if parts else (suite, "")
        self.chapter = ""  # after which it is called
        self.sentence = first_sentence(above)
        self.control = ""  # the text of the table after the kind
        if name.startswith(("NegativeControl", "test_negative_control")) or self.kind == "control":
            self.kind, self.control = self.kind.replace("control", ""), "negative control"
        elif CONTROL.search(above) or CONTROL.search(file.text[begin:end]):
            self.control = "with a control"

    @property
    def address(self) -> str:
        """Of its source in the site."""
        return f"{self.file.page}#{self.full}"


class TestFile:
    """A file of tests: its path, its text, what its head says, and its tests in order."""

    def __init__(self, path: str) -> None:
        self.path, self.name = path, os.path.basename(path).split(".")[0]
        self.is_python = path.endswith(".py")
        self.page = self.name + ".html"
        self.subject = self.name.removesuffix("_test")
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.head, self.tests = "", list[Test]()
        (self.read_python if self.is_python else self.read_cpp)()

    def read_cpp(self) -> None:
        """A test ends with the first brace that is alone on its line."""
        head = re.match(r"(?://.*\n)+", self.text)
        self.head = uncommented(head[0]) if head else ""
        for match in BEGINS.finditer(self.text):
            end = self.text.find("\n}", match.start())
            end = self.text.index("\n", end + 1) + 1 if end >= 0 else len(self.text)
            above = ABOVE.search(self.text[:match.start()])
            beside = re.search(r"\{\s*//(.*)$", self.text[match.start():end].split("\n", maxsplit=1)[0])
            said = uncommented(above[0]) if above else beside[1] if beside else ""
            self.tests.append(Test(self, match[1], match[2], match.start(), end, said))

    def read_python(self) -> None:
        """Functions that begin with test_, also in classes."""
        tree = ast.parse(self.text, self.path)
        self.head = ast.get_docstring(tree) or ""
        begins = [0]
        for line in self.text.split("\n"):
            begins.append(begins[-1] + len(line) + 1)

        def visit(node: ast.AST, suite: str) -> None:
            for child in ast.iter_child_nodes(node):
                if isinstance(child, ast.ClassDef):
                    visit(child, child.name)
                elif isinstance(child, ast.FunctionDef) and child.name.startswith("test_"):
                    first = min([child.lineno] + [decorator.lineno for decorator in child.decorator_list])
                    begin, end = begins[first - 1], begins[child.end_lineno or first]
                    above = ABOVE.search(self.text[:begin])
                    said = ast.get_docstring(child) or (uncommented(above[0]) if above else "")
                    self.tests.append(Test(self, suite, child.name, begin, min(end, len(self.text)), said))
        visit(tree, "")

    def chapters(self) -> set[str]:
        """Names of the chapters that its head names."""
        return set(CHAPTER.findall(self.head))

    def of(self, chapter: str) -> list[Test]:
        """Its tests of a chapter, by the chapter's name."""
        own = [test for test in self.tests if test.chapter == chapter or (chapter == self.subject and not test.chapter)]
        return own or (self.tests if chapter in self.chapters() else [])

    def call(self, names: Iterable[str]) -> None:
        """Finds the chapter after which each test is called."""
        named = self.chapters()
        for test in self.tests:
            by_words = [name for name in sorted(named) if test.name.lower().startswith(name.lower())]
            by_suite = [name for name in (sorted(named) if self.is_python else names) if name == test.subject]
            test.chapter = (by_words + by_suite + [""])[0]


def uncommented(comment: str) -> str:
    """The words of a comment in one line."""
    return " ".join(re.sub(r"^\s*(?://+|#)", "", line).strip() for line in comment.strip().split("\n"))


def first_sentence(text: str) -> str:
    """The first sentence of a comment, with a capital and a full stop; nothing of one word, or that only says what the kind says."""
    sentence = SENTENCE.split(" ".join(text.split()))[0].rstrip(".:;, ")
    if " " not in sentence or sentence.lower() == "negative control":
        return ""
    if re.match("[a-z]{2}", sentence):
        sentence = sentence[0].upper() + sentence[1:]
    return sentence if sentence[-1] in "!?" else sentence + "."


class Wording:
    """Names of tests as words. A name has lost its capitals: those that the prose has inside of sentences come back."""

    def __init__(self, prose: Iterable[str]) -> None:
        self.small, self.capital, self.genitive = Counter[str](), Counter[str](), Counter[str]()
        for text in prose:
            self.small.update(re.findall(r"(?<![-\w{.\\])[a-z]+\b", text))
            self.genitive.update(re.findall(r"\b[a-z]+(?='s)", text))
            self.capital.update(re.findall(r"(?<=[a-z,(][ -])[A-Z][A-Za-z]*\b", text))

    def is_name(self, word: str) -> bool:
        """Whether a word keeps its capital inside of a sentence."""
        return self.capital[word] > self.small[word.lower()]

    def word(self, part: str) -> list[str]:
        """One part of a name as words."""
        name, acronym, small = part.capitalize(), part.upper(), part.lower()
        if part[:1] == "A" and part[1:].isupper() and not self.is_name(part) and self.is_name(part[1:]):
            return ["a", part[1:]]
        if not part.isalpha() or (len(part) > 1 and not part[1:].islower()):
            return [part]
        if len(part) > 2 and self.is_name(acronym):
            return [acronym]
        if self.is_name(name) and part not in ("A", "a", "I"):
            return [name]
        if small.endswith("s") and not self.small[small] and (self.is_name(name[:-1]) or self.genitive[small[:-1]]):
            return [(name[:-1] if self.is_name(name[:-1]) else small[:-1]) + "'s"]  # a genitive has lost its apostrophe
        return [small]

    def words(self, test: Test) -> str:
        """A test's name as a line of words."""
        parts = [word for part in WORD.findall(TOLD.sub("", test.name).removeprefix("test_")) for word in self.word(part)]
        line = " ".join(parts)
        return line[:1].upper() + line[1:]


class Tests:
    """All test files of a folder."""

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self.files = [TestFile(path) for path in found(folder)]
        self.homes: dict[str, list[str]] = {}  # path of a file -> names of its chapters, its own first

    def attach(self, names: list[str]) -> None:
        """Finds the chapters of each file among all; a file without one and a name without a chapter are problems."""
        problems = []
        for file in self.files:
            file.call(names)
            problems += [Problem(file.path, 1, f"its head names {name}.nw, but there is no such chapter")
                         for name in sorted(file.chapters() - set(names))]
            homes = [name for name in names if file.of(name)]
            if homes:
                homes.sort(key=file.subject.__ne__)
                self.homes[file.path] = homes
            elif must_have_a_chapter(file.path):
                problems.append(Problem(file.path, 1, "belongs to no chapter; name one at its head, as nw/floor/Name.nw"))
        stop_if_any(problems)
        self.files = [file for file in self.files if file.path in self.homes]

    def of(self, chapter: str) -> list[Test]:
        """The tests of a chapter: those of its file first."""
        files = sorted(self.files, key=lambda file: file.subject != chapter)
        return [test for file in files for test in file.of(chapter)]


def found(folder: str) -> list[str]:
    """The test files of a folder: GoogleTest's, and Python's."""
    patterns = ("*_test.cpp", os.path.join("python", "test_*.py"), "*_test.py")
    return [path for pattern in patterns for path in sorted(glob.glob(os.path.join(folder, pattern)))]


def must_have_a_chapter(path: str) -> bool:
    """Whether a file tests the program: those of the weaver and of the pages test the book itself."""
    return path.endswith(".cpp") or os.path.basename(path).startswith("test_")


def counted(number: int, kind: str) -> str:
    """19 identities"""
    return f"{number} {kind if number == 1 else PLURALS.get(kind, kind)}"


def summary(tests: Sequence[Test]) -> str:
    """How many tests of each kind, and how many with a negative control."""
    kinds = Counter(test.kind for test in tests if test.kind)
    parts = [counted(kinds[kind], kind) for kind in dict.fromkeys(KINDS.values()) if kinds[kind]]
    out = f"{len(tests)} test{'s' if len(tests) > 1 else ''}"
    if len(kinds) == 1 and sum(kinds.values()) == 1 == len(tests):
        out += f", {tests[0].kind}"
    elif parts:
        out += ": " + ", ".join(parts)
    if controls := sum(bool(test.control) for test in tests):
        out += f"; {controls} with a negative control"
    return out


def by_file(tests: Sequence[Test]) -> Iterator[tuple[TestFile, list[Test]]]:
    """The tests of each file, in the order of the files."""
    for file in dict.fromkeys(test.file for test in tests):
        yield file, [test for test in tests if test.file is file]
