#!/usr/bin/python3
"""Draw the map of the book, a house whose floors have a box for each chapter.

    map.py ORDER MAP.svg [CHAPTER.nw...]

ORDER (nw/order.txt) has a line for each chapter: floor/Name and the words of its
box. A chapter that is on no line gets its own name. The build runs it; a test of
the book compares the boxes with the chapters.
"""
import html
import sys

FLOORS = {"base": "Base", "light": "Light", "surface": "Surface", "air": "Air", "scene": "Scene", "render": "Rendering",
          "files": "Files", "app": "The program", "thesis": "The thesis reproduced",
          "python": "Python", "live": "Live figures"}
WIDE, LEFT, BOX, GAP, HEAD, EDGE = 744, 20, 27, 7, 28, 8
NARROW = set("fijlrt.,:;'I |()")
HEADER = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 {height}">
<style>
  .drawing text {{ font: 13px Pagella, "TeX Gyre Pagella", Palatino, Georgia, serif; fill: currentColor; text-anchor: middle; }}
  .drawing .title {{ font-size: 15px; font-weight: bold; text-anchor: start; }}
  .drawing .box {{ fill: #f8f4ea; stroke: currentColor; stroke-width: 1; }}
  .drawing a:hover .box, .drawing a:focus .box {{ stroke-width: 2.2; }}
  .drawing .floor {{ fill: none; stroke: #8a8a8a; stroke-width: 1; }}
</style>
<g class="drawing">
"""


def width_of(text: str) -> int:
    return 18 + round(sum(4.0 if letter in NARROW else 9.5 if letter in "mwMW" else 8.8 if letter.isupper() else 6.9 for letter in text))


def floor_of(chapters: list[tuple[str, str]], title: str, top: int) -> tuple[list[str], int]:
    """The drawing of a floor whose upper edge is at `top`, and its lower edge."""
    boxes, x, y = [], LEFT, top + HEAD
    for name, text in chapters:
        width = width_of(text)
        if x + width > WIDE:
            x, y = LEFT, y + BOX + GAP
        boxes.append(f'<a href="ch:{name}"><rect x="{x}" y="{y}" width="{width}" height="{BOX}" rx="4" class="box"/>'
                     f'<text x="{x + width // 2}" y="{y + 18}">{html.escape(text)}</text></a>')
        x += width + GAP
    bottom = y + BOX + EDGE
    frame = (f'<rect x="8" y="{top}" width="{WIDE}" height="{bottom - top}" class="floor"/>'
             f'<text x="20" y="{top + 19}" class="title">{title}</text>')
    return [frame, *boxes], bottom


def main() -> None:
    order, target, *chapters = sys.argv[1:]
    labels: dict[str, str] = {}
    with open(order, encoding="utf-8") as lines:
        for line in lines:
            if line.strip() and not line.startswith("#"):
                chapter, _, text = line.strip().partition(" ")
                labels[chapter] = text.strip() or chapter.split("/")[1]
    for path in chapters:
        name = "/".join(path.removesuffix(".nw").split("/")[-2:])
        labels.setdefault(name, name.split("/")[1])
    drawn, top = [], 14
    for floor in reversed(FLOORS):
        inside = [(name.split("/")[1], text) for name, text in labels.items() if name.startswith(floor + "/")]
        rows, bottom = floor_of(inside, FLOORS[floor], top)
        drawn += rows
        top = bottom + EDGE
    with open(target, "w", encoding="utf-8") as out:
        out.write(HEADER.format(height=top + 4) + "\n".join(drawn) + "\n</g>\n</svg>\n")


main()
