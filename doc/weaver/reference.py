r"""Tables of reference: the options of a command, the keys of a scene, the parameters of a model, as the program itself defines them.

    \options{render}           a row for each option of `malus render`
    \keys{sensor platform}     a row for each key inside of these keys or definitions of a scene
    \parameters{lambertian}    a row for each parameter of a model or sky

each alone on a line. The definitions are what `malus --describe` and `malus schema` print; the build leaves them beside the
report. A name that the program does not have stops the book.
"""
import json
import os
import re
from typing import TYPE_CHECKING, Any

from problems import Problem
from verdicts import END, ROUGH, plain, with_powers

if TYPE_CHECKING:
    from book import Page

MACRO = re.compile(r"^\\(options|keys|parameters)\{([^}]*)\}$", re.MULTILINE)
OPTION = re.compile(r"(?<![\w-])--[a-z]+(-[a-z]+)*")
FEW = 6  # choices that fit into a cell; more of them are what --list prints


def begin(head: str, *columns: tuple[str, float]) -> str:
    """A table with these heads: what is named, in a column as wide as it needs, and prose, in shares of the line."""
    widths = "".join(rf"{ROUGH}{{{width}\textwidth}}" for _, width in columns)
    heads = " & ".join([head, *(name for name, _ in columns)])
    return rf"{{\litsmall\begin{{longtable}}{{l{widths}}}\toprule {heads} \\ \midrule\endhead"


def code(words: str) -> str:
    """Words in type of the keyboard."""
    return rf"\texttt{{{plain(words)}}}"


def prose(words: str) -> str:
    """Words of the program as LaTeX: its options in type of the keyboard, its numbers with powers of ten as print has them."""
    return OPTION.sub(r"\\texttt{\g<0>}", with_powers(plain(words)))


class Reference:
    """The program's description of itself, for the pages that have a table of it."""

    def __init__(self, report: str) -> None:
        self.commands: dict[str, Any] = {}
        self.described: dict[str, Any] = {}  # models and skies
        for name in ("program.json", "reproduce.json"):
            found = self.read(os.path.join(report, name))
            self.commands |= {command["name"]: command for command in found.get("commands", [])}
            self.described |= {entry["name"]: entry for kind in ("models", "skies") for entry in found.get(kind, [])}
        self.schema = self.read(os.path.join(report, "schema.json"))

    @staticmethod
    def read(path: str) -> dict[str, Any]:
        if not os.path.exists(path):
            return {}
        with open(path, encoding="utf-8") as file:
            found: dict[str, Any] = json.load(file)
        return found

    def substitute(self, page: "Page") -> None:
        """Writes the tables into a page; each stays on its line."""
        def table(match: re.Match[str]) -> str:
            tables = {"options": self.options, "keys": self.keys, "parameters": self.parameters}
            try:
                return tables[match[1]](match[2])
            except KeyError as missing:
                line = page.latex.count("\n", 0, match.start()) + 1
                raise Problem(page.source, line, rf"\{match[1]} names {missing}, which the program does not have") from missing

        page.latex = MACRO.sub(table, page.latex)

    def options(self, command: str) -> str:
        rows = []
        for flag in self.commands[command]["flags"]:
            if flag["name"] == "--help":
                continue
            value = f" {flag['value']}" if flag["value"] and not flag["placed"] else ""
            unsaid = [choice for choice in flag["choices"] if choice not in flag["text"]]
            text = prose(flag["text"]) + (": " + ", ".join(code(choice) for choice in unsaid) if 0 < len(unsaid) <= FEW else "")
            notes = [note for note, holds in (("required", flag["required"]), ("repeatable", flag["several"])) if holds]
            rows.append(rf"{code(flag['name'] + value)} & {text}{'; ' + ', '.join(notes) if notes else ''} \\")
        return begin("option", ("effect", .64)) + " ".join(rows) + END

    def parameters(self, name: str) -> str:
        rows = []
        for parameter in self.described[name]["parameters"]:
            meaning = parameter["meaning"] + (f" [{parameter['unit']}]" if parameter["unit"] else "")
            default = "optional" if parameter["optional"] else parameter["default"] or "required"
            rows.append(rf"{code(parameter['name'])} & {prose(meaning)} & {prose(parameter['range'])} & {prose(default)} \\")
        return begin(code(name), ("meaning", .34), ("values", .24), ("default", .1)) + " ".join(rows) + END

    def keys(self, names: str) -> str:
        rows: list[str] = []
        for name in names.split():
            of_scene = name in self.schema["properties"]
            value = self.schema["properties" if of_scene else "definitions"][name]
            self.below(name, value, of_scene and name in self.schema["required"], 0, rows)
        return begin("key", ("value", .66)) + " ".join(rows) + END

    def below(self, name: str, value: dict[str, Any], required: bool, depth: int, rows: list[str]) -> None:
        """A row for a key, and indented those of the keys inside of it. A key with a definition is not opened: it has a
        table with its name."""
        indent = r"\quad " * depth
        rows.append(rf"{indent}{code(name)} & {prose(self.described_as(value))}{'; required' if required else ''} \\")
        for inner in (value, value.get("items"), value.get("additionalProperties")):
            if isinstance(inner, dict):
                for key, each in inner.get("properties", {}).items():
                    self.below(key, each, key in inner.get("required", []), depth + 1, rows)

    def described_as(self, value: dict[str, Any]) -> str:
        definition = self.schema["definitions"][value["$ref"].rsplit("/", 1)[1]] if "$ref" in value else {}
        return str(value.get("description") or definition.get("description", ""))
