#!/usr/bin/env python3
"""Tangle one chapter of the book into its C++ files.

    tangle.py [--plain] OUT CHAPTER.nw ROOT...

Every ROOT is the name of a root chunk and, below OUT, of the file it becomes.
The chapter must have exactly these roots: a root nobody asked for is a
misspelt or forgotten chunk, and stops the build with its name, as does a chunk
that is used but never defined. A file is rewritten only if its text changed,
so that make's clock sees real changes alone. --plain leaves out the line
directives (for the source archive, clang-format and clang-tidy).
"""
import os
import subprocess
import sys


def fail(chapter, messages):
    for message in messages:
        print(f"{chapter}: {message}", file=sys.stderr)
    sys.exit(1)


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr.strip()


def roots_of(chapter):
    _, listed, complaint = run(["noroots", chapter])
    names = [line[2:-2] for line in listed.splitlines() if line.startswith("<<")]
    return names, complaint


def check_roots(chapter, expected):
    found, complaint = roots_of(chapter)
    problems = [complaint] if complaint else []
    problems += [
        f"chunk <<{name}>> is used by no chunk and is no file that CMakeLists.txt lists for this"
        " chapter; use it, list it, or mend its spelling"
        for name in found if name not in expected
    ]
    problems += [
        f"CMakeLists.txt expects the file {name}, but no chunk <<{name}>>= begins it"
        for name in expected if name not in found
    ]
    if problems:
        fail(chapter, problems)


def write_if_changed(path, text):
    try:
        with open(path, encoding="utf-8") as old:
            if old.read() == text:
                return
    except FileNotFoundError:
        os.makedirs(os.path.dirname(path), exist_ok=True)
    fresh = f"{path}.{os.getpid()}.new"
    with open(fresh, "w", encoding="utf-8") as new:
        new.write(text)
    os.replace(fresh, path)


def main():
    arguments = sys.argv[1:]
    plain = "--plain" in arguments
    if plain:
        arguments.remove("--plain")
    if len(arguments) < 3:
        sys.exit(__doc__)
    out, chapter, *expected = arguments
    check_roots(chapter, expected)
    for name in expected:
        command = ["notangle", f"-R{name}", chapter]
        if not plain:
            command.insert(1, "-L")
        code, text, complaint = run(command)
        if code or complaint:
            fail(chapter, (complaint or f"notangle gave {code}").splitlines())
        write_if_changed(os.path.join(out, name), text)


main()
