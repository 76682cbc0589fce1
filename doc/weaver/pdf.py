#!/usr/bin/python3
"""Weave the chapters of the book to two PDFs, one a volume, by LuaLaTeX.

    pdf.py --out FILE.pdf --work DIR --book DIR --report DIR --bibliography FILE.bib CHAPTER...

The volumes are FILE-1.pdf and FILE-2.pdf. A volume has the numbers and pages of
the other from what LaTeX wrote of that (far-1.tex, far-2.tex).

The second renderer of the weaver: book.py reads the chapters and checks what
they refer to, listing.py writes their chunks as LaTeX, and doc/book/malus.sty
says how all of it looks. The chapters keep their lines, so a message of LaTeX is reported with the line of the chapter.
The pages must be good as well: a
line that sticks out by more than 2 pt, a reference to nothing or a character
that the fonts lack stops the book.
"""
import argparse
import concurrent.futures
import functools
import glob
import os
import re
import shutil
import subprocess

import book
import listing
import references
from problems import Problem, stop_if_any

RUNS = 6  # LaTeX is run until its references stay as they are; more runs than this means that they never will
NEWLABEL = re.compile(r"^\\newlabel\{([^}]*)\}\{\{((?:[^{}]|\{[^{}]*\})*)\}\{([^}]*)\}\{.*\}\{([^{}]*)\}\{\}\}$", re.MULTILINE)
MARK = "malus-source: "
FIGURE = re.compile(r"\\litfigure\{([^}]*)\}")
TESTED = re.compile(r"(?ms)^\\section\{How it is tested\}.*?(?=^\\section|\Z)")
WRONG = re.compile(r"Overfull \\[hv]box \(([\d.]+)pt too|^LaTeX Warning: (?:Reference|Citation|Hyper reference) .*"
                   r"|^LaTeX Warning: Label .* multiply defined|^Missing character: .*|^! .*"
                   r"|^pdfTeX warning.*|^Package hyperref Warning: .*|^LaTeX Font Warning: .*undefined")
LINES = re.compile(r"at lines? (\d+)|on input line (\d+)")


def to_pdf(source: str, target: str) -> tuple[str, float]:
    """A figure for LuaLaTeX: SVG becomes PDF, a picture stays as it is. Returns the name and the width in points."""
    os.makedirs(os.path.dirname(target), exist_ok=True)
    if source.endswith(".png"):
        shutil.copyfile(source, target + ".png")
        with open(source, "rb") as file:
            width = int.from_bytes(file.read(24)[16:20], "big") * 0.75
        return target + ".png", width
    target += ".pdf"
    if not os.path.exists(target) or os.path.getmtime(target) < os.path.getmtime(source):
        done = subprocess.run(["rsvg-convert", "--format=pdf", "--dpi-x=96", "--dpi-y=96", f"--output={target}", source],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            raise Problem(source, 0, done.stderr.strip())
    with open(source, encoding="utf-8") as file:
        box = re.search(r'viewBox="\s*[\d.]+\s+[\d.]+\s+([\d.]+)', file.read(2000))
    return target, float(box[1]) * 0.75 if box else 360


class PdfBook(book.Book):
    """The book as LaTeX, two volumes that refer to each other."""

    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__(options)
        self.work = options.work
        self.printed: dict[str, int] = {}  # chunk -> volume
        self.homes: dict[str, int] = {}  # label -> volume
        os.makedirs(self.work, exist_ok=True)

    def put(self, name: str, text: str) -> None:
        """Writes a file of LaTeX, if it changed."""
        path = os.path.join(self.work, name)
        if os.path.exists(path) and self.read(path) == text:
            return
        with open(path, "w", encoding="utf-8") as new:
            new.write(text)

    def volumes(self) -> list[int]:
        """Those that have pages."""
        return sorted({page.volume for page in self.pages()})

    def chapter_link(self, label: str, page: book.Page) -> str:
        title = re.search(r"\\chapter\*?\{((?:[^{}]|\{[^{}]*\})*)\}", page.latex)
        return super().chapter_link(label, page) + (rf", \emph{{{title[1]}}}" if title else "")

    def write(self) -> None:
        """All files that LuaLaTeX reads."""
        self.links.check(self.pages())
        bibliography = self.links.bibliography_page()
        for page in self.pages() + [bibliography]:
            self.substitute(page)
        figures = self.figures()
        self.choose_chunks()
        self.homes = {label: page.volume for page in self.pages() for label in book.LABEL.findall(page.latex)}
        listings = listing.TexListing(self.chapters, self.names, self.printed)
        for page in self.pages():
            latex = FIGURE.sub(functools.partial(self.figure, page, figures), self.with_tests(page, listings))
            latex = self.without_far_links(latex.replace(r"\chapter*{", r"\addchap{", 1), page.volume)
            self.put(page.name + ".tex", rf"\typeout{{{MARK}{page.source}}}" + latex)
        naturals = "".join(rf"\litnatural{{{name}}}{{{width:.1f}bp}}" "\n" for name, width in figures.values())
        for volume in self.volumes():
            listings.volume = volume
            chunks = [chunk for page in self.pages() if page.volume == volume for chunk in page.chunks]
            self.put(f"chunks-{volume}.tex", "".join(map(listings.chunk, chunks)) + naturals)
            self.put(f"bibliography-{volume}.tex", self.entries(volume))
            self.put(f"malus-{volume}.tex", self.frame(volume))
        self.put("identifiers.tex", listings.identifier_index())
        shutil.copyfile(os.path.join(self.options.book, "malus.sty"), os.path.join(self.work, "malus.sty"))

    def with_tests(self, page: book.Page, listings: listing.TexListing) -> str:
        """A page with its tests at the end of the section about them, or of the chapter; line for line."""
        if not page.tests:
            return page.latex
        table = listings.tests(page.tests, self.wording)
        section = TESTED.search(page.latex)
        end = section.end() if section else len(page.latex)
        return page.latex[:end].rstrip(" ") + table + page.latex[end:]

    def choose_chunks(self) -> None:
        """Paper leaves the frames of files to the site, and of a part of reference all but the interface."""
        parts = {page: part for part in self.parts for page in part.pages}
        for page in self.pages():
            only = listing.interface(page.chunks) if page in parts and parts[page].code == "interface" else None
            for chunk in page.chunks:
                if not listing.is_skeleton(chunk) and (only is None or chunk.label in only):
                    self.printed[chunk.label] = page.volume

    def without_far_links(self, latex: str, volume: int) -> str:
        """The references of a page to the other volume, by number; line for line."""
        def far(label: str) -> bool:
            return self.homes.get(label, volume) != volume

        def named(match: re.Match[str]) -> str:
            word, space, kind, label = match.groups()
            if not far(label):
                return match[0]
            number = rf"(\litfar{{{label}}})" if kind else rf"\litfar{{{label}}}"
            return f"{'Volume' if word[0].isupper() else 'volume'}~{self.homes[label]}, {word.lower()}{space}{number}"

        def bare(match: re.Match[str]) -> str:
            kind, label = match.groups()
            if not far(label):
                return match[0]
            far_number = rf"\litfar{{{label}}}"
            return rf"({far_number}, volume~{self.homes[label]})" if kind else rf"{far_number} of volume~{self.homes[label]}"

        latex = re.sub(r"\b([Cc]hapter|[Ss]ection|[Ff]igure|[Tt]able|[Ee]quation)(~|\s)\\(eq)?ref\{([^}]*)\}", named, latex)
        latex = re.sub(r"\\(eq)?ref\{([^}]*)\}", bare, latex)
        return re.sub(r"\\litlink\{([^}]*)\}", lambda match: match[0] if self.printed.get(match[1]) == volume else r"\litplain", latex)

    def entries(self, volume: int) -> str:
        """The bibliography of a volume: what it cites, with the numbers of the whole book."""
        cited = [key for key in self.links.numbers if any(page.volume == volume for page in self.links.cited[key])]
        entries = [rf"\litentry{{{key}}}{{{self.links.numbers[key]}}}{{{references.latex(self.links.bibliography[key])}}}" for key in cited]
        begin = rf"\typeout{{{MARK}{self.options.bibliography}}}\begin{{thebibliography}}{{999}}"
        return "\n".join([begin, *entries, r"\end{thebibliography}"]) if cited else ""

    def figures(self) -> dict[str, tuple[str, float]]:
        """{name in the prose: (file, width)}"""
        def convert(item: tuple[str, str]) -> tuple[str, tuple[str, float]]:
            name, path = item
            file, width = to_pdf(path, os.path.join(self.work, "figures", name))
            return name, (os.path.relpath(file, self.work), width)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return dict(pool.map(convert, self.links.figures.items()))

    def figure(self, page: book.Page, files: dict[str, tuple[str, float]], place: re.Match[str]) -> str:
        """A picture; over the boxes of a drawing with links are links to what is in the same volume."""
        name, file = place[1], files[place[1]][0]
        drawing = self.links.drawing(name)
        if not drawing:
            return rf"\litfigure{{{file}}}"
        box = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)', drawing)
        if not box:
            raise Problem(name, 0, "a drawing with links needs a viewBox that begins at 0 0")
        width, height = map(float, box.groups())
        boxes = "".join(rf"\litbox{{{x}}}{{{height - float(y) - float(h):g}}}{{{w}}}{{{h}}}{{{label}}}"
                        for label, x, y, w, h in book.DRAWN_LINK.findall(drawing) if self.homes.get(label) == page.volume)
        return rf"\litdrawing{{{file}}}{{{width:g}}}{{{height:g}}}{{{boxes}}}"

    def frame(self, volume: int) -> str:
        """A volume: what is before, between and after the chapters."""
        about = self.about
        after = re.sub(r"<cite>(.*?)</cite>", r"\\emph{\1}", about["after"])
        plain = re.sub(r"<[^>]*>", "", about["after"])
        this = next(each for each in self.contents.volumes if each.number == volume)
        earlier = [page for page in self.pages() if page.volume < volume]
        out = [r"\documentclass[10pt,open=any,numbers=noenddot,bibliography=totoc]{scrbook}", r"\usepackage{malus}",
               rf"\hypersetup{{pdftitle={{{about['title']} {volume}: {this.title}}},pdfsubject={{{plain}}},"
               r"pdfauthor={The malus authors},pdfkeywords={polarimetry, BRDF, Stokes, Mueller, DIRSIG, literate programming},"
               r"pdflang=en,pdfdisplaydoctitle}",
               r"\pdfvariable suppressoptionalinfo \numexpr 32+64+512\relax",  # no dates: the same book, the same file
               rf"\litvolume{{{volume}}}\InputIfFileExists{{far-{volume}}}{{}}{{}}\input{{chunks-{volume}}}",
               r"\begin{document}", r"\frontmatter",
               rf"\title{{{this.title}}}\subtitle{{{about['title']}, volume {volume}\\\normalsize {about['subtitle']}}}"
               rf"\author{{}}\date{{}}\publishers{{\normalsize {after}}}",
               r"\maketitle", r"\tableofcontents"]
        if this.run_in:
            out.insert(2, r"\litrunin")
        started = False
        for page in self.front if volume == 1 else []:
            if page.chapter and not started:
                out.append(r"\mainmatter")
                started = True
            out.append(rf"\input{{{page.name}}}")
        if not started:
            out.append(r"\mainmatter")
        # chapters are numbered through both volumes, as on the site
        out.append(rf"\setcounter{{chapter}}{{{max((page.chapter for page in earlier or self.front), default=0)}}}")
        out.append(rf"\setcounter{{part}}{{{sum(part.volume < volume for part in self.parts)}}}")
        for part in self.parts:
            if part.volume == volume:
                says = part.about + (f" {about['interface']}" if part.code == "interface" else "")
                out.append(rf"\litpart{{{part.title}}}{{{says}}}")
                out += [rf"\input{{{page.name}}}" for page in part.pages]
        out += [r"\backmatter", *(rf"\input{{{page.name}}}" for page in self.back if volume == 1), rf"\input{{bibliography-{volume}}}"]
        if volume == self.volumes()[-1]:
            out += [rf"\typeout{{{MARK}index of identifiers}}\addchap{{Identifiers of both volumes}}\begin{{litindex}}",
                    r"\input{identifiers}", r"\end{litindex}"]
        return "\n".join(out + [r"\end{document}", ""])

    def run(self) -> None:
        """LuaLaTeX until the references of both volumes, also to each other, stay as they are."""
        before: list[str] | None = None
        for _ in range(RUNS):
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                for _ in pool.map(self.run_once, self.volumes()):
                    pass
            for volume in self.volumes():
                self.put(f"far-{volume}.tex", self.far_numbers(volume))
            now = [self.read(path) for path in sorted(glob.glob(os.path.join(self.work, "malus-?.[ato][uo][xct]")))]
            if now == before:
                self.complain()
                return
            before = now
        raise Problem("malus.tex", 0, f"LuaLaTeX's references still move after {RUNS} runs")

    def run_once(self, volume: int) -> None:
        """One run over one volume."""
        environment = dict(os.environ, TEXMFVAR=os.path.abspath(os.path.join(self.work, f"texmf-var-{volume}")),
                           max_print_line="1000", openout_any="p")
        command = ["lualatex", "--interaction=nonstopmode", "--halt-on-error", "--file-line-error", f"malus-{volume}.tex"]
        done = subprocess.run(command, cwd=self.work, env=environment, capture_output=True, text=True, errors="replace", check=False)
        self.complain(errors_only=True)
        if done.returncode:
            raise Problem(f"malus-{volume}.tex", 0, done.stdout[-2000:])

    def far_numbers(self, volume: int) -> str:
        """The numbers, pages and places of the other volume's labels."""
        lines = []
        for other in self.volumes():
            path = os.path.join(self.work, f"malus-{other}.aux")
            if other != volume and os.path.exists(path):
                for label, number, page, place in NEWLABEL.findall(self.read(path)):
                    lines.append(rf"\litfardefine{{{label}}}{{{number}}}{{{page}}}{{{place}}}{{{other}}}")
        return "\n".join(lines) + "\n"

    @staticmethod
    def read(path: str) -> str:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()

    def pages_of(self, volume: int) -> int:
        """How many pages a volume has."""
        said = re.findall(r"Output written on .* \((\d+) pages", self.read(os.path.join(self.work, f"malus-{volume}.log")))
        return int(said[-1])

    def check_lengths(self) -> None:
        """Prints how long the volumes are; one that is too long stops the book."""
        for volume in self.contents.volumes:
            if volume.number in self.volumes():
                pages = self.pages_of(volume.number)
                print(f"volume {volume.number}: {pages} pages" + (f" of at most {volume.most_pages}" if volume.most_pages else ""))
                if 0 < volume.most_pages < pages:
                    raise Problem(self.contents.path, 0, f"volume {volume.number} has {pages} pages, but at most "
                                  f"{volume.most_pages} are allowed")

    def complain(self, errors_only: bool = False) -> None:
        """The problems in LuaLaTeX's log, with the chapter and the line."""
        problems: list[Problem] = []
        source = ""
        sources = {page.name: page.source for page in self.pages()}
        logs = [os.path.join(self.work, f"malus-{volume}.log") for volume in self.volumes()]
        lines = [line for path in logs if os.path.exists(path) for line in [MARK + os.path.basename(path), *self.read(path).splitlines()]]
        for line in lines:
            if line.startswith(MARK):
                source = line[len(MARK):]
            if error := re.match(r"(?:\./)?([\w-]+)\.(?:tex|sty):(\d+): (.*)", line):
                problems.append(Problem(sources.get(error[1], error[1] + ".tex"), int(error[2]), f"LaTeX: {error[3]}"))
            elif not errors_only and (wrong := WRONG.search(line)) and not (wrong[1] and float(wrong[1]) <= 2):
                at = LINES.search(line)
                problems.append(Problem(source, int(at[1] or at[2]) if at else 0, f"LaTeX: {line}"))
        stop_if_any(problems)


def main(options: argparse.Namespace) -> None:
    whole = PdfBook(options)
    whole.gather()
    whole.write()
    whole.run()
    whole.check_lengths()
    stem, ending = os.path.splitext(options.out)
    for volume in whole.volumes():
        shutil.copyfile(os.path.join(options.work, f"malus-{volume}.pdf"), f"{stem}-{volume}{ending}")


if __name__ == "__main__":
    book.run(__doc__, main)
