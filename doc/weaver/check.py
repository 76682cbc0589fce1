#!/usr/bin/python3
"""Rules of the house that one chapter alone cannot see.

    check.py CHAPTER.nw...

1. A chunk name belongs to one chapter: the woven book joins all chapters, and
   two chunks of one name would be printed as one.
2. An include never climbs from a floor to one above it.
3. Files make no circles: no chapter includes another that leads back to it.
4. CD begins the names of the thesis, and no others.
5. A file has 550 lines of code at most, and a function 70, its chunks included.
"""
import re
import sys

FLOORS = ["base", "light", "surface", "air", "scene", "render", "files", "app", "thesis", "python", "live"]
BESIDE = {"python": "files", "live": "render"}  # floors on a lower one than their neighbour: the highest that each may include
THESIS = {"CDPolarimetricMath", "CDVector", "CDStokesVector", "CDMuellerMatrix", "CDSpectralVector",
          "CDSpectralLocation", "CDSpectralPoint", "CDSpectralUnits", "CDBRDFModel"}
BEGINS = re.compile(r"^<<(.*)>>=\s*$")
INCLUDE = re.compile(r'^#include "malus/(\w+)/(\w+)\.')
OURS = re.compile(r"\bCD[A-Z]\w*")
ROOT = re.compile(r"\w+/\w+\.(?:plugin\.cpp|[ch]pp)$")
USE = re.compile(r"^(\s*)<<(.*)>>\s*$")
MOST_LINES, MOST_OF_A_FUNCTION = 550, 70


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
                problems.extend(f"{where}: {name} is not a name of the thesis; leave out the CD"
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


def chunks_of(chapter: str) -> dict[str, list[str]]:
    """The lines of code of each chunk, without empty ones and comments."""
    chunks: dict[str, list[str]] = {}
    current: list[str] | None = None
    with open(chapter, encoding="utf-8") as lines:
        for line in lines:
            if begin := BEGINS.match(line):
                current = chunks.setdefault(begin[1], [])
            elif re.match(r"@( |$)", line):
                current = None
            elif current is not None and line.strip() and not line.lstrip().startswith("//"):
                current.append(line.rstrip("\n"))
    return chunks


def tangled(name: str, chunks: dict[str, list[str]]) -> list[str]:
    """A chunk with all that it uses."""
    text: list[str] = []
    for line in chunks.get(name, []):
        if use := USE.match(line):
            text += [use[1] + inner for inner in tangled(use[2], chunks)]
        else:
            text.append(line)
    return text


def functions(text: list[str]) -> list[tuple[str, int]]:
    """First line and length of each function outside of classes."""
    found: list[tuple[str, int]] = []
    start: int | None = None
    depth = 0
    for number, line in enumerate(text):
        if re.match(r"#|(inline )?namespace\b|}  // namespace", line):
            continue
        start = number if start is None else start
        bare = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])\'|//.*', "", line).rstrip()
        depth += bare.count("{") - bare.count("}")
        if depth == 0 and bare.endswith((";", "}")):
            if bare.endswith("}"):
                found.append((text[start], number + 1 - start))
            start = None
    return found


def lengths(chapter: str, problems: list[str]) -> None:
    """Files and functions that are too long."""
    chunks = chunks_of(chapter)
    for root in filter(ROOT.match, chunks):
        text = tangled(root, chunks)
        if len(text) > MOST_LINES:
            problems.append(f"{chapter}: {root} has {len(text)} lines of code; part it into chapters of one subject each")
        problems += [f"{chapter}: {length} lines in a function of {root}: {name}; part it"
                     for name, length in functions(text) if length > MOST_OF_A_FUNCTION]


def main() -> None:
    problems: list[str] = []
    homes: dict[str, str] = {}
    leads: dict[str, set[str]] = {}
    for chapter in sys.argv[1:]:
        floors_and_names(chapter, problems, homes, leads)
        lengths(chapter, problems)
    problems += [f"nw/{circle[0]}.nw: a circle of includes: {' > '.join(circle)}" for circle in circles(leads)]
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


main()
