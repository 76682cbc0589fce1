#!/usr/bin/python3
"""Manual pages and completions of malus, made from what its programs say of themselves.

    manual.py DIRECTORY PROGRAM...

PROGRAM --describe prints commands, flags and examples as JSON. Into DIRECTORY, laid out as below /usr/share,
come man/man1/malus.1 and malus-COMMAND.1, and the completions of bash, zsh and fish.
"""
import json
import pathlib
import re
import subprocess
import sys
from typing import Any

import jinja2

TEMPLATES = pathlib.Path(__file__).resolve().parent
COMPLETIONS = {"malus.bash": "bash-completion/completions/malus", "malus.zsh": "zsh/site-functions/_malus",
               "malus.fish": "fish/vendor_completions.d/malus.fish"}


def roff(text: str) -> str:
    """Text in which no letter is a command of troff, and a hyphen is the hyphen of a shell."""
    return re.sub(r"(?m)^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"))


def quoted(text: str) -> str:
    """A text within single quotes of a shell, on one line."""
    return "'" + " ".join(text.split()).replace("'", "'\\''") + "'"


def zsh(text: str) -> str:
    """A text within the brackets of a zsh completion."""
    return re.sub(r"([\\\[\]:'])", lambda m: "'\\''" if m[1] == "'" else "\\" + m[1], " ".join(text.split()))


def described(program: str) -> dict[str, Any]:
    """The description that a program prints of its commands."""
    said: dict[str, Any] = json.loads(subprocess.run([program, "--describe"], check=True, capture_output=True, text=True).stdout)
    return said


def main() -> None:
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    root, programs = pathlib.Path(sys.argv[1]), [described(program) for program in sys.argv[2:]]
    commands = [command for program in programs for command in program["commands"]]
    everything = {"version": programs[0]["version"], "commands": commands}
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), undefined=jinja2.StrictUndefined,
                                     keep_trailing_newline=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters.update({"roff": roff, "quoted": quoted, "zsh": zsh})

    def write(name: str, template: str, **more: object) -> None:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(environment.get_template(template).render(**everything, **more), encoding="utf-8")

    write("man/man1/malus.1", "malus.1")
    for command in commands:
        write(f"man/man1/malus-{command['name']}.1", "command.1", command=command)
    for template, place in COMPLETIONS.items():
        write(place, template)


if __name__ == "__main__":
    main()
