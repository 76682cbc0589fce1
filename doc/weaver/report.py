#!/usr/bin/python3
"""The report of `malus reproduce` as a page for people.

    report.py REPORT.json...

For each report (report.json, or partial.json of a run of some items) the page
is written beside it, where its pictures and tables are. How it looks is said
by the template doc/book/report.html, which needs neither network nor scripts.
"""
import json
import pathlib
import sys
from typing import Any

import jinja2

TEMPLATES = pathlib.Path(__file__).resolve().parent.parent / "book"


def page(report: dict[str, Any]) -> str:
    """The page; what the template names and the report lacks is an error."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined,
                                     keep_trailing_newline=True)
    return environment.get_template("report.html").render(report)


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for path in map(pathlib.Path, sys.argv[1:]):
        path.with_suffix(".html").write_text(page(json.loads(path.read_text(encoding="utf-8"))), encoding="utf-8")


if __name__ == "__main__":
    main()
