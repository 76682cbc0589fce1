#!/usr/bin/python3
"""Where the instructions of a picture go: the copper chunky bar by importance sampling, four directions from the first surface.

    instructions.py MALUS OUT.csv

Valgrind counts them in two renderings by one thread, 64 and 128 pixels a side. The difference, by pixel, is free of start-up and of
tables that are filled on first use. A part holds all that its functions call, so parts overlap where the text of the book says so.
"""
import datetime
import pathlib
import re
import subprocess
import sys
import tempfile

import commands

SIDES = (64, 128)
# each part, and what the names of its functions begin with
PARTS = {
    "all": ("malus::Radiometry::radiance(",),
    "tracing": ("rtcIntersect1 ", "rtcIntersect16 ", "rtcOccluded1 ", "rtcOccluded16 "),
    "images": ("malus::SunImages::seenFrom(",),
    "drawing": ("malus::importanceSampling(",),
    "points": ("malus::SobolPoints::points(", "malus::SobolPoints::SobolPoints("),
}


def counted(malus: str, work: pathlib.Path, side: int) -> dict[str, int]:
    """Instructions of each part."""
    profile = work / f"{side}.out"
    scene = commands.scene(work, side, 1, 5)
    subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", malus, "render", str(scene), "--threads", "1",
                    "--write", "cube", "--out", str(work / "out")], check=True, capture_output=True)
    listed = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(profile)],
                            check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^ *([\d,]+) \([^)]*\)  [^:]*:(.*)$", listed, flags=re.M)
    return {part: sum(int(number.replace(",", "")) for number, name in lines if name.startswith(names)) for part, names in PARTS.items()}


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as directory:
        few, many = (counted(sys.argv[1], pathlib.Path(directory), side) for side in SIDES)
    pixels = SIDES[1] ** 2 - SIDES[0] ** 2
    rows = [f"{part},{(many[part] - few[part]) / pixels:.0f}" for part in PARTS]
    head = ("# title: Instructions for a pixel of the copper chunky bar by importance sampling, four directions from the first surface\n"
            f"# source: tests/bench/instructions.py, Valgrind\n# date: {datetime.date.today().isoformat()}\n")
    pathlib.Path(sys.argv[2]).write_text(head + "part,instructions_per_pixel\n" + "\n".join(rows) + "\n", encoding="utf-8")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
