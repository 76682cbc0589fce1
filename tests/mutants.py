#!/usr/bin/python3
"""Plant small faults in the chapters' code and count how many the chapters' own tests notice.

    mutants.py BUILD [--count N] [--seed S] [--chapter FLOOR/NAME]... [--jobs N] [--report FILE.csv] [--again]

BUILD is a finished build with tests. A fault is one change of one token in the tangled code of a
chapter of the floors from base to render: an operator (+ for -, * for /, += for -=), a comparison
(< for <=, == for !=, && for ||), a constant (a whole number plus one, a fraction 1 % larger) or a
sign. Each chapter has its share of the faults by its number of code lines; which ones they are
depends on the seed and the chapter's own code alone. A fault that is not valid C++ is replaced by another.

Where C++ allows it, all faults of a chapter are compiled together, each beside the right code, and
an environment variable chooses one (see Trial); the others are compiled one by one. The objects are
linked before the library with the chapter's own test, NAME_test.cpp, and the tests whose first
comment names it with at most one other chapter (tests that name more only where there is no other),
and these tests run until one fails. Before that, the same objects must pass the same tests with no
fault chosen. A test that fails, crashes,
or takes more than ten times its processor time, has noticed the fault.

FILE.csv is a line a fault, written as the outcomes come; a run that was ended goes on from it.
With --again only the faults that survived there are tried, with the tests as they are now; the
outcome that they had at first stays beside the new one.
tests/mutants-excused.csv lists changes that no test can notice (equivalent code, speed alone), one
by one with the reason, by chapter and text of the line; they are not counted. An excuse for a change
that cannot be made any more is an error.
"""
import argparse
import concurrent.futures
import csv
import datetime
import json
import os
import pathlib
import random
import re
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
from typing import TextIO

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLOORS = ["base", "light", "surface", "air", "scene", "render"]
LINES = 1000  # lines apart from each other, for the compiler, where faults are switched
SWITCH = """#pragma once
#include <cstdlib>
struct MalusFault {
  int number = 0;
  MalusFault() {
    if (const char* told = std::getenv("MALUS_FAULT")) number = std::atoi(told);
  }
};
[[gnu::init_priority(102)]] inline MalusFault malus_fault;  // before all others
"""
EXCUSED = ROOT / "tests" / "mutants-excused.csv"
LINE = re.compile(r'^#line (\d+) "(.*)"')
TOKEN = re.compile(r"""
    (?P<number>(?<![\w.'])(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[uUlLfz]*(?![\w.]))
  | (?P<binary>(?<=\ )(?:\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||\+|-|\*|/|<|>)(?=\ ))
  | (?P<sign>(?<=[(=,\ ])-(?=[\w(]))
""", re.X)
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "==": "!=", "!=": "==",
         "<": "<=", "<=": "<", ">": ">=", ">=": ">", "&&": "||", "||": "&&"}
# Lines whose numbers and operators decide nothing that a test could see, or no value at all
SKIPPED = re.compile(r"^\s*(#|//|template|using|typedef|friend|static_assert|throw|public:|private:|namespace|\}|$)|operator|reserve\(|alignas")


def blank_literals(line: str, state: bool) -> tuple[str, bool]:
    """The line with comments blanked and literal texts underlined, and whether a block comment is still open."""
    out, i, block = [], 0, state
    while i < len(line):
        if block:
            end = line.find("*/", i)
            stop = len(line) if end < 0 else end + 2
            out.append(" " * (stop - i))
            i, block = stop, end < 0
        elif line.startswith("//", i):
            out.append(" " * (len(line) - i))
            break
        elif line.startswith("/*", i):
            block = True
        elif line[i] == '"' or (line[i] == "'" and not (i and line[i - 1].isalnum())):
            quote, j = line[i], i + 1
            while j < len(line) and line[j] != quote:
                j += 2 if line[j] == "\\" else 1
            stop = min(j + 1, len(line))
            out.append("_" * (stop - i))
            i = stop
        else:
            out.append(line[i])
            i += 1
    return "".join(out), block


def changed_number(text: str) -> str:
    digits = text.rstrip("uUlLfz")
    suffix = text[len(digits):]
    plain = digits.replace("'", "")
    if re.fullmatch(r"\d+", plain):
        return f"{int(plain) + 1}{suffix}"
    value = float(plain)
    return f"{value * 1.01:.17g}{suffix}" if value else f"0.01{suffix}"


# How tightly C++ binds; the text between two operands with spaces on both sides, as clang-format writes it
BINDING = {"*": 5, "/": 5, "%": 5, "+": 6, "-": 6, "<<": 7, ">>": 7, "<=>": 8, "<": 9, "<=": 9, ">": 9, ">=": 9, "==": 10, "!=": 10,
           "&": 11, "^": 12, "|": 13, "&&": 14, "||": 15}
CLOSERS = ")]}"
KEYWORDS = {"return", "throw", "case", "else", "co_return", "do", "goto"}


def operand_before(blank: str, end: int) -> int | None:
    """Where the operand begins that ends at this place: brackets are whole, a space ends it."""
    i = end
    while i > 0 and not blank[i - 1].isspace() and blank[i - 1] not in "([{,;":
        if blank[i - 1] in CLOSERS:
            depth = 0
            while i > 0:
                i -= 1
                depth += (blank[i] in ")]}") - (blank[i] in "([{")
                if depth == 0:
                    break
        else:
            i -= 1
    return None if i == end or blank[i:end] in KEYWORDS else i


def operand_after(blank: str, begin: int) -> int | None:
    """Where the operand ends that begins at this place."""
    i = begin
    while i < len(blank) and not blank[i].isspace() and blank[i] not in ")]},;":
        if blank[i] in "([{":
            depth = 0
            while i < len(blank):
                depth += (blank[i] in "([{") - (blank[i] in ")]}")
                i += 1
                if depth == 0:
                    break
        else:
            i += 1
    return None if i == begin else i


def after_expression(blank: str, at: int) -> int:
    """Where the expression ends within which this place lies."""
    depth = 0
    while at < len(blank) and not (depth == 0 and blank[at] in ",;)]}"):
        depth += (blank[at] in "([{") - (blank[at] in ")]}")
        at += 1
    return at


def left_end(blank: str, at: int, binding: int) -> int | None:
    """Where the left side of an operator at this place begins, which takes what binds as tightly as itself."""
    begin = operand_before(blank, len(blank[:at].rstrip()))
    while begin is not None:
        before = blank[:begin].rstrip()
        operator = re.search(r"(?<=\s)\S+$", before)
        if before == blank[:begin] or not operator or BINDING.get(operator[0], 99) > binding:
            break
        further = operand_before(blank, len(before[:operator.start()].rstrip()))
        if further is None:
            break
        begin = further
    return begin


def right_end(blank: str, at: int, binding: int) -> int | None:
    """Where the right side ends of an operator that ends at this place, which takes what binds more tightly."""

    def skip(i: int) -> int:
        return i + len(blank[i:]) - len(blank[i:].lstrip())

    end = operand_after(blank, skip(at))
    while end is not None:
        operator = re.match(r"\s+(\S+)(?=\s)", blank[end:])
        if not operator or BINDING.get(operator[1], 99) >= binding:
            break
        further = operand_after(blank, skip(end + operator.end()))
        if further is None:
            break
        end = further
    return end


class Fault:
    """One change of one token: where it is, in the tangled file and in its chapter."""

    def __init__(self, chapter: str, path: pathlib.Path, index: int, column: int, kind: str, old: str, new: str, place: str,
                 text: str) -> None:
        self.chapter, self.path, self.index, self.column, self.kind = chapter, path, index, column, kind
        self.old, self.new, self.place, self.text = old, new, place, text.strip()
        self.change = f"{old} -> {new or '(nothing)'}"

    def mutated(self) -> str:
        lines = self.path.read_text().split("\n")
        line = lines[self.index]
        assert line[self.column:].startswith(self.old)
        lines[self.index] = line[:self.column] + self.new + line[self.column + len(self.old):]
        return "\n".join(lines)

    def key(self) -> tuple[str, str, str]:
        """The key that finds the fault again after lines have moved."""
        return self.chapter, self.text, self.change


Span = tuple[int, int, int, int]  # of an expression, and of the token in it


def blanked(text: str) -> str:
    """A whole file, with its letters where they were, without comments, directives and what literals say."""
    lines, block = [], False
    for line in text.split("\n"):
        blank, block = blank_literals(line, block)
        lines.append(" " * len(line) if blank.lstrip().startswith("#") else blank)
    return "\n".join(lines)


def span(fault: Fault, blank: str, starts: list[int]) -> Span | None:
    """The expression that a fault changes, and the changed one's parts: (begin, end, begin and end of the token)."""
    at = starts[fault.index] + fault.column
    stop = at + len(fault.old)
    begin: int | None
    end: int | None
    if fault.kind == "number":
        return at, stop, at, stop
    if fault.kind == "sign":
        begin, end = at, operand_after(blank, stop)
    elif fault.old in BINDING:
        begin, end = left_end(blank, at, BINDING[fault.old]), right_end(blank, stop, BINDING[fault.old])
    else:  # += and the like: all that follows, to the end of the expression
        begin, end = operand_before(blank, len(blank[:at].rstrip())), after_expression(blank, stop)
    return None if begin is None or end is None else (begin, end, at, stop)


def switched(path: pathlib.Path, numbers: dict[int, Fault]) -> tuple[str, list[int]]:
    """The text of a file with several faults, each behind a question; and those faults for which that cannot be written.

    numbers: {number: fault}. An error of the compiler within fault k names a line from LINES * k on."""
    text = path.read_text()
    blank, starts = blanked(text), [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    spans: list[tuple[int, Span]] = []
    alone: list[int] = []
    for number, fault in numbers.items():
        if fault.path != path:
            continue
        found = span(fault, blank, starts)
        if found and all(found[1] <= b or e <= found[0] or b <= found[0] and found[1] <= e or found[0] <= b and e <= found[1]
                         for _, (b, e, _, _) in spans):
            spans.append((number, found))
        else:
            alone.append(number)

    def rendered(begin: int, end: int, inner: list[tuple[int, Span]]) -> str:
        out: list[str] = []
        i = begin
        inner = sorted(inner, key=lambda s: (s[1][0], -s[1][1], s[1][2]))
        while inner:
            (number, (b, e, at, stop)), rest = inner[0], inner[1:]
            within = [s for s in rest if s[1][1] <= e]
            inner = [s for s in rest if s[1][1] > e]
            out.append(text[i:b])
            new = numbers[number].new
            # what lies within is written in the parts beside the token, so that it does not run in circles
            parts = [s for s in within if s[1][1] <= at], [s for s in within if s[1][0] >= stop]
            if len(parts[0]) + len(parts[1]) < len(within):
                alone.extend(s[0] for s in within if s not in parts[0] + parts[1])
            out.append(f"\n#line {LINES * number} \"fault\"\n(malus_fault.number == {number} ? ({text[b:at]}{new}{text[stop:e]}) : "
                       f"({rendered(b, at, parts[0])}{text[at:stop]}{rendered(stop, e, parts[1])}))\n#line 1 \"after\"\n")
            i = e
        out.append(text[i:end])
        return "".join(out)

    return rendered(0, len(text), spans), alone


def numbered(faults: list[Fault]) -> list[Fault]:
    """Equal changes of a line, or of equal lines of a chapter, are distinguished: the second one is marked as the second."""
    seen: dict[tuple[str, str, str], int] = {}
    for fault in faults:
        key = fault.key()
        seen[key] = seen.get(key, 0) + 1
        if seen[key] > 1:
            fault.change += f" ({seen[key]})"
    return faults


def faults_of(chapter: str, path: pathlib.Path) -> list[Fault]:
    """All faults that can be planted in one tangled file; templates' and lists' angle brackets are left alone."""
    found: list[Fault] = []
    place, number, block, raw = "", 0, False, False
    for index, line in enumerate(path.read_text().split("\n")):
        if marker := LINE.match(line):
            place, number = marker[2], int(marker[1])
            continue
        here, number = number, number + 1
        if 'R"' in line or raw:
            raw = (raw or 'R"' in line) and not re.search(r'\)\w*"', line.split('R"')[-1])
            continue
        blank, block = blank_literals(line, block)
        if SKIPPED.search(blank) or "std::array<" in blank and "=" not in blank:
            continue
        for token in TOKEN.finditer(blank):
            old = token[0]
            if token.lastgroup == "number":
                if re.search(r"<[^<>]*$", blank[:token.start()]) and re.match(r"[^<>]*>", blank[token.end():]):
                    continue  # a template's argument
                new = changed_number(old)
            elif token.lastgroup == "sign":
                if token.start() and re.search(r"[\w)\]] $", blank[:token.start()]) and not blank[:token.start()].endswith("return "):
                    continue
                new = ""
            else:
                if old in "*" and re.search(r"(const|auto|\w+>|double|float|char|void) $", blank[:token.start()]):
                    continue  # a pointer
                new = SWAPS[old]
            found.append(Fault(chapter, path, index, token.start(), token.lastgroup or "", old, new, f"{place}:{here}", line))
    return found


def code_lines(path: pathlib.Path) -> int:
    """Lines of code: not empty, no comment, no line that only names its chapter."""
    if not path.exists():
        return 0
    return sum(bool(line.strip()) and not re.match(r"\s*(//|#line)", line) for line in path.read_text().split("\n"))


# headers that many files include and that no file prepares by a macro
FOREIGN = r"^#include <(?:[a-z_]+|gtest/.*|rapidcheck/.*|fmt/.*|nlohmann/.*|boost/math/qu.*)>$"


class Build:
    """The compiler's and linker's own lines of a finished build."""

    def __init__(self, directory: str) -> None:
        self.directory = pathlib.Path(directory).resolve()
        self.scratch = self.directory / "mutants"
        self.scratch.mkdir(exist_ok=True)
        self.lock = threading.Lock()
        commands = json.loads((self.directory / "compile_commands.json").read_text())
        self.lines = {str(pathlib.Path(c["file"]).resolve()): self.lean(shlex.split(c["command"])) for c in commands}
        self.links: dict[str, list[str]] = {}
        self.others: list[str] = []
        (self.scratch / "switch.hpp").write_text(SWITCH)
        self.precompiled = self.precompile()

    @staticmethod
    def lean(words: list[str]) -> list[str]:
        """The compiler's line without launcher, output and warnings as errors, at the optimisation that compiles fast,
        and with the checks of indices that make sanitize makes as well. Chapters become a part of a program, as the tests are,
        because a precompiled header serves only who is compiled like it."""
        if words[0].endswith("ccache"):
            words = words[1:]
        output = words.index("-o")
        words = words[:output] + words[output + 2:]
        source = words.index("-c")
        words = words[:source] + words[source + 2:]
        words = [w for w in words if not w.startswith(("-W", "-fPI", "-DGTEST_"))]
        checks = ["-UNDEBUG", "-D_GLIBCXX_ASSERTIONS", "-fsanitize=bounds", "-fsanitize-undefined-trap-on-error"]
        return words + ["-fPIE", "-DGTEST_HAS_PTHREAD=1", "-O1", "-g0", "-Wno-narrowing", "-Werror=vla"] + checks

    def precompile(self) -> list[str]:
        """The foreign headers of all chapters and tests, compiled once: half of the time of a faulty file."""
        wanted: set[str] = set()
        for path in [*ROOT.glob("generated/malus/*/*.?pp"), *ROOT.glob("tests/*.?pp")]:
            text = path.read_text()
            if path.parent.name in FLOORS + ["tests"] and not re.search(r"^#define", text, re.M):
                wanted |= set(re.findall(FOREIGN, text, re.M))
        header = self.scratch / "foreign.hpp"
        text = "\n".join(sorted(wanted)) + "\n"
        line = next(line for file, line in sorted(self.lines.items()) if file.endswith("_test.cpp"))
        mark = text + " ".join(line)
        made = header.with_name("foreign.hpp.gch")
        if not (made.exists() and header.exists() and header.with_suffix(".mark").exists() and header.with_suffix(".mark").read_text() == mark):
            header.write_text(text)
            subprocess.run([*line, "-x", "c++-header", str(header), "-o", str(made)], cwd=self.directory, check=True)
            header.with_suffix(".mark").write_text(mark)
        return ["-include", str(header)]

    def errors(self, source: pathlib.Path, text: str, include: list[str], out: pathlib.Path) -> str:
        """The compiler's messages for this text instead of a source file; nothing if it is C++."""
        line = self.lines[str(source)]
        file = out.with_suffix(".cpp")
        file.write_text(text)
        # -iquote: a test's own headers are beside it
        words = line[:1] + self.precompiled + include + line[1:] + ["-iquote", str(source.parent), "-c", str(file), "-o", str(out)]
        done = subprocess.run(words, cwd=self.directory, capture_output=True, text=True, errors="replace")
        return done.stderr or "unknown error" if done.returncode else ""

    def foreign(self) -> list[str]:
        """The libraries of others with which ours are linked."""
        if not self.others:
            for name in ("libmalus", "libmalus_scenes", "libmalus_thesis"):
                listed = subprocess.run(["ninja", "-C", str(self.directory), "-t", "commands", name], capture_output=True, text=True,
                                        check=True)
                links = [line for line in listed.stdout.split("\n") if " -shared " in line]
                for word in (word for line in links for word in shlex.split(line)):
                    if (word.startswith("-l") or re.match(r"/usr/.*\.so", word)) and word not in self.others:
                        self.others.append(word)
        return self.others

    def linked(self, test: str, objects: list[pathlib.Path], out: pathlib.Path) -> bool:
        """Link the test with these objects before the library; a recompiled test takes its own object's place."""
        with self.lock:
            if test not in self.links:
                listed = subprocess.run(["ninja", "-C", str(self.directory), "-t", "commands", test], capture_output=True, text=True,
                                        check=True)
                line = listed.stdout.strip().split("\n")[-1]
                self.links[test] = shlex.split(line.removeprefix(": && ").removesuffix(" && :"))
        words = list(self.links[test])
        words[words.index("-o") + 1] = str(out)
        if any(o.stem == test for o in objects):
            words = [w for w in words if not w.endswith(f"/{test}.cpp.o")]
        mine = {o.stem + ".cpp.o" for o in objects}
        whole = [str(o) for o in sorted(self.directory.glob("CMakeFiles/malus_*.dir/generated/malus/*/*.cpp.o"))
                 if o.name not in mine and not re.search("malus_(pictures|ladder)", str(o))]
        words = [w for w in words if not re.match(r"lib/libmalus\w*\.so", w)]
        words += [*(str(o) for o in objects), *whole, *self.foreign()]
        return subprocess.run(words, cwd=self.directory, capture_output=True).returncode == 0


def tests_of(chapters: list[str]) -> dict[str, list[pathlib.Path]]:
    """{chapter: its own test, then those whose first comment names it and at most one other; others where there is none}"""
    tests: dict[str, list[pathlib.Path]] = {chapter: [] for chapter in chapters}
    many: dict[str, list[pathlib.Path]] = {chapter: [] for chapter in chapters}
    for path in sorted((ROOT / "tests").glob("*_test.cpp")):
        comment = re.match(r"(?:\s*//.*\n)+", path.read_text())
        named = re.findall(r"nw/(\w+/\w+)\.nw", comment[0]) if comment else []
        for chapter in chapters:
            if path.name == chapter.split("/")[1] + "_test.cpp":
                tests[chapter].insert(0, path)
            elif chapter in named:
                (tests if len(named) <= 2 else many)[chapter].append(path)
    return {chapter: tests[chapter] or many[chapter] for chapter in chapters}


def chapters_of() -> list[str]:
    return [f"{floor}/{path.stem}" for floor in FLOORS for path in sorted((ROOT / "nw" / floor).glob("*.nw"))]


def passes(program: pathlib.Path, scratch: pathlib.Path, limit: int, fault: int) -> tuple[bool, float]:
    """Whether a test passes within a limit of processor time, and the seconds that it took."""

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
        resource.setrlimit(resource.RLIMIT_AS, (2 ** 34, 2 ** 34))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    quiet = subprocess.DEVNULL
    environment = dict(os.environ, TMPDIR=str(scratch), MALUS_FAULT=str(fault))
    process = subprocess.Popen([str(program), "--gtest_brief=1", "--gtest_fail_fast"], cwd=ROOT, stdin=quiet, stdout=quiet, stderr=quiet,
                               env=environment, preexec_fn=bounded, start_new_session=True)
    clock = threading.Timer(60 + 10 * limit, os.killpg, (process.pid, signal.SIGKILL))  # for one that waits for ever
    clock.start()
    _, status, used = os.wait4(process.pid, 0)
    clock.cancel()
    process.returncode = status
    return status == 0, used.ru_utime + used.ru_stime


class Trial:
    """The faults of one chapter and the tests that should notice them.

    Most faults are compiled together: each changed expression is beside the right one, and an environment variable
    selects one of them. Constants that C++ needs while it compiles cannot be selected that way; such faults are
    compiled alone."""

    def __init__(self, build: Build, chapter: str, tests: list[pathlib.Path]) -> None:
        self.build, self.chapter, self.tests = build, chapter, tests
        self.files = [f for f in (ROOT / "generated" / "malus" / f"{chapter}{suffix}" for suffix in (".hpp", ".cpp")) if f.exists()]
        self.limits: dict[pathlib.Path, int] = {}
        self.together: dict[Fault, int] = {}
        self.programs: dict[pathlib.Path, pathlib.Path | None] = {}
        self.scratch: tempfile.TemporaryDirectory[str] | None = None

    def texts(self, numbers: dict[int, Fault]) -> tuple[dict[pathlib.Path, str], list[int]]:
        """{file: its text with these faults}, and the faults that cannot be among them."""
        alone: list[int] = []
        texts: dict[pathlib.Path, str] = {}
        for file in self.files:
            texts[file], without = switched(file, numbers)
            alone += without
        return texts, alone

    def objects(self, texts: dict[pathlib.Path, str], scratch: pathlib.Path) -> tuple[dict[pathlib.Path, pathlib.Path], str]:
        """The chapter and, if its header is not as it was, its tests; or what the compiler says."""
        include = ["-include", str(self.build.scratch / "switch.hpp")]
        objects: dict[pathlib.Path, pathlib.Path] = {}
        errors = ""
        own = {file: text for file, text in texts.items() if text != file.read_text()}
        header = next((file for file in own if file.suffix == ".hpp"), None)
        if header:
            faulty = scratch / "include" / header.relative_to(ROOT / "generated")  # as #include names it
            faulty.parent.mkdir(parents=True, exist_ok=True)
            faulty.write_text(own[header])
            include += ["-I", str(scratch / "include")]
        sources = [(file, text) for file, text in texts.items() if file.suffix == ".cpp"]
        sources += [(test, test.read_text()) for test in self.tests if header]
        for source, text in sources:
            objects[source] = scratch / f"{source.stem}.o"
            errors += self.build.errors(source, text, include, objects[source])
        return objects, errors

    def link(self, test: pathlib.Path, objects: dict[pathlib.Path, pathlib.Path], scratch: pathlib.Path) -> pathlib.Path | None:
        mine = [o for source, o in objects.items() if source == test or source in self.files]
        program = scratch / test.stem
        return program if self.build.linked(test.stem, mine, program) else None

    def prepare(self, faults: list[Fault]) -> None:
        """Compile all that go together; then without a fault the tests must pass, with the same flags."""
        self.scratch = tempfile.TemporaryDirectory(dir=self.build.scratch)
        scratch = pathlib.Path(self.scratch.name)
        numbers = dict(enumerate(faults, 1))
        while True:
            texts, alone = self.texts(numbers)
            objects, errors = self.objects(texts, scratch) if not alone else ({}, "")
            wrong = set(alone) | {int(line) // LINES for line in re.findall(r"\bfault:(\d+)", errors)} & set(numbers)
            if errors and not wrong:
                if not numbers:
                    sys.exit(f"{self.chapter} is not compiled even without a fault:\n{errors[:2000]}")
                wrong = set(numbers)
            if not wrong:
                failing = self.fails(objects, scratch)
                if not failing:
                    break
                if not numbers:
                    sys.exit(f"{failing} fails without any fault; build and repair it first")
                wrong = set(numbers)  # a macro that turns its code into a text shows the selections
            numbers = {number: fault for number, fault in numbers.items() if number not in wrong}
        self.together = {fault: number for number, fault in numbers.items()}

    def fails(self, objects: dict[pathlib.Path, pathlib.Path], scratch: pathlib.Path) -> str | None:
        """Which test fails though no fault is chosen; else how long each may take with one."""
        for test in self.tests:
            program = self.programs[test] = self.link(test, objects, scratch)
            passed, seconds = passes(program, scratch, 600, 0) if program else (False, 0)
            if not passed:
                return test.stem
            self.limits[test] = round(5 + 10 * seconds)
        return None

    def outcome(self, fault: Fault) -> str:
        """'noticed', 'survived', or 'no C++' of one fault."""
        with tempfile.TemporaryDirectory(dir=self.build.scratch) as folder:
            scratch = pathlib.Path(folder)
            objects: dict[pathlib.Path, pathlib.Path] = {}
            number = self.together.get(fault, 0)
            if not number:
                texts = {file: fault.mutated() if file == fault.path else file.read_text() for file in self.files}
                objects, errors = self.objects(texts, scratch)
                if errors:
                    return "no C++"
            for test in self.tests:
                program = self.programs[test] if number else self.link(test, objects, scratch)
                if not program:
                    return "no C++"
                if not passes(program, scratch, self.limits[test], number)[0]:
                    return "noticed"
        return "survived"


def shares(weights: dict[str, int], count: int) -> dict[str, int]:
    """Whole numbers in proportion to the weights, at least one each, except for a weight of zero; the largest
    remainders get what is left."""
    total = sum(weights.values())
    exact = {name: count * weight / total for name, weight in weights.items()}
    share = {name: max(1, int(x)) if x else 0 for name, x in exact.items()}
    for name in sorted(exact, key=lambda name: share[name] - exact[name])[:max(0, count - sum(share.values()))]:
        share[name] += 1
    return share


def excuses(candidates: dict[str, list[Fault]]) -> dict[tuple[str, str, str], str]:
    """{(chapter, line, change): reason}; each of them is of a change that can be made."""
    if not EXCUSED.exists():
        return {}
    with open(EXCUSED, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    known = {fault.key() for faults in candidates.values() for fault in faults}
    for row in rows:
        if (row["chapter"], row["line"], row["change"]) not in known:
            sys.exit(f"{EXCUSED}: no line of {row['chapter']} is '{row['line']}' with the change {row['change']}; remove the excuse")
        if not row["reason"]:
            sys.exit(f"{EXCUSED}: no reason is given for '{row['line']}'")
    return {(row["chapter"], row["line"], row["change"]): row["reason"] for row in rows}


class Report:
    """A line a fault, written as the outcomes come."""

    COLUMNS = ["chapter", "place", "line", "change", "at_first", "outcome"]  # at_first: before tests were added for it

    def __init__(self, path: str | None, seed: int) -> None:
        self.path, self.seed, self.lock = pathlib.Path(path) if path else None, seed, threading.Lock()
        self.rows: dict[tuple[str, str, str], dict[str, str]] = {}
        if self.path and self.path.exists():
            with open(self.path, encoding="utf-8", newline="") as file:
                for row in csv.DictReader(line for line in file if not line.startswith("#")):
                    self.rows[row["chapter"], row["line"], row["change"]] = row

    def outcome(self, fault: Fault) -> str | None:
        row = self.rows.get(fault.key())
        return row["outcome"] if row else None

    def add(self, fault: Fault, outcome: str) -> None:
        with self.lock:
            first = self.rows.get(fault.key(), {"at_first": outcome})["at_first"]
            row = dict(zip(self.COLUMNS, [fault.chapter, fault.place, fault.text, fault.change, first, outcome]))
            self.rows[fault.key()] = row
            if not self.path:
                return
            fresh = not self.path.exists()
            with open(self.path, "a", encoding="utf-8", newline="") as file:
                if fresh:
                    self.head(file)
                csv.DictWriter(file, self.COLUMNS, lineterminator="\n").writerow(row)

    def head(self, file: TextIO) -> None:
        described = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
        commit = described.stdout.strip() or "unknown"
        file.write(f"# title: Faults planted in the chapters, and the outcome of their tests\n# date: {datetime.date.today()}\n"
                   f"# commit: {commit}\n# seed: {self.seed}\n")
        csv.writer(file, lineterminator="\n").writerow(self.COLUMNS)

    def finish(self, faults: list[Fault]) -> None:
        """The faults that count and the excused ones alone."""
        if self.path:
            with open(self.path, "w", encoding="utf-8", newline="") as file:
                self.head(file)
                for fault in faults:
                    csv.DictWriter(file, self.COLUMNS, lineterminator="\n").writerow(self.rows[fault.key()])


def tried(trial: Trial, wanted: int, pool: list[Fault], report: Report, excused: dict[tuple[str, str, str], str],
          again: bool) -> list[Fault]:
    """Try faults of the pool until the required number counts; those that have an outcome already are taken as they are."""

    def open_question(fault: Fault) -> bool:
        if fault.key() in excused:
            return False
        return report.outcome(fault) == "survived" if again else report.outcome(fault) in (None, "excused")

    todo: list[Fault] = []
    counting = 0
    for fault in pool:  # the first ones, if all are C++
        if counting == wanted:
            break
        counting += report.outcome(fault) != "no C++" and fault.key() not in excused and (report.outcome(fault) is not None or not again)
        todo += [fault] if open_question(fault) else []
    if todo:
        trial.prepare(todo)
    done: list[Fault] = []
    for fault in pool:
        if sum(report.outcome(f) != "excused" for f in done) == wanted:
            break
        old = report.outcome(fault)
        if old is None and again or old == "no C++":
            continue
        if fault.key() in excused:
            if old != "excused":
                report.add(fault, "excused")
        elif open_question(fault):
            report.add(fault, trial.outcome(fault))
        if report.outcome(fault) != "no C++":
            done.append(fault)
        if report.outcome(fault) == "survived":
            print(f"    {fault.place}: {fault.change}   {fault.text}", flush=True)
    return done


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chapter", action="append")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--report")
    parser.add_argument("--again", action="store_true")
    given = parser.parse_args()
    build, chapters = Build(given.build), chapters_of()
    candidates: dict[str, list[Fault]] = {}
    weights: dict[str, int] = {}
    tests = tests_of(chapters)
    if untested := [c for c in given.chapter or chapters if not tests.get(c)]:
        sys.exit(f"no test names the chapter {untested[0]} in its first comment; add // ... (nw/{untested[0]}.nw)")
    for chapter in chapters:
        files = [ROOT / "generated" / "malus" / f"{chapter}{suffix}" for suffix in (".hpp", ".cpp")]
        candidates[chapter] = numbered([fault for file in files if file.exists() for fault in faults_of(chapter, file)])
        random.Random(f"{given.seed} {chapter}").shuffle(candidates[chapter])
        weights[chapter] = sum(map(code_lines, files)) if candidates[chapter] else 0
    excused, report = excuses(candidates), Report(given.report, given.seed)
    share = shares(weights, given.count)
    todo = [c for c in chapters if share[c] and (not given.chapter or c in given.chapter)]
    random.Random(given.seed).shuffle(todo)  # so that a run that was ended has seen all floors
    results: list[Fault] = []

    def try_chapter(chapter: str) -> list[Fault]:
        trial = Trial(build, chapter, tests[chapter])
        return tried(trial, share[chapter], candidates[chapter], report, excused, given.again)

    with concurrent.futures.ThreadPoolExecutor(given.jobs) as crew:
        for chapter, done in zip(todo, crew.map(try_chapter, todo)):
            counted = [f for f in done if report.outcome(f) != "excused"]
            print(f"{chapter:32} {sum(report.outcome(f) == 'noticed' for f in counted):3} of {len(counted):3} noticed", flush=True)
            results += done
    if not given.chapter:
        report.finish(sorted(results, key=lambda fault: (chapters.index(fault.chapter), int(fault.place.rpartition(":")[2]))))
    counted = [f for f in results if report.outcome(f) != "excused"]
    noticed = sum(report.outcome(f) == "noticed" for f in counted)
    print(f"{noticed} of {len(counted)} faults noticed, {100 * noticed / max(1, len(counted)):.1f} %; {len(results) - len(counted)} excused")


main()
