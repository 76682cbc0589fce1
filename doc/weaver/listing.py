"""The chunks of a book as HTML and as LaTeX: coloured C++, links to what is used, and below each chunk where it leads."""
import functools
import keyword
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape

import noweb
import tested
from names import Name
from noweb import Chunk

Identifier = tuple[str, str, set[str], set[str]]  # what Listing.identifiers says of one

KEYWORDS = frozenset("""
alignas alignof auto bool break case catch char class concept const consteval constexpr constinit const_cast continue
decltype default delete do double dynamic_cast else enum explicit export extern false final float for friend goto if
inline int long mutable namespace new noexcept nullptr operator override private protected public reinterpret_cast
requires return short signed sizeof static static_assert static_cast struct switch template this throw true try typedef
typeid typename union unsigned using virtual void volatile while""".split())

PYTHON_KEYWORDS = frozenset(keyword.kwlist)

TOKEN = re.compile(
    r"""(?P<use>\x01\d+\x02)
      | (?P<comment>//[^\n\x01]*|/\*.*?\*/)
      | (?P<directive>^[ ]*\#[ ]*\w+)
      | (?P<string>R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n\x01])*"|'(?:\\.|[^'\\\n\x01])+'|(?<=\#include[ ])<[^>\n]*>)
      | (?P<number>\b\d(?:[\w.]|'(?=\w)|(?<=[eEpP])[+-])*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<other>\s+|.)""", re.VERBOSE | re.MULTILINE | re.DOTALL)

PYTHON_TOKEN = re.compile(
    r"""(?P<comment>\#[^\n]*)
      | (?P<directive>^[ ]*@[\w.]+)
      | (?P<string>[rbfRBF]{0,2}(?:\"{3}(?:\\.|[^\\])*?\"{3}|'{3}(?:\\.|[^\\])*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'))
      | (?P<number>\b\d[\w.]*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<other>\s+|.)""", re.VERBOSE | re.MULTILINE | re.DOTALL)

ROOT = re.compile(r"\w+/\w+\.(?:plugin\.cpp|[ch]pp)$")  # the name of a chunk that is a file
FRAME = re.compile(r"\s*(?:#.*|(?:inline )?namespace\b[^;]*\{|\}+(?:\s*//.*)?|\x01\d+\x02|//.*|using [^;(]*;|(?:class|struct) \w+;|)$")

WHOLE = 12  # a chunk of so many lines is not cut by the end of a page
MOST = 8  # uses of an identifier that are listed below its definition; the index lists all


def anchor_of(word: str) -> str:
    """A place in the index; letters, digits and underscores stay, others (operators) become their codes."""
    return "id-" + re.sub(r"\W", lambda match: f".{ord(match[0]):x}", word)


def is_skeleton(chunk: Chunk) -> bool:
    """Whether a chunk only joins others to a file: includes, namespaces and uses, with little else."""
    lines = chunk.text.split("\n")
    framing = [line for line in lines if FRAME.match(line)]
    if "#include" not in chunk.text:
        return False
    return 3 * len(framing) >= 2 * len(lines) if ROOT.match(chunk.name) else len(framing) == len(lines)


def interface(chunks: Iterable[Chunk]) -> set[str]:
    """Labels of the chunks of a chapter that make its headers."""
    own = list(chunks)
    found: set[str] = set()
    waiting = [chunk.name for chunk in own if ROOT.match(chunk.name) and chunk.name.endswith(".hpp")]
    while waiting:
        name = waiting.pop()
        for chunk in own:
            if chunk.name == name and chunk.label not in found:
                found.add(chunk.label)
                waiting += [used for used, _ in chunk.used_chunks]
    return found


def name_html(name: str) -> str:
    """A chunk's name; it may quote code in double brackets."""
    parts = re.split(r"\[\[(.*?)\]\]", name)
    return "".join(f"<code>{escape(part)}</code>" if i % 2 else escape(part) for i, part in enumerate(parts))


class Listing:
    """The text in and below the chunks of a book. A renderer says how a link, a word or a colour is written."""

    def __init__(self, chapters: list[noweb.Chapter], names: Sequence[Name] = ()) -> None:
        self.names = names  # public names of the program's headers (names.py)
        self.chunks = [chunk for chapter in chapters for chunk in chapter.chunks]
        self.by_label = {chunk.label: chunk for chunk in self.chunks}
        self.by_path = {os.path.normpath(chapter.path): chapter.chunks for chapter in chapters}

    def number(self, label: str) -> str:
        """A chunk's number, which leads to it."""
        raise NotImplementedError

    def word(self, word: str) -> str:
        """A word of code in a line of prose."""
        raise NotImplementedError

    def use(self, name: str, label: str) -> str:
        """Where a chunk uses another."""
        raise NotImplementedError

    def identifier(self, text: str, label: str) -> str:
        """A word of code that leads to its definition."""
        raise NotImplementedError

    def plain(self, text: str) -> str:
        """Code as it is."""
        raise NotImplementedError

    def colour(self, kind: str, text: str) -> str:
        """Code of a kind: keyword, comment, string, number, directive."""
        raise NotImplementedError

    def ordered(self, labels: Iterable[str]) -> list[str]:
        return sorted(set(labels), key=lambda label: self.by_label[label].number)

    def code(self, chunk: Chunk) -> str:
        """The code of a chunk."""
        return self.coloured(chunk.text, chunk.links, chunk.used_chunks)

    def coloured(self, code: str, links: Mapping[str, str], used_chunks: Sequence[tuple[str, str]] = (), python: bool = False) -> str:
        """Some code in colours; links leads from identifiers to the chunks that define them."""
        out: list[str] = []
        waiting: list[str] = []  # plain text waits for its neighbours, since it comes in many small pieces

        def put(text: str) -> None:
            if waiting:
                out.append(self.plain("".join(waiting)))
                waiting.clear()
            out.append(text)

        for match in (PYTHON_TOKEN if python else TOKEN).finditer(code):
            kind, text = match.lastgroup or "", match[0]
            if kind == "use":
                put(self.use(*used_chunks[int(text[1:-1])]))
            elif kind == "word" and text in links:
                put(self.identifier(text, links[text]))
            elif kind == "word" and text in (PYTHON_KEYWORDS if python else KEYWORDS):
                put(self.colour("keyword", text))
            elif kind in ("word", "other"):
                waiting.append(text)
            else:
                put(self.colour(kind, text))
        put("")
        return "".join(out)

    def named_chunks(self) -> list[Chunk]:
        """The first piece of each chunk, by name."""
        firsts = [chunk for chunk in self.chunks if chunk.pieces[0] is chunk]
        return sorted(firsts, key=lambda chunk: noweb.plain(chunk.name).lower())

    @functools.cached_property
    def identifiers(self) -> list[Identifier]:
        """(identifier, what it is, labels of the chunks that define it, labels of the others that use it), by name."""
        defined: dict[str, set[str]] = {}
        used: dict[str, set[str]] = {}
        about: dict[str, str] = {}
        for chunk in self.chunks:
            for word, users in chunk.defines:
                defined.setdefault(word, set()).add(chunk.label)
                used.setdefault(word, set()).update(users)
        for word, labels in defined.items():
            about[word] = self.about(word, labels)
        for name in self.names:
            if "::" not in name.full and not name.word.startswith("operator"):
                continue  # defined by the author
            if home := self.chunk_at(name):
                defined.setdefault(name.full, set()).add(home.label)
                about[name.full] = about.get(name.full) or comment_at(name.line - home.line, home.text.split("\n"))
        return [(word, about[word] or self.place_of(defined[word]), defined[word], used.get(word, set()) - defined[word])
                for word in sorted(defined, key=lambda word: (word.lower(), word))]

    def chunk_at(self, name: Name) -> Chunk | None:
        """The chunk that declares a public name."""
        for chunk in self.by_path.get(os.path.normpath(name.path), ()):
            if 0 <= name.line - chunk.line <= chunk.text.count("\n"):
                return chunk
        return None

    def about(self, word: str, labels: Iterable[str]) -> str:
        """The description of an identifier: the first sentence of the comment at its declaration."""
        comments = (comment_on(word, self.by_label[label].text.split("\n")) for label in self.ordered(labels))
        return next((comment for comment in comments if comment), "")

    def place_of(self, labels: Iterable[str]) -> str:
        """The description of an identifier without a comment: it is a part of its chunk."""
        chunk = self.by_label[self.ordered(labels)[0]]
        return noweb.plain(chunk.name)


def comment_on(word: str, lines: list[str]) -> str:
    """The first sentence of the /// comment above or beside the declaration of a word; nothing if there is none."""
    whole = re.compile(rf"(?<!\w){re.escape(word)}(?!\w)")
    for place, line in enumerate(lines):
        if word in line and whole.search(line.split("//")[0]):
            if comment := comment_at(place, lines):
                return comment
    return ""


def comment_at(place: int, lines: list[str]) -> str:
    """The first sentence of the /// comment above or beside a line; nothing if there is none."""
    beside = re.search(r"///<?\s*(.*)", lines[place])
    above = place
    while above and re.match(r"\s*(template|requires|\[\[)", lines[above - 1]):
        above -= 1
    comment = [beside[1]] if beside else []
    while not beside and above and (note := re.match(r"\s*///\s?(.*)", lines[above - 1])):
        comment.insert(0, note[1].strip())
        above -= 1
    if not comment or not comment[0]:
        return ""
    text = " ".join(comment).split(" @param", maxsplit=1)[0]
    return re.split(r"(?<=[^.][^.][.!?])\s+(?=[A-Z(\[])", text)[0].rstrip(".;: ")


FOLDED = ' <span class="folded">includes and frame of the file</span>'


class HtmlListing(Listing):
    """Chunks as HTML. Links are written as chunk:LABEL; the weaver puts the address in when it lays out the pages."""

    def number(self, label: str) -> str:
        chunk = self.by_label[label]
        place = escape(f"{noweb.plain(chunk.name)}, {chunk.chapter.path}", quote=True)
        return f'<a href="chunk:{label}" title="{place}">{chunk.number}</a>'

    def numbers(self, labels: Iterable[str], word: str = "") -> str:
        """Links in the order of the book; of the uses of a word only the first few, and a link to all."""
        unique = self.ordered(labels)
        shown = unique if not word or len(unique) <= MOST + 1 else unique[:MOST]
        out = ", ".join(self.number(label) for label in shown)
        more = len(unique) - len(shown)
        return f"{out} and {self.more(more, word)}" if more else out

    def foot(self, chunk: Chunk) -> str:
        notes, place = [], chunk.pieces.index(chunk)
        if place > 0:
            notes.append(f"Continues {self.number(chunk.pieces[place - 1].label)}")
        if place + 1 < len(chunk.pieces):
            notes.append(f"Continued in {self.number(chunk.pieces[place + 1].label)}")
        if chunk.used_in:
            notes.append(f"Used in {self.numbers(chunk.used_in)}")
        elif place == 0:
            notes.append("A file of the program")
        for word, users in chunk.defines:
            others = [label for label in users if label != chunk.label]
            where = f", used in {self.numbers(others, word)}" if others else ""
            notes.append(f"Defines {self.word(word)}{where}")
        return ". ".join(notes) + "."

    def more(self, count: int, word: str) -> str:
        return f'<a href="identifiers.html#{anchor_of(word)}">{count} more</a>'

    def word(self, word: str) -> str:
        return f"<code>{escape(word)}</code>"

    def use(self, name: str, label: str) -> str:
        number = self.by_label[label].number
        return f'<a class="use" href="chunk:{label}">⟨{name_html(name)} <span class="chunk-number">{number}</span>⟩</a>'

    def identifier(self, text: str, label: str) -> str:
        target = self.by_label[label]
        title = f"defined in chunk {target.number}, {target.chapter.path}"
        return f'<a class="identifier" href="chunk:{label}" title="{escape(title)}">{text}</a>'

    def plain(self, text: str) -> str:
        return escape(text, quote=False)

    def colour(self, kind: str, text: str) -> str:
        return f'<span class="{kind}">{escape(text, quote=False)}</span>'

    def chunk(self, chunk: Chunk, anchor: str) -> str:
        again = "+" if chunk.pieces[0] is not chunk else ""
        folds = is_skeleton(chunk)
        box, head = ("details", "summary") if folds else ("div", "p")
        return (f'<{box} class="chunk" id="{anchor}">\n'
                f'<{head} class="chunk-name"><a class="chunk-number" href="#{anchor}">{chunk.number}</a>'
                f'⟨{name_html(chunk.name)}⟩<span class="defines">{again}≡</span>{FOLDED if folds else ""}</{head}>\n'
                f'<pre><code>{self.code(chunk)}</code></pre>\n'
                f'<p class="chunk-foot">{self.foot(chunk)}</p>\n</{box}>')

    def links_from(self, text: str) -> dict[str, str]:
        """Where a file of tests leads: the names with a capital that the chapters of its includes define."""
        links: dict[str, str] = {}
        for floor, name in re.findall(r'^#include "malus/(\w+)/(\w+)\.hpp"', text, re.MULTILINE):
            for chunk in self.by_path.get(os.path.join("nw", floor, name + ".nw"), ()):
                links |= {word: chunk.label for word, _ in chunk.defines if re.fullmatch(r"\w*[A-Z]\w*", word) and len(word) > 1}
        return links

    def chunk_index(self) -> str:
        rows = [f'<tr><td>⟨{name_html(chunk.name)}⟩</td>'
                f'<td>{self.numbers(piece.label for piece in chunk.pieces)}</td>'
                f'<td>{self.numbers(chunk.used_in) or "a file"}</td></tr>' for chunk in self.named_chunks()]
        return table(("Chunk", "defined in", "used in"), rows)

    def identifier_index(self) -> str:
        rows = [f'<tr id="{anchor_of(word)}"><td><code>{escape(word)}</code></td>'
                f"<td>{escape(about)}</td><td>{self.numbers(defined)}</td><td>{self.numbers(used)}</td></tr>"
                for word, about, defined, used in self.identifiers]
        return table(("Identifier", "what it is", "defined in", "used in"), rows)


TEX = {"number": "digits"}  # \\litnumber is the number of a chunk
MOST_WORDS = 600  # letters of a chapter's tests on paper, a few lines; with more, only their number is printed
MOST_NOTES = 4  # uses of a chunk that are named beside its name on paper


class TexListing(Listing):
    """Chunks as LaTeX, for malus.sty. Paper has less than the site: no skeletons of files, and of some chapters only the interface.

    `printed` says in which volume a chunk is; one that it does not have is left to the site.
    """

    def __init__(self, chapters: list[noweb.Chapter], names: Sequence[Name], printed: dict[str, int]) -> None:
        super().__init__(chapters, names)
        self.printed = printed
        self.volume = 1  # the one that is being written

    def number(self, label: str) -> str:
        if self.printed.get(label) == self.volume:
            return rf"\litnumber{{{label}}}{{{self.by_label[label].number}}}"
        return str(self.by_label[label].number)

    def word(self, word: str) -> str:
        return rf"\litcode{{{noweb.quote_latex(word)}}}"

    def prose(self, words: str) -> str:
        """Words as they are."""
        return noweb.quote_latex(words).replace("-{}", "-").replace("\\textquotesingle{}", "'")

    def name(self, name: str) -> str:
        """A chunk's name; it may quote code in double brackets."""
        parts = re.split(r"\[\[(.*?)\]\]", name)
        return "".join(self.word(part) if i % 2 else self.prose(part) for i, part in enumerate(parts))

    def use(self, name: str, label: str) -> str:
        if self.printed.get(label) == self.volume:
            return rf"\lituse{{{label}}}{{{self.by_label[label].number}}}{{{self.name(name)}}}"
        return rf"\litusefar{{{self.by_label[label].number}}}{{{self.name(name)}}}"

    def identifier(self, text: str, label: str) -> str:
        if self.printed.get(label) == self.volume:
            return rf"\litidentifier{{{label}}}{{{self.plain(text)}}}"
        return self.plain(text)

    def plain(self, text: str) -> str:
        return noweb.quote_latex(text).replace(" ", "\\ ")

    def colour(self, kind: str, text: str) -> str:
        return "\n".join(rf"\lit{TEX.get(kind, kind)}{{{self.plain(line)}}}" if line else "" for line in text.split("\n"))

    def notes(self, chunk: Chunk) -> str:
        """Where a chunk leads, in a few words beside its name; what it defines is in the index, and its users on the site."""
        notes, place = [], chunk.pieces.index(chunk)
        if place > 0:
            notes.append(f"from {self.number(chunk.pieces[place - 1].label)}")
        if place + 1 < len(chunk.pieces):
            notes.append(f"on in {self.number(chunk.pieces[place + 1].label)}")
        users = [label for label in self.ordered(chunk.used_in) if label in self.printed]
        if users:
            notes.append("used in " + ", ".join(map(self.number, users[:MOST_NOTES])) + (r", \dots" if len(users) > MOST_NOTES else ""))
        return "; ".join(notes)

    def chunk(self, chunk: Chunk) -> str:
        """The definition of what \\litchunk prints."""
        again = "+" if chunk.pieces[0] is not chunk else ""
        if chunk.label not in self.printed:
            return rf"\litdefine{{{chunk.label}}}{{\litleft{{{chunk.number}}}{{{self.name(chunk.name)}}}{{{again}}}}}" "\n"
        lines = [rf"\litline{{{line}}}" for line in self.code(chunk).split("\n")]
        if len(lines) > WHOLE:
            lines[2:-3] = [line + r"\litbreak" for line in lines[2:-3]]
        shown = re.sub("\x01(\\d+)\x02", lambda use: chunk.used_chunks[int(use[1])][0] + " 1234", chunk.text)
        widest = max(map(len, shown.split("\n")))
        code = "\n".join(lines)
        head = rf"\litname{{{chunk.label}}}{{{chunk.number}}}{{{self.name(chunk.name)}}}{{{again}}}{{{self.notes(chunk)}}}"
        return rf"\litdefine{{{chunk.label}}}{{{head}%" "\n" rf"\litcodelines{{{widest}}}{{{code}}}}}" "\n"

    def tests(self, tests: Sequence[tested.Test], wording: tested.Wording) -> str:
        """The tests of a chapter: their files and numbers, and their names by kind, if these fill no more than a few lines."""
        def of(kind: str) -> str:
            names = [wording.words(test) + (f" ({test.control})" if test.control else "") for test in tests if test.kind == kind]
            head = rf"\emph{{{tested.PLURALS.get(kind, kind).capitalize()}:}} " if kind else ""
            return head + self.prose("; ".join(names)) + "." if names else ""
        files = " ".join(rf"{self.word(file.path)}, {tested.summary(own)}." for file, own in tested.by_file(tests))
        names = " ".join(filter(None, map(of, dict.fromkeys(["", *tested.KINDS.values()]))))
        return rf"\littests{{{files}}}{{{names if len(names) < MOST_WORDS else ''}}}"

    def identifier_index(self) -> str:
        """Where each identifier of both volumes is defined, by volume and page; those of the site alone are not listed."""
        entries = []
        for word, _, defined, _ in self.identifiers:
            if places := [label for label in self.ordered(defined) if label in self.printed]:
                pages = ", ".join(rf"\litpage{{{self.printed[label]}}}{{{label}}}" for label in places)
                entries.append(rf"\litidentifierentry{{{noweb.quote_latex(word)}}}{{{pages}}}")
        return "\n".join(entries)


def table(head: Iterable[str], rows: Iterable[str]) -> str:
    cells = "".join(f'<th scope="col">{title}</th>' for title in head)
    body = "\n".join(rows)
    return f'<div class="index-scroll"><table class="index">\n<thead><tr>{cells}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table></div>'
