r"""Tables of options and keys come from the program's own definitions.

\options{COMMAND} alone on a line becomes the table of a subcommand's options,
as `malus --describe` has them. \keys{PATH PATH -PATH} becomes the table of a
scene's keys below each path of the schema that `malus schema` prints, without
those below a path with a minus. Without a program a sentence takes their place.
"""
import json
import re
import subprocess
from typing import TYPE_CHECKING, Any, Iterator

import noweb
from problems import Problem, stop_if_any
from verdicts import END, ROUGH, plain

if TYPE_CHECKING:
    from book import Page

OPTIONS = re.compile(r"^\\options\{([^}]*)\}$", re.MULTILINE)
KEYS = re.compile(r"^\\keys\{([^}]*)\}$", re.MULTILINE)
BEGIN = rf"{{\litsmall\begin{{longtable}}{{{ROUGH}{{.34\textwidth}}{ROUGH}{{.56\textwidth}}}}\toprule "
MANY = 8  # choices; more are in the list that the option's text names

Key = tuple[str, str, bool]  # path, description, whether it is required


def code(words: str) -> str:
    """A word in typewriter letters that may break behind a point, a slash or an underscore."""
    return r"\texttt{" + re.sub(r"(\\_|\.|/)", r"\1\\allowbreak{}", noweb.quote_latex(words)) + "}"


class Reference:
    """What the program says of its commands and of its scenes."""

    def __init__(self, program: str) -> None:
        self.commands: dict[str, list[dict[str, Any]]] = {}
        self.schema: dict[str, Any] = {}
        if program:
            described = json.loads(self.said(program, "--describe"))
            self.commands = {command["name"]: command["flags"] for command in described["commands"]}
            self.schema = json.loads(self.said(program, "schema"))

    @staticmethod
    def said(*words: str) -> str:
        return subprocess.run(words, check=True, capture_output=True, text=True).stdout

    def substitute(self, page: "Page") -> None:
        """Writes the tables into a page, line for line."""
        page.latex = OPTIONS.sub(lambda match: self.options(page, match[1]), page.latex)
        page.latex = KEYS.sub(lambda match: self.keys(page, match[1].split()), page.latex)

    def options(self, page: "Page", command: str) -> str:
        if not self.schema:
            return rf"\texttt{{malus {command} -{{}}-help}} lists the options."
        if command not in self.commands:
            stop_if_any([Problem(page.source, 0, rf"\options names {command}, which is no command of the program")])
        rows = []
        for flag in self.commands[command]:
            if flag["name"] == "--help":
                continue
            choices = flag["choices"]
            value = "" if flag["placed"] else "|".join(choices) if 0 < len(choices) <= MANY else flag["value"]
            marks = [mark for mark, holds in (("required", flag["required"]), ("may be repeated", flag["several"])) if holds]
            text = plain(flag["text"]) + (f" ({', '.join(marks)})" if marks else "")
            rows.append(rf"{code(flag['name'])} {plain(value)} & {text} \\")
        return BEGIN + r"option & meaning \\ \midrule\endhead" + " ".join(rows) + END

    def keys(self, page: "Page", paths: list[str]) -> str:
        if not self.schema:
            return r"\texttt{malus schema} prints the keys."
        without = tuple(path[1:] for path in paths if path.startswith("-"))
        every = list(self.below("", self.schema, False))
        rows = []
        for path in paths:
            if path in without or path.startswith("-"):
                continue
            found = [key for key in every if within(key[0], path) and not any(within(key[0], other) for other in without)]
            if not found:
                stop_if_any([Problem(page.source, 0, rf"\keys names {path}, which is no key of a scene")])
            for name, description, required in found:
                rows.append(rf"{code(name)} & {plain(description)}{' (required)' if required else ''} \\")
        return BEGIN + r"key & value \\ \midrule\endhead" + " ".join(rows) + END

    def below(self, path: str, node: dict[str, Any], required: bool) -> Iterator[Key]:
        """A node of the schema and all that is in it, but for the parts of a spectrum."""
        node = self.resolved(node)
        if path:
            yield path, node.get("description", ""), required
        members = node.get("properties", {})
        if {"values", "wavelength_nm"} <= set(members):
            return
        for name, member in members.items():
            yield from self.below(f"{path}.{name}" if path else name, member, name in node.get("required", []))
        if isinstance(node.get("additionalProperties"), dict):
            yield from self.below(path + ".NAME", node["additionalProperties"], False)
        if isinstance(node.get("items"), dict) and "properties" in self.resolved(node["items"]):
            yield from self.below(path + "[]", node["items"], False)

    def resolved(self, node: dict[str, Any]) -> dict[str, Any]:
        """The node, or the definition to which it refers."""
        while "$ref" in node:
            node = {**self.schema["definitions"][node["$ref"].rsplit("/", 1)[-1]],
                    **{name: value for name, value in node.items() if name != "$ref"}}
        return node


def within(path: str, other: str) -> bool:
    """Whether a key is another one or below it."""
    return path == other or path.startswith((other + ".", other + "["))
