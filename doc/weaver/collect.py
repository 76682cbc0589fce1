#!/usr/bin/python3
"""Collect all that can be read of malus in a folder for a static host.

    collect.py --out DIR --book DIR --report DIR [--paper FILE.pdf...] [--packages DIR...]

The folder is the woven book, with the report of `malus reproduce` in report/,
the volumes as PDFs and in packages/ what make deb and make wheel have left in
their folders, as far as these have been made.
All links are relative, so that it may be put anywhere, or opened from a disk.
"""
import argparse
import glob
import hashlib
import os
import re
import sys
from html import escape

import links
import weave
from problems import Problem

BEGIN = re.compile(r'<p class="begin">.*?</p>')  # of the title page, below which the other things are linked from
UNREAD = (".tex",)  # what a report has for the weaver alone
PACKAGES = """<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark">
<title>Packages - malus</title><link rel="stylesheet" href="../book.css"></head>
<body><main>
<h1>Packages</h1>
<p>Each file with its size and its SHA-256. Back to <a href="../index.html">the book</a>.</p>
<ul>
{}
</ul>
</main></body>
</html>
"""


def files_below(folder: str) -> list[str]:
    """All files, by their names from the folder."""
    return sorted(os.path.relpath(os.path.join(below, name), folder) for below, _, names in os.walk(folder) for name in names)


def size_in_words(path: str) -> str:
    """How large a file is, for a reader."""
    return f"{os.path.getsize(path) / 1e6:.1f} MB"


def package_line(path: str) -> str:
    """A package as an item of a list."""
    with open(path, "rb") as file:
        digest = hashlib.sha256(file.read()).hexdigest()
    name = escape(os.path.basename(path), quote=True)
    return f'<li><a href="{name}">{name}</a>, {size_in_words(path)}<br><code>{digest}</code></li>'


def collect(options: argparse.Namespace) -> None:
    """Copies everything, and links it from the title page."""
    out = weave.Folder(options.out)
    also = []
    for name in files_below(options.book):
        if name != "index.html":
            out.copy(name, os.path.join(options.book, name))
    for number, path in enumerate(options.paper, 1):
        if not os.path.exists(path):
            continue
        out.copy(os.path.basename(path), path)
        also.append(f'<a href="{os.path.basename(path)}">Volume {number} on paper</a> (PDF, {size_in_words(path)})')
    for name in files_below(options.report):
        if not name.endswith(UNREAD):
            out.copy("report/" + name, os.path.join(options.report, name))
    also.append('<a href="report/report.html">The report of the reproduction</a>')
    packages = sorted(path for folder in options.packages for kind in ("deb", "whl") for path in glob.glob(os.path.join(folder, "*." + kind)))
    if packages:
        for path in packages:
            out.copy("packages/" + os.path.basename(path), path)
        out.put("packages/index.html", PACKAGES.format("\n".join(map(package_line, packages))))
        also.append('<a href="packages/index.html">Packages</a>')
    with open(os.path.join(options.book, "index.html"), encoding="utf-8") as file:
        title = file.read()
    begin = BEGIN.search(title)
    if not begin:
        raise Problem(f"{options.book}/index.html", 0, "has no place to begin")
    out.put("index.html", title[:begin.end()] + '<p class="also">' + " · ".join(also) + "</p>" + title[begin.end():])
    out.remove_others()


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("out", "book", "report"):
        arguments.add_argument("--" + name, required=True)
    arguments.add_argument("--paper", nargs="*", default=[])
    arguments.add_argument("--packages", nargs="*", default=[])
    options = arguments.parse_args()
    try:
        collect(options)
    except Problem as problem:
        sys.exit(str(problem))
    problems = links.check(options.out)
    for sentence in problems:
        print(sentence, file=sys.stderr)
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
