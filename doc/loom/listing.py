"""Chunks as HTML: coloured C++, links to what is used, and below each chunk where it leads.

Links are written as chunk:LABEL; the weaver knows on which page a label is
and puts the address in when it lays out the pages.
"""
import re
from html import escape

import noweb

KEYWORDS = frozenset("""
alignas alignof auto bool break case catch char class concept const consteval constexpr constinit const_cast continue
decltype default delete do double dynamic_cast else enum explicit export extern false final float for friend goto if
inline int long mutable namespace new noexcept nullptr operator override private protected public reinterpret_cast
requires return short signed sizeof static static_assert static_cast struct switch template this throw true try typedef
typeid typename union unsigned using virtual void volatile while""".split())

TOKEN = re.compile(
    r"""(?P<use>\x01\d+\x02)
      | (?P<comment>//[^\n\x01]*|/\*.*?\*/)
      | (?P<directive>^[ ]*\#[ ]*\w+)
      | (?P<string>R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n\x01])*"|'(?:\\.|[^'\\\n\x01])+'|(?<=\#include[ ])<[^>\n]*>)
      | (?P<number>\b\d(?:[\w.]|'(?=\w)|(?<=[eEpP])[+-])*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<other>\s+|.)""", re.VERBOSE | re.MULTILINE | re.DOTALL)


MOST = 8  # uses of an identifier that are listed below its definition; the index lists all


def anchor_of(word):
    """A place in the index; letters, digits and underscores stay, others (operators) become their codes."""
    return "id-" + re.sub(r"\W", lambda match: f".{ord(match[0]):x}", word)


def name_html(name):
    """A chunk's name; it may quote code in double brackets."""
    parts = re.split(r"\[\[(.*?)\]\]", name)
    return "".join(f"<code>{escape(part)}</code>" if i % 2 else escape(part) for i, part in enumerate(parts))


class Listing:
    """Renders the chunks of a book."""

    def __init__(self, chapters):
        self.chunks = [chunk for chapter in chapters for chunk in chapter.chunks]
        self.by_label = {chunk.label: chunk for chunk in self.chunks}

    def number(self, label):
        chunk = self.by_label[label]
        place = escape(f"{noweb.plain(chunk.name)}, {chunk.chapter.path}", quote=True)
        return f'<a href="chunk:{label}" title="{place}">{chunk.number}</a>'

    def numbers(self, labels, most=None, rest=""):
        """Links in the order of the book; if there are more than most, the others are one link to rest."""
        unique = sorted(set(labels), key=lambda label: self.by_label[label].number)
        shown = unique if most is None or len(unique) <= most + 1 else unique[:most]
        out = ", ".join(self.number(label) for label in shown)
        more = len(unique) - len(shown)
        return f'{out} and <a href="{rest}">{more} more</a>' if more else out

    def use(self, chunk, token):
        name, label = chunk.used_chunks[int(token[1:-1])]
        number = self.by_label[label].number
        return f'<a class="use" href="chunk:{label}">⟨{name_html(name)} <span class="chunk-number">{number}</span>⟩</a>'

    def code(self, chunk):
        out = []
        for match in TOKEN.finditer(chunk.text):
            kind, text = match.lastgroup, match[0]
            if kind == "use":
                out.append(self.use(chunk, text))
            elif kind == "word" and text in chunk.links:
                label = chunk.links[text]
                target = self.by_label[label]
                title = f"defined in chunk {target.number}, {target.chapter.path}"
                out.append(f'<a class="identifier" href="chunk:{label}" title="{escape(title)}">{text}</a>')
            elif kind == "word" and text in KEYWORDS:
                out.append(f'<span class="keyword">{text}</span>')
            elif kind in ("word", "other"):
                out.append(escape(text, quote=False))
            else:
                out.append(f'<span class="{kind}">{escape(text, quote=False)}</span>')
        return "".join(out)

    def foot(self, chunk):
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
            where = f", used in {self.numbers(others, MOST, f'identifiers.html#{anchor_of(word)}')}" if others else ""
            notes.append(f"Defines <code>{escape(word)}</code>{where}")
        return ". ".join(notes) + "."

    def chunk(self, chunk, anchor):
        again = "+" if chunk.pieces[0] is not chunk else ""
        return (f'<div class="chunk" id="{anchor}">\n'
                f'<p class="chunk-name"><a class="chunk-number" href="#{anchor}">{chunk.number}</a>'
                f'⟨{name_html(chunk.name)}⟩<span class="defines">{again}≡</span></p>\n'
                f'<pre><code>{self.code(chunk)}</code></pre>\n'
                f'<p class="chunk-foot">{self.foot(chunk)}</p>\n</div>')

    def chunk_index(self):
        firsts = [chunk for chunk in self.chunks if chunk.pieces[0] is chunk]
        firsts.sort(key=lambda chunk: noweb.plain(chunk.name).lower())
        rows = [f'<tr><td>⟨{name_html(chunk.name)}⟩</td>'
                f'<td>{self.numbers(piece.label for piece in chunk.pieces)}</td>'
                f'<td>{self.numbers(chunk.used_in) or "a file"}</td></tr>' for chunk in firsts]
        return table(("Chunk", "defined in", "used in"), rows)

    def identifier_index(self):
        defined, used = {}, {}
        for chunk in self.chunks:
            for word, users in chunk.defines:
                defined.setdefault(word, set()).add(chunk.label)
                used.setdefault(word, set()).update(users)
        rows = [f'<tr id="{anchor_of(word)}"><td><code>{escape(word)}</code></td>'
                f"<td>{self.numbers(defined[word])}</td><td>{self.numbers(used[word] - defined[word])}</td></tr>"
                for word in sorted(defined, key=lambda word: (word.lower(), word))]
        return table(("Identifier", "defined in", "used in"), rows)


def table(head, rows):
    cells = "".join(f'<th scope="col">{title}</th>' for title in head)
    body = "\n".join(rows)
    return f'<table class="index">\n<thead><tr>{cells}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>'
