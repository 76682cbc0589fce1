#!/usr/bin/python3
"""Tangle one chapter of the book into its C++ files.

    tangle.py [--plain | --exact] OUT CHAPTER.nw ROOT...

Every ROOT is the name of a root chunk and, below OUT, of the file it becomes.
The chapter must have exactly these roots: an unexpected root is a misspelt or forgotten chunk, and stops the build with
its name, as does a chunk that is used but never defined. A file is rewritten only if its text changed,
so that make's clock sees real changes alone. --plain leaves out the line
directives (for the source archive, clang-format and clang-tidy).

A header whose new text differs from the old in nothing but line directives is
kept as well, because a sentence added to a chapter would otherwise compile all
who include the header. The price: until the header's code changes next, what
the compiler or a debugger says of it may name a line of the chapter that is a
little off. The new text is written beside the header, X.hpp.lines, where the
index of the book reads the lines. --exact does not pay (coverage counts lines).

Several build directories may tangle into one OUT at the same time. Each file
appears whole (it is renamed into place), and no file is overwritten with the tangled text of an older chapter: the
files are written under a lock on OUT,
and only while the chapter is still the one that was tangled.
"""
import contextlib
import fcntl
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import NoReturn

LINE_DIRECTIVE = re.compile(r"^#line .*\n", re.MULTILINE)


def fail(chapter: str, messages: list[str]) -> NoReturn:
    for message in messages:
        print(f"{chapter}: {message}", file=sys.stderr)
    sys.exit(1)


def run(command: list[str]) -> tuple[int, str, str]:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr.strip()


def roots_of(chapter: str) -> tuple[list[str], str]:
    _, listed, complaint = run(["noroots", chapter])
    names = [line[2:-2] for line in listed.splitlines() if line.startswith("<<")]
    return names, complaint


def check_roots(chapter: str, expected: list[str]) -> None:
    found, complaint = roots_of(chapter)
    problems = [complaint] if complaint else []
    problems += [
        f"chunk <<{name}>> is not used by a chunk and is not a file that CMakeLists.txt lists for this"
        " chapter; use it, list it, or fix its spelling"
        for name in found if name not in expected
    ]
    problems += [
        f"CMakeLists.txt expects the file {name}, but no chunk <<{name}>>= begins it"
        for name in expected if name not in found
    ]
    if problems:
        fail(chapter, problems)


def tangled(chapter: str, name: str, directives: bool) -> str:
    code, text, complaint = run(["notangle", *(["-L"] if directives else []), f"-R{name}", chapter])
    if code or complaint:
        fail(chapter, (complaint or f"notangle gave {code}").splitlines())
    return text


def same_code(old: str, new: str) -> bool:
    return LINE_DIRECTIVE.sub("", old) == LINE_DIRECTIVE.sub("", new)


def old_text(path: str) -> str | None:
    with contextlib.suppress(FileNotFoundError), open(path, encoding="utf-8") as file:
        return file.read()
    return None


def write_if_changed(path: str, text: str) -> None:
    if old_text(path) == text:
        return
    os.makedirs(os.path.dirname(path), exist_ok=True)
    fresh = f"{path}.{os.getpid()}.new"
    with open(fresh, "w", encoding="utf-8") as new:
        new.write(text)
    os.replace(fresh, path)


def write_header(path: str, text: str, may_keep: bool) -> None:
    old, lines = old_text(path), path + ".lines"
    if may_keep and old is not None and old != text and same_code(old, text):
        write_if_changed(lines, text)
    else:
        write_if_changed(path, text)
        with contextlib.suppress(FileNotFoundError):
            os.remove(lines)


@contextlib.contextmanager
def locked(folder: str) -> Iterator[None]:
    os.makedirs(folder, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)  # which gives the lock back


def state(chapter: str) -> tuple[int, int, int]:
    seen = os.stat(chapter)
    return seen.st_ino, seen.st_size, seen.st_mtime_ns


def tangle(out: str, chapter: str, names: list[str], directives: bool, exact: bool) -> bool:
    """False if the chapter changed meanwhile; then nothing is written."""
    before = state(chapter)
    check_roots(chapter, names)
    texts = {name: tangled(chapter, name, directives) for name in names}
    with locked(out):
        if state(chapter) != before:
            return False
        for name, text in texts.items():
            path = os.path.join(out, name)
            if name.endswith(".hpp"):
                write_header(path, text, directives and not exact)
            else:
                write_if_changed(path, text)
    return True


def main() -> None:
    arguments = sys.argv[1:]
    options = {argument for argument in arguments if argument.startswith("--")}
    arguments = [argument for argument in arguments if argument not in options]
    if len(arguments) < 3 or options - {"--plain", "--exact"}:
        sys.exit(__doc__)
    out, chapter, *names = arguments
    while not tangle(out, chapter, names, "--plain" not in options, "--exact" in options):
        pass


main()
