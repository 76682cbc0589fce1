#!/usr/bin/python3
"""List the lines of nw/ that the tests reach.

    coverage.py BUILD

Reads what a coverage build (make coverage) left in BUILD, and prints for every chapter
the share of its code lines that were executed and the line numbers that were not. By the line directives of the tangled
code gcov refers to chapters.
"""
import collections
import json
import pathlib
import subprocess
import sys


def counts(build: str) -> dict[str, dict[int, int]]:
    """{chapter: {line: how often it was executed}}"""
    reached: dict[str, dict[int, int]] = collections.defaultdict(lambda: collections.defaultdict(int))
    for notes in pathlib.Path(build).rglob("*.gcda"):
        done = subprocess.run(["gcov", "--json-format", "--stdout", str(notes)], capture_output=True, check=True)
        for document in done.stdout.splitlines():
            for file in json.loads(document)["files"]:
                if file["file"].startswith("nw/"):
                    for line in file["lines"]:
                        reached[file["file"]][line["line_number"]] += line["count"]
    return reached


def spans(numbers: list[int]) -> str:
    """[3, 4, 5, 9] -> '3-5 9'"""
    out: list[list[int]] = []
    for n in sorted(numbers):
        if out and out[-1][1] == n - 1:
            out[-1][1] = n
        else:
            out.append([n, n])
    return " ".join(f"{a}" if a == b else f"{a}-{b}" for a, b in out)


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    reached = counts(sys.argv[1])
    if not reached:
        sys.exit(f"{sys.argv[1]}: no coverage data; type make coverage")
    hit_all = all_all = 0
    for chapter, lines in sorted(reached.items()):
        missed = [n for n, count in lines.items() if not count]
        hit, whole = len(lines) - len(missed), len(lines)
        hit_all, all_all = hit_all + hit, all_all + whole
        print(f"{chapter:40} {hit:5} of {whole:5} lines {100 * hit / whole:6.1f} %   {'not: ' + spans(missed) if missed else ''}")
    print(f"{'all chapters':40} {hit_all:5} of {all_all:5} lines {100 * hit_all / all_all:6.1f} %")


main()
