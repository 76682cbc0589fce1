#!/usr/bin/python3
"""README.md and doc/guide.md beside the program, the build and the files that they describe: guide_test.py MALUS.

Regression: what they show as the output of a command is what it prints today. Each test has its negative control.
"""
import csv
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parent.parent
MALUS = sys.argv[1] if len(sys.argv) > 1 else ""
SCREEN = 60  # lines of a README that is read at a glance
DOCUMENTS = ("README.md", "doc/guide.md", "scenes/README.md", "generated/README.md")


def text(name: str) -> str:
    return (TOP / name).read_text(encoding="utf-8")


def block(document: str, start: str) -> list[str]:
    """The indented lines of a document from one that begins with `start` to the end of its block."""
    lines = text(document).split("\n")
    first = next(number for number, line in enumerate(lines) if line.startswith("    " + start))
    end = next(number for number in range(first, len(lines)) if lines[number] and not lines[number].startswith("    "))
    return [line.removeprefix("    ") for line in lines[first:end] if line]


def anchors(name: str) -> set[str]:
    """The anchors that a host of repositories gives to the headings of a document."""
    headings = re.findall(r"(?m)^#+ (.*)$", text(name))
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken(name: str, document: str) -> list[str]:
    """The links and pictures of a document that lead nowhere in this tree."""
    wrong = []
    for link in re.findall(r"\]\(([^)\s]+)\)", document):
        path, _, anchor = link.partition("#")
        if "://" in path:
            continue
        target = (TOP / name).parent / path if path else TOP / name
        if not target.exists() or anchor and anchor not in anchors(str(target.resolve().relative_to(TOP))):
            wrong.append(link)
    return wrong


def shown(document: str) -> list[tuple[str, list[str]]]:
    """The commands after a prompt that a document shows, each with the lines below it."""
    found: list[tuple[str, list[str]]] = []
    lines = text(document).split("\n")
    number = 0
    while number < len(lines):
        if lines[number].startswith("    $ "):
            command = lines[number][6:]
            while command.endswith("\\"):
                number += 1
                command = command[:-1] + lines[number].strip()
            output = []
            while lines[number + 1].startswith("    ") and not lines[number + 1].startswith("    $ "):
                number += 1
                output.append(lines[number][4:])
            found.append((command, output))
        number += 1
    return found


def printed(command: str) -> list[str]:
    """The output of a command of the guide, with this program for ./build/malus and without lines that contain times."""
    with tempfile.TemporaryDirectory() as folder:
        line = command.replace("./build/malus", shlex.quote(os.path.abspath(MALUS)))
        line = line.replace(" scenes/", f" {TOP / 'scenes'}/")
        (pathlib.Path(folder) / "bad.json").write_text(
            text("scenes/chunky-bar-copper.json").replace('"grid-rotated"', '"gird-rotated"'), encoding="utf-8")
        done = subprocess.run(line, shell=True, cwd=folder, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return [one for one in done.stdout.split("\n") if one and "Mrays" not in one]


def rounded(lines: list[str]) -> list[str]:
    """The same lines with long numbers cut to nine digits: the last ones depend on compiler and libraries."""
    return [re.sub(r"\d+\.\d{9,}", lambda number: f"{float(number[0]):.9g}", line) for line in lines]


def container(document: str) -> set[str]:
    """The commands that a Containerfile runs."""
    runs = re.findall(r"(?m)^RUN (.*)$", document.replace("\\\n", " "))
    return {" ".join(command.split()) for run in runs for command in run.split("&&")}


class Readme(unittest.TestCase):
    def test_it_fits_a_screen(self) -> None:
        self.assertLessEqual(len(text("README.md").strip().split("\n")), SCREEN)

    def test_its_minutes_are_those_of_the_measured_build(self) -> None:
        rows = csv.DictReader(text("validation/build-times.csv").splitlines())
        minutes = {row["part"]: f"{float(row['clock_s']) / 60:.0f}" for row in rows}
        said = re.findall(r"first `(make(?: test)?)` .*?about (\d+) minutes", text("README.md").replace("\n", " "))
        self.assertEqual(dict(said), {part: minutes[part] for part in ("make", "make test")})
        self.assertNotEqual(minutes["make"], minutes["make test"], "the control: two different times")

    def test_its_lines_of_python_are_those_of_the_example_and_the_package(self) -> None:
        lines = block("README.md", "import malus")
        self.assertTrue(lines[-1].startswith("sky.malus.plot()"), lines)
        example = text("examples/polarized_sky.py").split('"""\n')[-1]
        self.assertEqual(lines, [line for line in example.split("\n") if line])
        package = text("debian/tests/python").split("\n")
        self.assertLessEqual({line for line in lines if line.startswith(("import", "sky"))}, set(package))
        self.assertFalse({lines[-1] + " "} <= set(package), "the control: another line")


class Guide(unittest.TestCase):
    def test_links_lead_somewhere(self) -> None:
        self.assertEqual({name: wrong for name in DOCUMENTS if (wrong := broken(name, text(name)))}, {})
        self.assertEqual(broken("README.md", "[a](doc/guide.md#nowhere) [b](doc/no.md) [c](doc/guide.md)"),
                         ["doc/guide.md#nowhere", "doc/no.md"], "the control: links that are broken")

    def test_commands_print_what_is_shown(self) -> None:
        compared = 0
        for command, output in shown("doc/guide.md"):
            output = [line for line in output if "Mrays" not in line]
            if output:
                compared += 1
                self.assertEqual(rounded(printed(command)), rounded(output), command)
        self.assertGreaterEqual(compared, 5)
        command, output = shown("doc/guide.md")[0]
        self.assertNotEqual(printed(command.replace("0.405", "0.406")), output, "the control: another index")

    def test_the_container_runs_the_commands_that_install(self) -> None:
        commands = [" ".join(line.split("#")[0].split()) for line in block("doc/guide.md", "make deb")[:2]]
        self.assertEqual(commands[0], "make deb")
        self.assertTrue(commands[1].startswith("apt install "))
        document = text("Containerfile").replace("apt install -y", "apt install")
        self.assertLessEqual(set(commands), container(document))
        self.assertFalse(set(commands) <= container(document.replace("make deb", "make dep")), "the control: another command")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
