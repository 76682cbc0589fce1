#!/usr/bin/python3
"""Let clang-format format the code of the chapters.

    format.py [--check] CHAPTER.nw...

clang-format needs whole files, but the code is in chunks. So each root is
tangled here with the origin of every character remembered, clang-format reports the white space that it would replace,
and the replacements are carried back
to the chunk they came from. White space where two chunks meet belongs to no
chunk and stays as it is. --check changes nothing and fails if it would.
"""
import re
import subprocess
import sys
import xml.etree.ElementTree as xml
from collections.abc import Iterator

BEGINS = re.compile(r"^<<(.*)>>=[ \t]*$")
ENDS = re.compile(r"^@([ \t]|$)")
Chunks = dict[str, list[tuple[int, str]]]

USE = re.compile(r"(?<!@)<<((?:(?!<<|>>).)+)>>")


class Char:
    """One tangled character: the character, its place in the chapter, its chunk, and its indentation."""
    __slots__ = ("text", "origin", "chunk", "indent")

    def __init__(self, text: str, origin: int | None, chunk: str | None, indent: int) -> None:
        self.text, self.origin, self.chunk, self.indent = text, origin, chunk, indent


def read_chunks(text: str) -> Chunks:
    """{name: [(offset, line), ...]} with every line of code and where it begins."""
    chunks: Chunks = {}
    name, offset = None, 0
    for line in text.splitlines(keepends=True):
        if begin := BEGINS.match(line):
            name = begin[1]
            chunks.setdefault(name, [])
        elif ENDS.match(line):
            name = None
        elif name is not None:
            chunks[name].append((offset, line))
        offset += len(line)
    return chunks


def expand(chunks: Chunks, name: str, indent: int, out: list[Char]) -> None:
    lines = chunks[name]
    for number, (offset, line) in enumerate(lines):
        last = number == len(lines) - 1
        body = line.rstrip("\n")
        if number:
            out.extend(Char(" ", None, None, 0) for _ in range(indent))
        column, position = indent, 0
        for use in USE.finditer(body):
            if use[1] not in chunks:
                continue
            plain(body[position:use.start()], offset + position, name, indent, out)
            column = indent + use.start()
            expand(chunks, use[1], column, out)
            position = use.end()
        plain(body[position:], offset + position, name, indent, out)
        if not last:
            out.append(Char("\n", offset + len(body), name, indent))


def plain(text: str, offset: int, name: str, indent: int, out: list[Char]) -> None:
    escaped = re.compile(r"@(<<|>>)")
    skip = {m.start() for m in escaped.finditer(text)}
    out.extend(Char(c, offset + i, name, indent) for i, c in enumerate(text) if i not in skip)


def replacements(code: str, path: str) -> Iterator[tuple[int, int, str]]:
    answer = subprocess.run(["clang-format", "--output-replacements-xml", f"--assume-filename={path}"],
                            input=code.encode(), capture_output=True, check=True)
    spans = code.encode()
    for r in xml.fromstring(answer.stdout).iter("replacement"):
        begin, length = int(r.attrib["offset"]), int(r.attrib["length"])
        first = len(spans[:begin].decode())
        yield first, first + len(spans[begin:begin + length].decode()), r.text or ""


def edits_of(text: str, chars: list[Char], root: str) -> Iterator[tuple[int, int, str]]:
    code = "".join(c.text for c in chars) + "\n"
    for begin, end, new in replacements(code, root):
        while begin > 0 and code[begin - 1].isspace():  # widen to the whole gap between two words
            begin -= 1
            new = code[begin] + new
        while end < len(chars) and code[end].isspace():
            new += code[end]
            end += 1
        if begin == 0 or end >= len(chars) or new.strip():
            continue
        before, after = chars[begin - 1], chars[end]
        if before.origin is None or after.origin is None or before.chunk != after.chunk:
            continue
        first, last = before.origin + 1, after.origin
        if first > last or text[first:last].strip():
            continue
        if "\n" in text[first:last] and "\n" not in new and "//" in text[text.rfind("\n", 0, first) + 1:first]:
            continue  # a comment ends with its line
        lines = new.split("\n")
        for i in range(1, len(lines)):
            lines[i] = lines[i][after.indent:] if i == len(lines) - 1 else ""
        yield first, last, "\n".join(lines)


def main() -> None:
    arguments = sys.argv[1:]
    check = "--check" in arguments
    changed = []
    for chapter in (a for a in arguments if a != "--check"):
        with open(chapter, encoding="utf-8") as file:
            text = file.read()
        for _ in range(4):  # one edit may make room for another
            chunks, edits = read_chunks(text), dict[tuple[int, int], str]()
            for root in (name for name in chunks if re.search(r"\.[ch]pp$", name)):
                chars: list[Char] = []
                expand(chunks, root, 0, chars)
                for first, last, new in edits_of(text, chars, root):
                    if text[first:last] != new:
                        edits[first, last] = new
            if not edits:
                break
            changed.append(chapter)
            for (first, last), new in sorted(edits.items(), reverse=True):
                text = text[:first] + new + text[last:]
        if chapter in changed and not check:
            with open(chapter, "w", encoding="utf-8") as file:
                file.write(text)
    for chapter in dict.fromkeys(changed):
        print(f"{chapter}: {'needs formatting: type make format' if check else 'formatted'}")
    sys.exit(check and bool(changed))


main()
