#!/usr/bin/env python3
"""Plant small faults in the chapters' code and count how many the chapters' own tests notice.

    mutants.py BUILD [--count N] [--seed S] [--chapter FLOOR/NAME]... [--jobs N] [--report FILE.csv]

BUILD is a finished build with tests. A fault is one change of one token in the tangled code of a
chapter of light, matter, world or imaging: an operator (+ for -, * for /, += for -=), a comparison
(< for <=, == for !=, && for ||), a constant (a whole number plus one, a fraction 1 % larger) or a
sign. Each faulty file is compiled and linked before the library with every test that names the
chapter in its first comment, and these tests run. A test that fails, crashes or does not end has
noticed the fault. Faults are drawn in proportion to the code lines of each chapter, the same ones
for the same seed and code.

tests/mutants-excused.csv lists changes that no test can notice (equivalent code, speed alone),
one by one with the reason; they are not counted. The report is a CSV file with one line a fault.
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
import shlex
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLOORS = ["light", "matter", "world", "imaging"]
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
    """The line with comments and literal texts blanked, and whether a block comment is still open."""
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
            out.append(" " * (stop - i))
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


class Fault:
    """One change of one token: where it is, in the tangled file and in its chapter."""

    def __init__(self, chapter: str, path: pathlib.Path, index: int, column: int, old: str, new: str, place: str, text: str) -> None:
        self.chapter, self.path, self.index, self.column = chapter, path, index, column
        self.old, self.new, self.place, self.text = old, new, place, text.strip()
        self.outcome, self.seconds = "", 0.0

    def mutated(self) -> str:
        lines = self.path.read_text().split("\n")
        line = lines[self.index]
        assert line[self.column:].startswith(self.old)
        lines[self.index] = line[:self.column] + self.new + line[self.column + len(self.old):]
        return "\n".join(lines)

    def key(self) -> tuple[str, str, str]:
        return self.chapter, self.text, f"{self.old} -> {self.new}"


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
            found.append(Fault(chapter, path, index, token.start(), old, new, f"{place}:{here}", line))
    return found


Part = tuple[str, int, list[Fault]]  # of the plan: a chapter, how many of its faults to try, and all of them


class Build:
    """The compiler's and linker's own lines of a finished build."""

    def __init__(self, directory: str) -> None:
        self.directory = pathlib.Path(directory).resolve()
        commands = json.loads((self.directory / "compile_commands.json").read_text())
        self.compile = {str(pathlib.Path(c["file"]).resolve()): self.lean(shlex.split(c["command"])) for c in commands}
        self.links: dict[str, list[str]] = {}

    @staticmethod
    def lean(words: list[str]) -> list[str]:
        """The compiler's line without launcher, output and warnings as errors, at the optimisation that compiles fast,
        and with the checks of indices that make sanitize makes as well."""
        if words[0].endswith("ccache"):
            words = words[1:]
        output = words.index("-o")
        words = words[:output] + words[output + 2:]
        source = words.index("-c")
        words = words[:source] + words[source + 2:]
        return [w for w in words if w != "-Werror" and not w.startswith("-W")] + ["-O1", "-g0", "-w", "-D_GLIBCXX_ASSERTIONS"]


def tests_of(chapters: list[str]) -> dict[str, list[pathlib.Path]]:
    """{chapter: tests whose first comment names it}"""
    tests: dict[str, list[pathlib.Path]] = {chapter: [] for chapter in chapters}
    for path in sorted((ROOT / "tests").glob("*_test.cpp")):
        head = path.read_text()
        comment = re.match(r"(?:\s*//.*\n)+", head)
        named = set(re.findall(r"nw/(\w+/\w+)\.nw", comment[0])) if comment else set()
        for chapter in chapters:
            if chapter in named or path.name == chapter.split("/")[1] + "_test.cpp":
                tests[chapter].append(path)
    return tests


def chapters_of() -> list[str]:
    return [f"{floor}/{path.stem}" for floor in FLOORS for path in sorted((ROOT / "nw" / floor).glob("*.nw"))]


def run_tests(build: Build, fault_text: str, fault: Fault, tests: list[pathlib.Path], limits: dict[pathlib.Path, float],
              scratch: pathlib.Path) -> str:
    """'noticed', 'survived', or 'no C++' of one fault."""
    objects: list[pathlib.Path] = []
    include: list[str] = []
    if fault.path.suffix == ".hpp":  # a faulty header: the chapter's own source and its tests see it
        folder = scratch / "include" / fault.chapter.split("/")[0]
        folder.mkdir(parents=True)
        (folder / fault.path.name).write_text(fault_text)
        include = ["-I", str(scratch / "include")]
    source = fault.path.with_suffix(".cpp")
    if source.exists() and str(source) in build.compile:
        out = scratch / "chapter.o"
        text = fault_text if fault.path.suffix == ".cpp" else source.read_text()
        line = build.compile[str(source)]
        build_line = line[:1] + include + line[1:]
        (scratch / "chapter.cpp").write_text(text)
        done = subprocess.run(build_line + ["-c", str(scratch / "chapter.cpp"), "-o", str(out)], cwd=build.directory, capture_output=True)
        if done.returncode:
            return "no C++"
        objects.append(out)
    for test in tests:
        name, program = test.stem, scratch / test.stem
        own = list(objects)
        if include:
            out = scratch / f"{name}.o"
            line = build.compile[str(test)]
            done = subprocess.run(line[:1] + include + line[1:] + ["-c", str(test), "-o", str(out)], cwd=build.directory, capture_output=True)
            if done.returncode:
                return "no C++"
            own = [out] + own
        if not linked(build, name, own, program, bool(include)):
            return "no C++"
        limit = 10 + 10 * limits[test]
        try:
            done = subprocess.run([str(program), "--gtest_brief=1", "--gtest_fail_fast"], cwd=ROOT, capture_output=True, timeout=limit,
                                  env=dict(os.environ, TMPDIR=str(scratch)))
            if done.returncode:
                return "noticed"
        except subprocess.TimeoutExpired:
            return "noticed"
        program.unlink()
    return "survived"


def linked(build: Build, test: str, objects: list[pathlib.Path], out: pathlib.Path, replace: bool) -> bool:
    """Link the test with these objects before the library; a recompiled test takes its own object's place."""
    if test not in build.links:
        listed = subprocess.run(["ninja", "-C", str(build.directory), "-t", "commands", test], capture_output=True, text=True, check=True)
        line = listed.stdout.strip().split("\n")[-1]
        build.links[test] = shlex.split(line.removeprefix(": && ").removesuffix(" && :"))
    words = list(build.links[test])
    words[words.index("-o") + 1] = str(out)
    if replace:
        words = [w for w in words if not w.endswith(f"/{test}.cpp.o")]
    library = words.index("libmalus.a")
    words[library:library] = [str(o) for o in objects]
    return subprocess.run(words, cwd=build.directory, capture_output=True).returncode == 0


def drawn(chapters: list[str], candidates: dict[str, list[Fault]], count: int, seed: int) -> list[Part]:
    """The faults to try, in proportion to the candidates of each chapter, at least one each; spares follow for faults that do not compile."""
    chance = random.Random(seed)
    total = sum(len(candidates[c]) for c in chapters)
    plan = []
    for chapter in chapters:
        pool = candidates[chapter]
        chance.shuffle(pool)
        wanted = min(len(pool), max(1, round(count * len(pool) / total)))
        plan.append((chapter, wanted, pool))
    return plan


def excuses() -> dict[tuple[str, str, str], str]:
    if not EXCUSED.exists():
        return {}
    with open(EXCUSED, encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(row["chapter"], row["line"], row["change"]): row["reason"] for row in rows}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chapter", action="append")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--report")
    given = parser.parse_args()
    build = Build(given.build)
    generated = ROOT / "generated"
    chapters = chapters_of()
    tests = tests_of(chapters)
    untested = [c for c in given.chapter or chapters if not tests.get(c)]
    if untested:
        sys.exit(f"no test names the chapter {untested[0]} in its first comment; add // ... (nw/{untested[0]}.nw)")
    candidates = {}
    for chapter in chapters:
        files = [generated / f"{chapter}{suffix}" for suffix in (".hpp", ".cpp")]
        candidates[chapter] = [fault for file in files if file.exists() for fault in faults_of(chapter, file)]
    plan = drawn([c for c in chapters if candidates[c]], candidates, given.count, given.seed)
    plan = [part for part in plan if not given.chapter or part[0] in given.chapter]
    limits = {}
    for test in sorted({test for chapter, _, _ in plan for test in tests[chapter]}):
        begin = time.monotonic()
        if subprocess.run([str(build.directory / "tests" / test.stem), "--gtest_brief=1"], cwd=ROOT, capture_output=True).returncode:
            sys.exit(f"{test.stem} fails without any fault; build and repair it first")
        limits[test] = time.monotonic() - begin
    excused = excuses()
    results: list[Fault] = []

    def try_chapter_fault(fault: Fault, ordered: list[pathlib.Path]) -> Fault:
        begin = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="malus-mutant-") as scratch:
            outcome = run_tests(build, fault.mutated(), fault, ordered, limits, pathlib.Path(scratch))
        if outcome == "survived" and fault.key() in excused:
            outcome = "excused"
        fault.outcome, fault.seconds = outcome, time.monotonic() - begin
        return fault

    def try_chapter(part: Part) -> list[Fault]:
        chapter, wanted, pool = part
        ordered = sorted(tests[chapter], key=lambda test: limits[test])
        done: list[Fault] = []
        for fault in pool:
            if sum(f.outcome in ("noticed", "survived") for f in done) == wanted:
                break
            done.append(try_chapter_fault(fault, ordered))
        return done

    with concurrent.futures.ThreadPoolExecutor(given.jobs) as crew:
        for done in crew.map(try_chapter, plan):
            counted = [f for f in done if f.outcome in ("noticed", "survived")]
            results += [f for f in done if f.outcome != "no C++"]
            noticed = sum(f.outcome == "noticed" for f in counted)
            print(f"{done[0].chapter:32} {noticed:3} of {len(counted):3} noticed", flush=True)
            for fault in done:
                if fault.outcome == "survived":
                    print(f"    {fault.place}: {fault.old} -> {fault.new or '(nothing)'}   {fault.text}", flush=True)
    counted = [f for f in results if f.outcome in ("noticed", "survived")]
    noticed = sum(f.outcome == "noticed" for f in counted)
    print(f"{noticed} of {len(counted)} faults noticed, {100 * noticed / max(1, len(counted)):.1f} %; "
          f"{sum(f.outcome == 'excused' for f in results)} excused")
    if given.report:
        with open(given.report, "w", encoding="utf-8", newline="") as file:
            file.write(f"# title: Faults planted in the chapters and what their tests noticed\n# date: {datetime.date.today()}\n"
                       f"# seed: {given.seed}\n")
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["chapter", "place", "line", "change", "outcome"])
            for f in results:
                writer.writerow([f.chapter, f.place, f.text, f"{f.old} -> {f.new}", f.outcome])


main()
