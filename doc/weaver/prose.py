#!/usr/bin/python3
"""Count the mannerisms of English that an editor would change.

    prose.py [--list PATTERN] [--chapters] FILE...

Reads the prose of chapters (not their code, equations or citations), the messages and
the comments in their code, and the prose, comments and strings of README files and
Python. Prints one line for each pattern and the files with the most hits for their
length. --list prints each hit of one pattern as file:line and the sentence, --chapters
a line for every file. An editor decides what to change: the exit code is 0.
"""
import argparse
import collections
import io
import re
import sys
import tokenize
from collections.abc import Iterator

# a person before the verb makes it right
PEOPLE = "to not one we We you You who they nobody anyone user users reader readers thesis Meyers author"
PERSONAL = "".join(rf"(?<!\b{who} )" for who in PEOPLE.split())
FINITE = r"(?:is|are|was|were|has|have|had|does|do|did|can|may|must|would|will|could|should|needs?|depends?|gives?|takes?|holds?|makes?)"

# name, what an editor writes instead, what to search in a sentence
PATTERNS = [
    ("stand", "is, are", r"\b(?:stands?|stood|standing)\b"),
    ("ask", "evaluate, compute, query", rf"{PERSONAL}\b(?:ask|asks|asked|asking)\b"),
    ("answer", "return, result", rf"{PERSONAL}\banswer(?:s|ed)?\b"),
    ("know", "has, stores", rf"{PERSONAL}\bknows?\b"),
    ("want", "needs, takes", rf"{PERSONAL}\bwant(?:s|ed)?\b"),
    ("mind", "a verb for things", PERSONAL + r"\b(?:remembers?|forgets?|forgives?|cares|believes?|trusts?|promises?|wishes|hopes|obeys?"
     r"|likes to|tries to|has (?:a|no) say)\b"),
    ("for", "because", r", for (?:it|they|there|we|he|she|this|that|these|then|nothing|none|nobody)\b"
     rf"|, for (?:the|an?|its|their|no|all|both|every|each) (?:[\w-]+ ){{1,4}}{FINITE}\b"),
    ("own", "its own, separate", r"\bof (?:its|their|his|her|our|one's|your) own\b"),
    ("told", "reported, described", r"\b(?:told|tells?)\b"),
    ("is no", "is not a", r"(?<!here )\b(?:is|are|was|were) no (?!longer|more\b|less\b|better|worse|greater|larger|smaller|fewer|one\b)\w+"),
    ("who", "anyone who; name the person", r"\b[Ww]hoever\b|(?:^|[.;:] )Who (?!\w+.*\?$)"),
    ("mend", "fix", r"\b[Mm]end(?:s|ed|ing)?\b"),
    ("one way", "specify exactly one of", r"\bin one way\b"),
    ("what", "a noun", r"^What (?!.*\?)"),
    ("that", "a noun", r"^That (?:[\w-]+ ){2,9}(?:is|are|was|were|does|do|has|must|holds)\b(?!.*\?)"),
    ("to be", "must be, we + verb", r"\b(?:is|are) to be (?!a\b|the\b)\w+"),
    ("besides", "also, in addition", r"\bbesides\b(?! [a-z]+ing\b)"),
    ("save", "except", r"\bsave (?:that|for|the|at|where|when)\b"),
    ("question", "the statement", r"\w\?$"),
    ("long", "two sentences", r"^(?:\S+ ){45,}\S+$"),
]
COMPILED = {name: re.compile(pattern) for name, _, pattern in PATTERNS}

# a chapter's title should have one of these stems
TERMS = re.compile(
    r"aerosol|air\b|albedo|angle|atmospher|band|BRDF|BSDF|calibrat|camera|cloud|command|convention|cube|diffuse|direction|distortion|errata"
    r"|error|figure|file|format"
    r"|Fresnel|gas|geometr|geotiff|grammar|hemispher|illuminat|image|input|inventory|Lambert|layer|leaf|leaves|lens|librar"
    r"|light|MPI|material|matri|mesh|metal|microfacet|Mie|model|Mueller|netcdf|noise|OpenEXR|optical|parallel|parameter|particle|path|pixel"
    r"|point|polari|program|Python|quadrature|radian|radiat|radiometr|random|Rayleigh|ray\b|rays\b|reflect|refract|registr|render|sampl|scatter"
    r"|scene|schema|section|sensor|sequence|sky|skies|slope|solar|spectr|spline|Stokes|sun\b|surface|table|temperature|terrain|test|thermal"
    r"|thread|tile|transmi|triangle|unit|vector|vegetation|water|wavelength|weather", re.IGNORECASE)

Place = tuple[str, int, str]  # kind (prose, message, comment), line, sentence

COMMANDS = re.compile(r"\\(?:label|ref|eqref|cite|val|includegraphics|tag|input)(?:\[[^]]*\])?\{[^}]*\}"
                      r"|\\(?:begin|end)\{[^}]*\}(?:\[[^]]*\])?")
ENDS = re.compile(r"(?<=[.?!])(?<!e\.g\.)(?<!i\.e\.)(?<!eq\.)(?<!sec\.)(?<!fig\.)(?<!p\.)[)'\"]*\s+(?=[A-Z\\$(`\[])")


def sentences(kind: str, lines: list[tuple[int, str]]) -> Iterator[Place]:
    """The sentences of a paragraph, each with the line on which it begins."""
    text, starts = "", []
    for number, line in lines:
        starts.append((len(text), number))
        text += line.strip() + " "
    begin = 0
    for end in [match.end() for match in ENDS.finditer(text)] + [len(text)]:
        sentence = " ".join(text[begin:end].split())
        if re.search(r"[A-Za-z]{2}", sentence):
            yield kind, max((n for at, n in starts if at <= begin), default=1), sentence
        begin = end


def plain(latex: str) -> str:
    """Prose without the machinery of LaTeX; what is no English becomes X."""
    latex = re.sub(r"(?<!\\)%.*", "", latex)
    latex = re.sub(r"\[\[.*?\]\]+|\$[^$]*\$|\\\(.*?\\\)", "X", latex)
    latex = COMMANDS.sub("X", latex)
    return re.sub(r"\\(?:emph|textbf|texttt|textit|footnote|caption|paragraph|section\*?|subsection|chapter\*?)\{|[{}~]|\\[a-z]+\b", " ", latex)


SKIPPED = re.compile(r"\\begin\{(equation|align|eqnarray|tabular|verbatim|alltt|gather|multline|lstlisting)\*?\}")


def prose_lines(lines: list[tuple[int, str]]) -> Iterator[list[tuple[int, str]]]:
    """Paragraphs of LaTeX without displayed equations and tables; headings and items are paragraphs."""
    skip = ""
    paragraph: list[tuple[int, str]] = []
    for number, line in lines:
        if skip:
            if re.search(rf"\\end\{{{skip}\*?\}}", line):
                skip = ""
            continue
        if started := SKIPPED.search(line):
            if not re.search(rf"\\end\{{{started[1]}\*?\}}", line):
                skip = started[1]
            continue
        if paragraph and (not line.strip() or re.match(r"\s*\\(item|section|subsection|chapter|paragraph|caption|begin|end)", line)):
            yield paragraph
            paragraph = []
        if line.strip():
            paragraph.append((number, re.sub(r"^\s*\\item\b", "", line)))
        if paragraph and re.match(r"\s*\\(?:sub)*(?:section|chapter)\*?\{.*\}\s*(?:\\label\{[^}]*\})?$", line):
            yield paragraph
            paragraph = []
    yield paragraph


def latex_places(lines: list[tuple[int, str]]) -> Iterator[Place]:
    for paragraph in prose_lines(lines):
        # a formula may go over the end of a line
        joined = plain("\n".join(line for _, line in paragraph)).split("\n")
        numbers = [number for number, _ in paragraph]
        if len(joined) == len(numbers):
            yield from sentences("prose", list(zip(numbers, joined)))
        elif numbers:
            yield from sentences("prose", [(numbers[0], " ".join(joined))])


LITERAL = re.compile(r'R"(\w*)\((.*?)\)\1"|"((?:[^"\\\n]|\\.)*)"|//[/!]?<?([^\n]*)', re.DOTALL)


def code_places(lines: list[tuple[int, str]]) -> Iterator[Place]:
    """Messages (strings of three words and more, joined when they follow each other) and comments of a piece of C++."""
    text = "\n".join(line for _, line in lines)
    first = lines[0][0] if lines else 1
    run: list[tuple[int, str]] = []
    kind, last = "", 0

    def flush() -> Iterator[Place]:
        if kind == "comment" or len(" ".join(part for _, part in run).split()) > 2:
            yield from sentences(kind, run)
        run.clear()

    for match in LITERAL.finditer(text):
        this = "comment" if match[4] is not None else "message"
        if run and (this != kind or text[last:match.start()].strip()):
            yield from flush()
        kind, last = this, match.end()
        body = match[2] if match[2] is not None else match[3] if match[3] is not None else match[4]
        number = first + text[:match.start()].count("\n")
        run += [(number + i, part.replace("\\n", " ")) for i, part in enumerate(body.split("\n"))]
    yield from flush()


def chapter_places(text: str) -> Iterator[Place]:
    code = False
    block: list[tuple[int, str]] = []
    for number, line in enumerate(text.split("\n"), 1):
        opens, closes = not code and re.match(r"<<.*>>=\s*$", line), code and re.match(r"@(\s|$)", line)
        if opens or closes:
            yield from (code_places if code else latex_places)(block)
            code, block = bool(opens), []
        else:
            block.append((number, line))
    yield from (code_places if code else latex_places)(block)


def markdown_places(text: str) -> Iterator[Place]:
    paragraph: list[tuple[int, str]] = []
    fenced = False
    for number, line in enumerate(text.split("\n") + [""], 1):
        fenced ^= line.startswith("```")
        ends = not line.strip() or re.match(r"[#|*-]|\d+\. |```|    ", line)
        if ends:
            yield from sentences("prose", paragraph)
            paragraph = []
        if line.strip() and not fenced and not line.startswith(("    ", "```")):
            paragraph.append((number, re.sub(r"`[^`]*`|\]\([^)]*\)", "X", line.lstrip("#*-| "))))


def python_places(text: str) -> Iterator[Place]:
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        words = token.string.strip("#\"'rbfRF\n ")
        if token.type == tokenize.COMMENT and not token.string.startswith("#!"):
            yield from sentences("comment", [(token.start[0], words)])
        elif token.type == tokenize.STRING and len(words.split()) > 2:
            paragraph: list[tuple[int, str]] = []
            for i, line in enumerate(words.split("\n") + [""]):
                if line.strip():
                    paragraph.append((token.start[0] + i, line))
                elif paragraph:
                    yield from sentences("comment" if '"""' in token.string else "message", paragraph)
                    paragraph = []


def places(path: str) -> list[Place]:
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if path.endswith(".nw"):
        return list(chapter_places(text))
    if path.endswith(".tex"):
        return list(latex_places(list(enumerate(text.split("\n"), 1))))
    return list((python_places if path.endswith(".py") else markdown_places)(text))


def title_hits(path: str) -> list[Place]:
    """The title of a chapter, if it has no term of the field."""
    if not path.endswith(".nw"):
        return []
    with open(path, encoding="utf-8") as file:
        found = [(n, m[1]) for n, line in enumerate(file, 1) if (m := re.match(r"\\chapter\{(.*)\}", line))]
    return [("prose", n, title) for n, title in found[:1] if not TERMS.search(title)]


def hits(path: str) -> tuple[dict[str, list[Place]], int]:
    """The hits of each pattern in a file, and how many words were searched."""
    found = places(path)
    out = {name: [place for place in found for _ in pattern.finditer(place[2])] for name, pattern in COMPILED.items()}
    out["title"] = title_hits(path)
    return out, sum(len(sentence.split()) for _, _, sentence in found)


def table(found: dict[str, dict[str, list[Place]]], words: dict[str, int], everything: bool) -> None:
    better = {name: instead for name, instead, _ in PATTERNS} | {"title": "a title with the field's term"}
    print(f"{'pattern':10}{'prose':>7}{'messages':>10}{'comments':>10}   better")
    totals: collections.Counter[str] = collections.Counter()
    for name, instead in better.items():
        kinds = collections.Counter(kind for file in found.values() for kind, _, _ in file[name])
        totals.update(kinds)
        print(f"{name:10}{kinds['prose']:7}{kinds['message']:10}{kinds['comment']:10}   {instead}")
    print(f"{'all':10}{totals['prose']:7}{totals['message']:10}{totals['comment']:10}   in {sum(words.values())} words")
    counts = {path: sum(map(len, file.values())) for path, file in found.items()}
    order = sorted(counts, key=lambda path: -counts[path] / max(words[path], 1))
    print("most for their length (hits a thousand words):" if not everything else "hits a thousand words:")
    for path in order if everything else [path for path in order if words[path] >= 300][:10]:
        worst = collections.Counter({name: len(found[path][name]) for name in better if found[path][name]}).most_common(20 if everything else 4)
        print(f"{1000 * counts[path] / max(words[path], 1):5.1f} {path}: {', '.join(f'{count} {name}' for name, count in worst)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", metavar="PATTERN", choices=[*COMPILED, "title", "all"], help="print the hits of one pattern, or all")
    parser.add_argument("--chapters", action="store_true", help="print a line for every file")
    parser.add_argument("files", nargs="+")
    given = parser.parse_args()
    found, words = {}, {}
    for path in given.files:
        found[path], words[path] = hits(path)
    if not given.list:
        table(found, words, given.chapters)
        return
    for path, file in found.items():
        names = list(file) if given.list == "all" else [given.list]
        for line, name, sentence in sorted((line, name, sentence) for name in names for _, line, sentence in file[name]):
            print(f"{path}:{line}: {name + ': ' if given.list == 'all' else ''}{sentence}")


if __name__ == "__main__":
    try:
        main()
    except BrokenPipeError:
        sys.stderr.close()
