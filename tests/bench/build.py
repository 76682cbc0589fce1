#!/usr/bin/python3
"""Measure a build of HEAD from an empty directory, part by part, without a compiler cache, and an edit.

    build.py BENCH JOBS

Clones HEAD into BENCH/tree, which is emptied before, and does there what `make` and `make test` do. For each part it
prints the CPU seconds of all its processes and the seconds on the clock, and records them in validation/build-times.csv.
Then it edits the code of some chapters that have their own test, spread evenly over the floors, one after the other:
an edit costs the seconds on the clock from the change to the end of its test. At the end it lists the files that took
the compiler longest, from Ninja's log. CPU seconds depend little on JOBS and on the machine's other work, seconds
on the clock much: measure on an idle machine.
"""
import csv
import datetime
import glob
import os
import resource
import shutil
import statistics
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
RECORD = os.path.join(ROOT, "validation", "build-times.csv")
# in the order of the build: a part has only what those before it have not made
PARTS = (("library", "libmalus libmalus_scenes"), ("programs", "malus mathtester"), ("reproduce", "reproduce"), ("weave", "book"),
         ("rest of make", "everything"))
EDITS = 9
SLOWEST = 15


def cpu_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def measured(tree: str, *commands: list[str]) -> tuple[float, float]:
    """(CPU seconds, seconds) of commands; what they print is shown only if one fails."""
    cpu, start = cpu_seconds(), time.monotonic()
    for command in commands:
        done = subprocess.run(command, cwd=tree, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env={**os.environ, "CCACHE_DISABLE": "1"})
        if done.returncode:
            sys.exit(f"{' '.join(command)}\n{done.stdout}")
    return cpu_seconds() - cpu, time.monotonic() - start


def build(jobs: str, targets: str) -> list[str]:
    return ["cmake", "--build", "build", "-j", jobs, "--target", *targets.split()]


Row = tuple[str, float, float]  # part, CPU seconds, seconds on the clock


def told(row: Row) -> Row:
    """Prints a row as soon as it is known."""
    name, cpu, clock = row
    print(f"{name:32}{cpu:8.0f}{clock:9.0f}", flush=True)
    return row


def whole(name: str, rows: list[Row]) -> Row:
    """The sum of all rows until now."""
    return told((name, sum(cpu for _, cpu, _ in rows), sum(clock for _, _, clock in rows)))


def has_code(path: str) -> bool:
    """Whether a chapter has a file of its name with code, beside its header."""
    floor, name = os.path.basename(os.path.dirname(path)), os.path.basename(path)[:-3]
    with open(path, encoding="utf-8") as file:
        return f"<<{floor}/{name}.cpp>>=" in file.read()


def chapters(tree: str) -> list[str]:
    """The chapters that are edited: of those with their own test, one in so many."""
    tested = [path for path in sorted(glob.glob(os.path.join(tree, "nw", "*", "*.nw")))
              if os.path.exists(os.path.join(tree, "tests", os.path.basename(path)[:-3] + "_test.cpp")) and has_code(path)]
    return [tested[len(tested) * (2 * k + 1) // (2 * EDITS)] for k in range(EDITS)]


def edit(tree: str, chapter: str, jobs: str) -> Row:
    """The time to give the code of a chapter a new name and to run its test."""
    floor, name = os.path.basename(os.path.dirname(chapter)), os.path.basename(chapter)[:-3]
    with open(chapter, "a", encoding="utf-8") as file:
        file.write(f'\n<<{floor}/{name}.cpp>>=\nextern "C" {{\nextern int malus_edited_{name};\nint malus_edited_{name} = 1;\n}}\n@\n')
    return told((f"edit {floor}/{name}", *measured(tree, build(jobs, name + "_test"), [f"build/tests/{name}_test"])))


def slowest(log: str) -> list[tuple[float, str]]:
    """[(seconds, file)] of the objects in a Ninja log, longest first; the last line of a file counts."""
    seconds: dict[str, float] = {}
    with open(log, encoding="utf-8") as lines:
        for line in lines:
            if not line.startswith("#"):
                start, end, _, output, _ = line.rstrip("\n").split("\t")
                if output.endswith((".o", ".gch", ".pch")):
                    seconds[output] = (int(end) - int(start)) / 1000
    return sorted(((value, output) for output, value in seconds.items()), reverse=True)[:SLOWEST]


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    bench, jobs = os.path.abspath(sys.argv[1]), sys.argv[2]
    tree = os.path.join(bench, "tree")
    shutil.rmtree(bench, ignore_errors=True)
    subprocess.run(["git", "clone", "-q", "--shared", ROOT, tree], check=True)
    commit = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=tree, check=True, capture_output=True, text=True).stdout.strip()
    print(f"{'part':32}{'CPU s':>8}{'clock s':>9}   (-j {jobs}, {commit})")
    rows = [told(("configure", *measured(tree, ["cmake", "--preset", "release", "-G", "Ninja"])))]
    rows += [told((name, *measured(tree, build(jobs, targets)))) for name, targets in PARTS]
    make = whole("make", rows)
    rows.append(told(("compile tests", *measured(tree, build(jobs, "all")))))
    rows.append(told(("run tests", *measured(tree, ["ctest", "--test-dir", "build", "-j", jobs, "--output-on-failure"]))))
    rows += [make, whole("make test", rows)]
    log = slowest(os.path.join(tree, "build", ".ninja_log"))
    edits = [edit(tree, chapter, jobs) for chapter in chapters(tree)]
    median = told(("edit, median", statistics.median(cpu for _, cpu, _ in edits), statistics.median(clock for _, _, clock in edits)))
    rows += [*edits, median]
    with open(RECORD, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("date", "commit", "jobs", "part", "cpu_s", "clock_s"))
        today = datetime.datetime.now(datetime.timezone.utc).date()
        table.writerows((today, commit, jobs, name, f"{cpu:.0f}", f"{clock:.0f}") for name, cpu, clock in rows)
    print(f"\nThe {SLOWEST} slowest files, seconds on the clock:")
    for seconds, output in log:
        print(f"{seconds:8.1f}  {output}")


main()
