"""The public names of the program, read from its headers by Universal Ctags.

A header is tangled with #line directives, so a name is known by the line of
the chapter that declares it. Each name directly in the program's namespace must be defined in the index by its author
(`@ %def`), since only then do all
uses link to it. Members, enumerators and operators carry names that many
classes share; a link from each `size` to one of them would mislead. They are
indexed here, by their full names: `Table::rows`.
"""
import glob
import json
import os
import re
import subprocess
from collections.abc import Collection, Iterable
from typing import Any

from problems import Problem

NAMESPACE = "malus"
Place = tuple[str, int]  # a chapter and its line
LINE = re.compile(r'#line (\d+) "([^"]+)"')


class Name:
    """One declaration: its full name without the namespace, and its place."""

    def __init__(self, full: str, word: str, kind: str, path: str, line: int) -> None:
        self.full, self.word, self.kind, self.path, self.line = full, word, kind, path, line

    def needs_def(self) -> bool:
        """Whether the author must define it: every name that a user of the namespace may write, except operators."""
        return "::" not in self.full and not self.word.startswith("operator")


def places(path: str) -> list[Place]:
    """For each line of a tangled header the (chapter, line) that it comes from."""
    # a header may be older than its chapter's lines; then the same code with today's lines is beside it (tangle.py)
    today = path + ".lines"
    code = iter(places_of_code(today if os.path.exists(today) else path))
    with open(path, encoding="utf-8") as lines:
        return [("", 0) if LINE.match(text) else next(code) for text in lines]


def places_of_code(path: str) -> list[Place]:
    """The same for the lines that are not directives."""
    origin: Place = ("", 0)
    out = []
    with open(path, encoding="utf-8") as lines:
        for text in lines:
            if directive := LINE.match(text):
                origin = (directive[2], int(directive[1]))
            else:
                out.append(origin)
                origin = (origin[0], origin[1] + 1)
    return out


def is_public(tag: dict[str, Any]) -> bool:
    """The names that a user may write, without constructors, which the class represents, and without details."""
    scope, name = tag.get("scope", ""), tag["name"]
    if not scope.startswith(NAMESPACE) or "detail" in scope or "__anon" in scope + name:
        return False
    if tag["scopeKind"] == "function" or tag["kind"] == "namespace" or tag["scopeKind"] == "enum" and "access" not in tag:
        return False
    if name == scope.split("::")[-1] or name.startswith("~") or name == "operator =":
        return False
    return tag["scopeKind"] == "namespace" or tag.get("access") == "public"


def public(folder: str) -> list[Name]:
    """All public names of the headers below a folder, in the order of the files and lines."""
    headers = sorted(glob.glob(os.path.join(folder, "*", "*.hpp")))
    command = ["ctags", "--output-format=json", "--languages=C++", "--kinds-C++=+p-d", "--fields=+ansK", "--sort=no",
               "-f", "-", "-L", "-"]
    try:
        done = subprocess.run(command, input="\n".join(headers), capture_output=True, text=True, check=True)
    except FileNotFoundError:
        raise Problem("ctags", 0, "not found; Debian's package universal-ctags brings it") from None
    origins: dict[str, list[Place]] = {}
    names = []
    for line in done.stdout.splitlines():
        tag = json.loads(line)
        if "scopeKind" not in tag or not is_public(tag):
            continue
        header = tag["path"]
        if header not in origins:
            origins[header] = places(header)
        origin = origins[header][tag["line"] - 1]
        scope = re.sub(rf"^{NAMESPACE}(::)?", "", tag["scope"])
        word = re.sub(r"^operator (?=\W)", "operator", tag["name"])
        names.append(Name(f"{scope}::{word}" if scope else word, word, tag["kind"], *origin))
    return names


def check(names: Iterable[Name], defined: Collection[str]) -> list[Problem]:
    """A problem for each name that its author must define and did not."""
    return [Problem(name.path, name.line, f"{name.full} is public, but no `@ %def` defines it for the index")
            for name in names if name.needs_def() and name.word not in defined]
