r"""Three tables of the book come from the program's report: the errata of the thesis, its inventory, and the claims of an item.

A chapter writes one line for each misprint, between \begin{errata} and \end{errata}:

    \erratum{place}{as printed}{as derived}{effect}{ITEM/claim ITEM/claim}

The evidence is what `malus reproduce` computed for these claims. A claim that is not an erratum stops the book, and so
does an erratum of the report that has no
line. \inventory becomes the table of all items, each with its verdicts and a
link to where it is computed. \claims{ID ID} alone on a line becomes the
table of what these items claim: sentence, criterion and verdict.
"""
import csv
import json
import os
import re
from typing import TYPE_CHECKING, Any

import noweb
from problems import Problem, stop_if_any

if TYPE_CHECKING:
    from book import Page

ERRATUM = re.compile(r"^\\erratum\{")
REGISTERED = re.compile(r"registerItems\(\s*\{.*?\}\);", re.DOTALL)
ROW = re.compile(r'\{"([^"]+)", (\w+)\}')
VERDICTS = ("reproduced", "erratum", "differs", "not testable")
ROUGH = r">{\raggedright\arraybackslash}p"  # a narrow column, its right edge as it comes
BEGIN_ERRATA = (r"{\litsmall\begin{longtable}{" + "".join(f"{ROUGH}{{{width}\\textwidth}}" for width in (.12, .19, .19, .3, .13))
                + r"}\toprule place & as printed & as derived & evidence & effect \\ \midrule\endhead")
BEGIN_ITEMS = (r"{\litsmall\begin{longtable}{l" + rf"{ROUGH}{{.28\textwidth}}{ROUGH}{{.15\textwidth}}rrrr{ROUGH}{{.19\textwidth}}"
               + r"}\toprule item & what & place & r & e & d & n & described in \\ \midrule\endhead")
POWER = re.compile(r"(?<![\w.])(-?)(\d+(?:\.\d+)?)e\+?(-?)0*(\d+)\b")
CLAIMS = re.compile(r"^\\claims\{([^}]*)\}$", re.MULTILINE)
BEGIN_CLAIMS = (r"{\litsmall\begin{longtable}{l" + "".join(f"{ROUGH}{{{width}\\textwidth}}" for width in (.36, .3, .14))
                + r"}\toprule item & sentence & criterion & verdict \\ \midrule\endhead")
END = r"\bottomrule\end{longtable}}"


def with_powers(latex: str) -> str:
    """The same text, its numbers with powers of ten as print has them."""
    def power(found: re.Match[str]) -> str:
        factor = "" if found[2] == "1" else found[2] + r"\cdot"
        return f"${found[1]}{factor}10^{{{found[3]}{found[4]}}}$"

    return POWER.sub(power, latex)


def plain(words: str) -> str:
    """Words of the report as LaTeX."""
    text = noweb.quote_latex(words).replace("-{}", "-").replace("<{}", "$<$").replace(">{}", "$>$")
    return text.replace(r"\textquotesingle{}", "'").replace("|", r"\textbar{}")


def arguments(line: str) -> list[str]:
    """The arguments of a macro that is alone on a line."""
    out: list[str] = []
    depth = begin = 0
    for place, character in enumerate(line):
        if character == "{" and line[place - 1] != "\\":
            depth += 1
            if depth == 1:
                begin = place + 1
        elif character == "}" and line[place - 1] != "\\":
            depth -= 1
            if depth == 0:
                out.append(line[begin:place])
    return out


class Verdicts:
    """The contents of the report, for the pages that refer to it."""

    def __init__(self, report: str, inventory: str | None = None) -> None:
        path = os.path.join(report, "report.json")
        self.items: list[dict[str, Any]] = []
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.items = json.load(file)["items"]
        self.listed: list[dict[str, str]] = []  # rows of the inventory, those without a function as well
        if inventory:
            with open(inventory, encoding="utf-8") as file:
                self.listed = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.claims = {f"{item['id']}/{claim['name']}": claim for item in self.items for claim in item["claims"]}

    def substitute(self, page: "Page", chapters: list[noweb.Chapter], pages: list["Page"]) -> None:
        """Writes the tables into a page, line for line."""
        if r"\begin{errata}" in page.latex:
            self.errata(page)
        if r"\inventory" in page.latex:
            page.latex = re.sub(r"^\\inventory$", lambda _: self.inventory(page, chapters, pages), page.latex, flags=re.MULTILINE)

        page.latex = CLAIMS.sub(lambda match: self.table_of(page, match[1].split()), page.latex)

    def table_of(self, page: "Page", ids: list[str]) -> str:
        """The claims of these items, in their order; a row that repeats another is left out."""
        rows, found = [], {item["id"]: item for item in self.items}
        stop_if_any([Problem(page.source, 0, rf"\claims names {name}, which is not an item of the report")
                     for name in ids if name not in found])
        for name in ids:
            for claim in found[name]["claims"]:
                if claim["repeats"]:
                    continue
                sentence = f"{claim['sentence']}: {claim['quantity']}" if claim["quantity"] else claim["sentence"]
                fitted = f"; fitted, {claim['unknowns']} unknowns" if claim["fit"] else ""
                rows.append(rf"\litto{{{name}}}{{{name}}} & {with_powers(plain(sentence))} & {with_powers(plain(claim['criterion']))}"
                            rf" ({claim['source']}{fitted}) & {claim['verdict']} \\")
        return BEGIN_CLAIMS + " ".join(rows) + END

    def errata(self, page: "Page") -> None:
        problems: list[Problem] = []
        told: set[str] = set()
        lines = page.latex.split("\n")
        for number, line in enumerate(lines, 1):
            if not ERRATUM.match(line):
                continue
            parts = arguments(line)
            if len(parts) != 5:
                problems.append(Problem(page.source, number,
                                        r"\erratum needs five arguments: place, as printed, as derived, effect, claims"))
                continue
            place, printed, derived, effect, names = parts
            evidence = []
            for name in names.split():
                claim = self.claims.get(name)
                if not claim or claim["verdict"] != "erratum":
                    problems.append(Problem(page.source, number, f"{name} is not an erratum of the report"))
                    continue
                told.add(name)
                said = f"{claim['ours']}; {claim['cause']}" if claim["printed"] and claim["cause"] else claim["ours"]
                item = name.split("/")[0]
                evidence.append(rf"\litto{{{item}}}{{{plain(name)}}}: {plain(said)}.")
            lines[number - 1] = f"{place} & {printed} & {derived} & {' '.join(evidence)} & {effect} \\\\"
        problems += [Problem(page.source, 0, f"the report has the erratum {name}, but no \\erratum describes it")
                     for name, claim in self.claims.items() if claim["verdict"] == "erratum" and name not in told]
        stop_if_any(problems)
        page.latex = "\n".join(lines).replace(r"\begin{errata}", BEGIN_ERRATA).replace(r"\end{errata}", END)

    def inventory(self, page: "Page", chapters: list[noweb.Chapter], pages: list["Page"]) -> str:
        """All items of the report, in its order, and then the others of the inventory."""
        homes = {word: chunk for chapter in chapters for chunk in chapter.chunks for word, _ in chunk.defines}
        functions = {match[1]: match[2] for chapter in chapters for chunk in chapter.chunks
                     for listed in REGISTERED.finditer(chunk.text) for match in ROW.finditer(listed[0])}
        labels = {other.source: label[1] for other in pages if (label := re.search(r"\\label\{(ch:[^}]*)\}", other.latex))}
        rows, problems = [], []
        for item in self.items:
            home = homes.get(functions.get(item["id"], ""))
            if not home:
                problems.append(Problem(page.source, 0, f"item {item['id']} leads to no function that an `@ %def` defines"))
                continue
            counts = " & ".join(str(item["counts"].get(verdict) or "") for verdict in VERDICTS)
            rows.append(rf"\lititem{{{item['id']}}}{{{item['id']}}} & {plain(item['title'])} & {plain(item['place'])} & {counts} & "
                        rf"chapter~\ref{{{labels[home.chapter.path]}}}, \litlink{{{home.label}}}{{code}} \\")
        built = {item["id"] for item in self.items}
        rows += [rf"\lititem{{{row['id']}}}{{{row['id']}}} & {plain(row['title'])} & {plain(row['place'])} & & & & & not built \\"
                 for row in self.listed if row["id"] not in built]
        stop_if_any(problems)
        return BEGIN_ITEMS + " ".join(rows) + END
