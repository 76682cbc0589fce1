#!/usr/bin/python3
"""The manual pages and completions beside what the program's help says (nw/app/Manual.nw).

    manual_test.py MALUS DIRECTORY

DIRECTORY is what doc/manual/manual.py has written. Shells and groff that are not installed are named and left out.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parent.parent
MALUS, ROOT = sys.argv[1:3] if len(sys.argv) > 2 else ("", "")
BASH = "bash-completion/completions/malus"
FISH = "fish/vendor_completions.d/malus.fish"
ZSH = "zsh/site-functions/_malus"


def said(*words: str) -> str:
    """The output of a command."""
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def made(name: str) -> str:
    """One of the files that were made."""
    return (pathlib.Path(ROOT) / name).read_text(encoding="utf-8")


def bash_completes(*words: str) -> set[str]:
    """The completions that bash offers for the last of these words."""
    line = " ".join(f"'{word}'" for word in words)
    script = (f"compopt() {{ :; }}; source {pathlib.Path(ROOT) / BASH}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _malus; "
              "printf '%s\\n' \"${COMPREPLY[@]}\"")
    return set(said("bash", "-c", script).split())


class Manual(unittest.TestCase):
    """Pages and completions."""

    def test_every_flag_of_every_help_is_everywhere(self) -> None:
        """The help is written by the parser itself, not by the description."""
        commands = re.findall(r"(?m)^  (\w+) {3,}", said(MALUS, "--help").split("Subcommands:")[1])
        self.assertIn("render", commands)
        for command in commands:
            shown = said(MALUS, command, "--help").split("Examples:")[0]
            flags = set(re.findall(r"(?m)^  (?:-\w,)?(--[\w-]+)", shown))
            self.assertIn("--help", flags)
            page = made(f"man/man1/malus-{command}.1").replace("\\-", "-")
            self.assertEqual(flags, set(re.findall(r"(?m)^\.BI? (--[\w-]+)", page)), command)
            self.assertEqual(flags, bash_completes("malus", command, "--"), command)
            fish = re.findall(rf"seen_subcommand_from {command}' -l ([\w-]+)", made(FISH))
            self.assertEqual(flags, {"--" + flag for flag in fish}, command)
            zsh = made(ZSH).split(f"    {command})\n")[1].split(";;")[0]
            self.assertEqual(flags, set(re.findall(r"(?m)^ +'\*?(--[\w-]+)\[", zsh)), command)

    def test_bash_completes_what_is_begun(self) -> None:
        """Commands, flags, and the words that a flag may take."""
        self.assertEqual(bash_completes("malus", "ren"), {"render"})
        self.assertEqual(bash_completes("malus", "render", "--fr"), {"--frames"})
        models = set(re.findall(r"(?m)^([a-z][\w-]+) +[\w-]{4}  ", said(MALUS, "brdf", "--list")))
        self.assertIn("torrance-sparrow", models)
        self.assertEqual(bash_completes("malus", "brdf", "--model", ""), models)
        self.assertEqual(bash_completes("malus", "nonsense", "--"), set(), "the control: no such command")

    def test_fish_completes_what_is_begun(self) -> None:
        """The same of fish."""
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")
        ask = f"source {pathlib.Path(ROOT) / FISH}; complete -C "
        self.assertEqual(said("fish", "--no-config", "-c", ask + "'malus ren'").split()[0], "render")
        self.assertIn("--frames", said("fish", "--no-config", "-c", ask + "'malus render --fr'"))
        self.assertNotIn("--frames", said("fish", "--no-config", "-c", ask + "'malus sun --fr'"))

    def test_shells_and_groff_read_the_files(self) -> None:
        """No complaint about the grammar; a broken file is complained of."""
        for shell, name in (("bash", BASH), ("zsh", ZSH)):
            if not shutil.which(shell):
                continue
            subprocess.run([shell, "-n", str(pathlib.Path(ROOT) / name)], check=True)
            with tempfile.NamedTemporaryFile("w", suffix="." + shell) as broken:
                broken.write(made(name).replace("esac", "", 1))
                broken.flush()
                self.assertNotEqual(subprocess.run([shell, "-n", broken.name], capture_output=True, check=False).returncode, 0)
        if not shutil.which("groff"):
            self.skipTest("groff is not installed")
        for page in pathlib.Path(ROOT).glob("man/man1/*.1"):
            done = subprocess.run(["groff", "-man", "-ww", "-z", "-Tutf8", str(page)], capture_output=True, text=True, check=True)
            self.assertEqual(done.stderr, "", page.name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
