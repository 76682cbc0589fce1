#!/usr/bin/python3
"""Weave the chapters of the book to one PDF, by LuaLaTeX.

    pdf.py --out FILE.pdf --work DIR --book DIR --report DIR --bibliography FILE.bib CHAPTER...

The second renderer of the weaver: book.py reads the chapters and checks what
they refer to, listing.py writes their chunks as LaTeX, and doc/book/malus.sty
says how all of it looks. The chapters keep their lines, so a complaint of
LaTeX is told with the line of the chapter. The pages must be good as well: a
line that sticks out by more than 2 pt, a reference to nothing or a character
that the fonts lack stops the book.
"""
import argparse
import concurrent.futures
import glob
import os
import re
import shutil
import subprocess

import book
import listing
from problems import Problem, stop_if_any

RUNS = 5  # LaTeX is run until its references stand still; more runs than this means that they never will
MARK = "malus-source: "
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
    """The book as LaTeX."""

    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__(options)
        self.listings = listing.TexListing(self.chapters, self.names)
        self.work = options.work
        os.makedirs(self.work, exist_ok=True)

    def put(self, name: str, text: str) -> None:
        """Writes a file of LaTeX, if it changed."""
        path = os.path.join(self.work, name)
        if os.path.exists(path):
            with open(path, encoding="utf-8") as old:
                if old.read() == text:
                    return
        with open(path, "w", encoding="utf-8") as new:
            new.write(text)

    def write(self) -> None:
        """All files that LuaLaTeX reads."""
        self.links.check(self.pages())
        bibliography = self.links.bibliography_page()
        for page in self.pages() + [bibliography]:
            self.substitute(page)
        figures = self.figures()
        for page in self.pages():
            latex = re.sub(r"\\litfigure\{([^}]*)\}", lambda match: self.figure(match[1], figures[match[1]][0]), page.latex)
            latex = latex.replace(r"\chapter*{", r"\addchap{", 1)
            self.put(page.name + ".tex", rf"\typeout{{{MARK}{page.source}}}" + latex)
        self.put("chunks.tex", "".join(self.listings.chunk(chunk) for chapter in self.chapters for chunk in chapter.chunks)
                 + "".join(rf"\litnatural{{{name}}}{{{width:.1f}bp}}" "\n" for name, width in figures.values()))
        self.put("bibliography.tex", rf"\typeout{{{MARK}{bibliography.source}}}" r"\begin{thebibliography}{99}"
                 + re.sub(r"^\\chapter\*\{.*\}", "", bibliography.latex) + r"\end{thebibliography}")
        self.put("malus.tex", self.frame())
        shutil.copyfile(os.path.join(self.options.book, "malus.sty"), os.path.join(self.work, "malus.sty"))

    def figures(self) -> dict[str, tuple[str, float]]:
        """{name in the prose: (file, width)}"""
        def convert(item: tuple[str, str]) -> tuple[str, tuple[str, float]]:
            name, path = item
            file, width = to_pdf(path, os.path.join(self.work, "figures", name))
            return name, (os.path.relpath(file, self.work), width)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return dict(pool.map(convert, self.links.figures.items()))

    def figure(self, name: str, file: str) -> str:
        """A picture; over the boxes of a drawing with links lie links."""
        drawing = self.links.drawing(name)
        if not drawing:
            return rf"\litfigure{{{file}}}"
        box = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)', drawing)
        if not box:
            raise Problem(name, 0, "a drawing with links needs a viewBox that begins at 0 0")
        width, height = map(float, box.groups())
        boxes = "".join(rf"\litbox{{{x}}}{{{height - float(y) - float(h):g}}}{{{w}}}{{{h}}}{{{label}}}"
                        for label, x, y, w, h in book.DRAWN_LINK.findall(drawing))
        return rf"\litdrawing{{{file}}}{{{width:g}}}{{{height:g}}}{{{boxes}}}"

    def frame(self) -> str:
        """The whole book: what stands before, between and after the chapters."""
        about = self.about["book"]
        after = re.sub(r"<cite>(.*?)</cite>", r"\\emph{\1}", about["after"])
        plain = re.sub(r"<[^>]*>", "", about["after"])
        out = [r"\documentclass[11pt,open=any,numbers=noenddot,bibliography=totoc]{scrbook}", r"\usepackage{malus}",
               rf"\hypersetup{{pdftitle={{{about['title']}: {about['subtitle']}}},pdfsubject={{{plain}}},"
               r"pdfauthor={The malus authors},pdfkeywords={polarimetry, BRDF, Stokes, Mueller, DIRSIG, literate programming},"
               r"pdflang=en,pdfdisplaydoctitle}",
               r"\pdfvariable suppressoptionalinfo \numexpr 32+64+512\relax",  # no dates: the same book, the same file
               r"\input{chunks}", r"\begin{document}", r"\frontmatter",
               rf"\title{{{about['title']}}}\subtitle{{{about['subtitle']}}}\author{{}}\date{{}}\publishers{{\normalsize {after}}}",
               r"\maketitle", r"\tableofcontents"]
        started = False
        for page in self.front:
            if page.chapter and not started:
                out.append(r"\mainmatter")
                started = True
            out.append(rf"\input{{{page.name}}}")
        if not started:
            out.append(r"\mainmatter")
        for part in self.parts:
            out.append(rf"\setpartpreamble[u][.7\textwidth]{{\bigskip {part.about}}}" "\n" rf"\part{{{part.title}}}")
            out += [rf"\input{{{page.name}}}" for page in part.pages]
        out += [r"\backmatter", *(rf"\input{{{page.name}}}" for page in self.back), r"\input{bibliography}",
                rf"\typeout{{{MARK}index of chunks}}\addchap{{Chunks}}\begin{{litindex}}",
                self.listings.chunk_index(), r"\end{litindex}",
                rf"\typeout{{{MARK}index of identifiers}}\addchap{{Identifiers}}\begin{{litindex}}",
                self.listings.identifier_index(), r"\end{litindex}", r"\end{document}", ""]
        return "\n".join(out)

    def run(self) -> None:
        """LuaLaTeX until the references stand still."""
        environment = dict(os.environ, TEXMFVAR=os.path.abspath(os.path.join(self.work, "texmf-var")),
                           max_print_line="1000", openout_any="p")
        command = ["lualatex", "--interaction=nonstopmode", "--halt-on-error", "--file-line-error", "malus.tex"]
        before: list[str] | None = None
        for _ in range(RUNS):
            done = subprocess.run(command, cwd=self.work, env=environment, capture_output=True, text=True, errors="replace",
                                  check=False)
            self.complain(errors_only=True)
            if done.returncode:
                raise Problem("malus.tex", 0, done.stdout[-2000:])
            now = [self.read(path) for path in sorted(glob.glob(os.path.join(self.work, "malus.[ato][uo][xct]")))]
            if now == before:
                self.complain()
                return
            before = now
        raise Problem("malus.tex", 0, f"LuaLaTeX's references still move after {RUNS} runs")

    @staticmethod
    def read(path: str) -> str:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()

    def complain(self, errors_only: bool = False) -> None:
        """What LuaLaTeX's log says is wrong, told with the chapter and the line."""
        problems: list[Problem] = []
        source = "malus.tex"
        sources = {page.name: page.source for page in self.pages()}
        for line in self.read(os.path.join(self.work, "malus.log")).splitlines():
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
    shutil.copyfile(os.path.join(options.work, "malus.pdf"), options.out)


if __name__ == "__main__":
    book.run(__doc__, main)
