#!/usr/bin/python3
"""Rules of the house that one chapter alone cannot see.

    check.py CHAPTER.nw...

1. A chunk name belongs to one chapter: the woven book joins all chapters, and
   two chunks of one name would be printed as one.
2. An include never climbs from a floor to one above it.
3. Files make no circles: no chapter includes another that leads back to it.
4. CD begins the names of the thesis, and no others.
"""
import re
import sys

FLOORS = ["base", "light", "surface", "air", "scene", "render", "files", "app", "thesis", "python"]
BESIDE = {"python": "files"}  # a floor that stands on a lower one than its neighbour: the highest that it may include
THESIS = {"CDPolarimetricMath", "CDVector", "CDStokesVector", "CDMuellerMatrix", "CDSpectralVector",
          "CDSpectralLocation", "CDSpectralPoint", "CDSpectralUnits", "CDBRDFModel"}
BEGINS = re.compile(r"^<<(.*)>>=\s*$")
INCLUDE = re.compile(r'^#include "malus/(\w+)/(\w+)\.')
OURS = re.compile(r"\bCD[A-Z]\w*")


def floors_and_names(chapter: str, problems: list[str], homes: dict[str, str], leads: dict[str, set[str]]) -> None:
    """Reads one chapter: chunk names, includes, names with CD."""
    floor = chapter.split("/")[-2]
    me = f"{floor}/{chapter.split('/')[-1].removesuffix('.nw')}"
    code = False
    with open(chapter, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            where = f"{chapter}:{number}"
            if begin := BEGINS.match(line):
                code = True
                home = homes.setdefault(begin[1], chapter)
                if home != chapter:
                    problems.append(f"{where}: chunk <<{begin[1]}>> is also a chunk of {home}; give one of them another name")
            elif re.match(r"@( |$)", line):
                code = False
            if include := INCLUDE.match(line):
                if include[1] != floor and FLOORS.index(include[1]) > FLOORS.index(BESIDE.get(floor, floor)):
                    problems.append(f"{where}: {floor} must not include {include[1]}: an include never climbs")
                leads.setdefault(me, set()).add(f"{include[1]}/{include[2]}")
            if code:
                problems.extend(f"{where}: {name} is no name of the thesis; leave out the CD"
                                for name in OURS.findall(line) if name not in THESIS)


def circles(leads: dict[str, set[str]]) -> list[list[str]]:
    """One circle for each chapter that can be reached from itself."""
    found: list[list[str]] = []
    done: set[str] = set()

    def walk(at: str, path: list[str]) -> None:
        if at in path:
            found.append(path[path.index(at):] + [at])
        elif at not in done:
            for to in sorted(leads.get(at, set()) - {at}):
                walk(to, path + [at])
            done.add(at)

    for start in sorted(leads):
        walk(start, [])
    return found


def main() -> None:
    problems: list[str] = []
    homes: dict[str, str] = {}
    leads: dict[str, set[str]] = {}
    for chapter in sys.argv[1:]:
        floors_and_names(chapter, problems, homes, leads)
    problems += [f"nw/{circle[0]}.nw: a circle of includes: {' > '.join(circle)}" for circle in circles(leads)]
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


main()
