#!/usr/bin/env python3
"""Two rules of the house that one chapter alone cannot see.

    check.py CHAPTER.nw...

1. A chunk name belongs to one chapter: the woven book joins all chapters, and
   two chunks of one name would be printed as one.
2. An include never climbs: light < matter < world < imaging < program < thesis.
   The file app/malus.cpp is the roof, and may include every floor.
"""
import re
import sys

FLOORS = ["light", "matter", "world", "imaging", "program", "thesis"]
BEGINS = re.compile(r"^<<(.*)>>=\s*$")
INCLUDE = re.compile(r'^#include "(\w+)/')


def main() -> None:
    problems: list[str] = []
    homes: dict[str, str] = {}
    for chapter in sys.argv[1:]:
        floor = chapter.split("/")[-2]
        with open(chapter, encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                if begin := BEGINS.match(line):
                    home = homes.setdefault(begin[1], chapter)
                    if home != chapter:
                        problems.append(f"{chapter}:{number}: chunk <<{begin[1]}>> is also a chunk of {home};"
                                        " give one of them another name")
                include = INCLUDE.match(line)
                if include and include[1] in FLOORS and FLOORS.index(include[1]) > FLOORS.index(floor):
                    problems.append(f"{chapter}:{number}: {floor} must not include {include[1]}: an include never climbs")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


main()
