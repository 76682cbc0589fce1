"""Reads chapters through noweb's own pipeline, markup | finduses | noidx.

noweb does the parsing: it finds chunks, quotes and escapes, which identifier
is used where, and gives every chunk a label that stays the same from run to
run. This module turns what the pipeline says into chapters and chunks, and
writes each chapter's prose as LaTeX. That LaTeX has as many lines as the
chapter, in the same places, so a line number in a complaint of LaTeXML is a
line number of the chapter.
"""
import re
import subprocess

LIB = "/usr/lib/noweb"  # where Debian keeps the filters; noweave itself has this path built in

USE = "\x01{}\x02"  # marks the use of another chunk in a chunk's text: its place in chunk.used_chunks


class Chunk:
    """One chunk definition. Labels are noweb's; a chunk continued later has one label for each piece."""

    def __init__(self, chapter: "Chapter") -> None:
        self.chapter = chapter
        self.name = self.label = self.text = ""
        self.used_chunks: list[tuple[str, str]] = []  # (name, label of its first piece, "" if undefined)
        self.used_in: list[str] = []  # labels of the chunks that use this one
        self.links: dict[str, str] = {}  # identifier -> label of the chunk that defines it
        self.defines: list[tuple[str, list[str]]] = []  # (identifier, labels of the chunks that use it)
        self.number = 0        # in the order of the book, from 1
        self.line = 0          # of its chapter, with its first line of code
        self.pieces: list[Chunk] = []  # all chunks of this name, in order


class Chapter:
    """One file: its path and its text, a list of LaTeX strings and Chunks."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.parts: list[str | Chunk] = [""]
        self.chunks: list[Chunk] = []
        self.lines = 0  # read so far

    def latex(self) -> str:
        """The prose, line for line; a chunk is \\litchunk{label} and as many empty lines as it has of code."""
        return "".join(rf"\litchunk{{{part.label}}}" if isinstance(part, Chunk) else part for part in self.parts)


def quote_latex(code: str) -> str:
    """LaTeX that prints the characters of some code as they are."""
    special = {"\\": r"\char92{}", "^": r"\char94{}", "~": r"\char126{}", "'": r"\textquotesingle{}",
               "`": r"\textasciigrave{}", '"': r"\char34{}", "<": "<{}", ">": ">{}", "-": "-{}"}
    return "".join(special.get(c, "\\" + c if c in "{}$&#_%" else c) for c in code)


def pipeline(paths: list[str]) -> list[str]:
    first = [f"{LIB}/markup", *paths]
    stages = [first, [f"{LIB}/finduses"], [f"{LIB}/noidx"]]
    text = b""
    for stage in stages:
        done = subprocess.run(stage, input=text, capture_output=True, check=False)
        if done.returncode or done.stderr:
            raise RuntimeError(f"{stage[0]}: {done.stderr.decode().strip() or done.returncode}")
        text = done.stdout
    return text.decode("utf-8").split("\n")


class Reader:
    """Takes the pipeline's lines one by one; `@key rest` calls the method `on_key(rest)`."""

    def __init__(self) -> None:
        self.chapters: list[Chapter] = []
        self.inside = False    # between @begin and @end; noidx puts empty lines after the last chapter
        self.chunk: Chunk | None = None  # the chunk whose code is being read
        self.defining = False  # between @begin code and the end of its first line
        self.quoting = False
        self.reference = ""    # the label that belongs to the next @use or @index use
        self.link = ""         # where the next quoted word is defined
        self.users: list[str] = []

    def read(self, lines: list[str]) -> list[Chapter]:
        methods = {"@" + name[3:]: getattr(self, name) for name in dir(self) if name.startswith("on_")}
        for line in lines:
            key, _, rest = line.partition(" ")
            if key in methods:
                methods[key](rest)
        return self.chapters

    def write(self, latex: str) -> None:
        parts = self.chapters[-1].parts
        if isinstance(parts[-1], str):
            parts[-1] += latex
        else:
            parts.append(latex)

    def next_line(self) -> None:
        self.write("\n")
        self.chapters[-1].lines += 1

    def on_file(self, path: str) -> None:
        self.chapters.append(Chapter(path))

    def on_begin(self, rest: str) -> None:
        self.inside = True
        if rest.startswith("code"):
            self.chunk = Chunk(self.chapters[-1])
            self.defining = True

    def on_defn(self, name: str) -> None:
        assert self.chunk
        self.chunk.name = name
        self.chunk.line = self.chapters[-1].lines + 2
        self.chapters[-1].parts.append(self.chunk)
        self.chapters[-1].chunks.append(self.chunk)

    def on_end(self, rest: str) -> None:
        self.inside = False
        if rest.startswith("code") and self.chunk:
            self.chunk.text = self.chunk.text.rstrip("\n")
            self.chunk = None

    def on_text(self, text: str) -> None:
        if self.chunk:
            self.chunk.text += text
        elif self.quoting and self.link:
            self.write(rf"\litlink{{{self.link}}}{{{quote_latex(text)}}}")
            self.link = ""
        else:
            self.write(quote_latex(text) if self.quoting else text)

    def on_nl(self, _: str) -> None:
        if not self.inside:
            return
        self.next_line()
        if self.chunk and not self.defining:
            self.chunk.text += "\n"
        self.defining = False

    def on_quote(self, _: str) -> None:
        self.quoting = True
        self.write(r"\litcode{")

    def on_endquote(self, _: str) -> None:
        self.quoting = False
        self.write("}")

    def on_use(self, name: str) -> None:
        if self.chunk:
            self.chunk.text += USE.format(len(self.chunk.used_chunks))
            self.chunk.used_chunks.append((name, "" if self.reference == "nw@notdef" else self.reference))

    def on_xref(self, rest: str) -> None:
        what, _, label = rest.partition(" ")
        if what == "ref":
            self.reference = label
        elif what == "label" and self.chunk and not self.chunk.label:
            self.chunk.label = label  # later labels in a chunk are those of the places where it uses others
        elif what == "useitem" and self.chunk:
            self.chunk.used_in.append(label)

    def on_index(self, rest: str) -> None:
        what, _, value = rest.partition(" ")
        if what == "use" and self.chunk:
            self.chunk.links[value] = self.reference
        elif what == "use" and self.quoting:
            self.link = self.reference
        elif what == "nl":
            self.next_line()
        elif what == "isused":
            self.users.append(value)
        elif what == "defitem" and self.chunk:
            self.chunk.defines.append((value, self.users))
            self.users = []
        elif what == "enddefs":
            self.users = []


def read(paths: list[str]) -> list[Chapter]:
    """The chapters of the files, in order, with all chunks numbered and joined to their pieces."""
    chapters = Reader().read(pipeline(paths))
    names: dict[str, list[Chunk]] = {}
    number = 0
    for chapter in chapters:
        for chunk in chapter.chunks:
            number += 1
            chunk.number = number
            chunk.pieces = names.setdefault(chunk.name, [])
            chunk.pieces.append(chunk)
            chunk.used_in = chunk.pieces[0].used_in
    return chapters


def plain(name: str) -> str:
    """A chunk's name without the brackets around quoted code."""
    return re.sub(r"\[\[(.*?)\]\]", r"\1", name)
