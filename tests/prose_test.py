#!/usr/bin/python3
"""The check of the prose: each pattern is found in a made-up chapter, and nothing in a clean one or in its code.

Identity: every pattern has a sentence with exactly one hit, in prose, messages and comments, at the right line.
Negative control: an editor's version of the same sentences has no hit.
"""
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "doc", "weaver"))
import prose  # noqa: E402

# pattern, as it should not be, as an editor leaves it
SENTENCES = [
    ("stand", "The axes stand in the header.", "The axes are in the header."),
    ("ask", "The tracer asks the sky.", "The tracer evaluates the sky. You asked for it."),
    ("answer", "The grid answers with radiances.", "The grid returns radiances."),
    ("know", "A sensor knows its bands.", "A sensor stores its bands. We know them."),
    ("want", "This function wants radians.", "This function takes radians. The reader wants to see it."),
    ("mind", "A class remembers its unit.", "A class stores its unit. We remember it."),
    ("for", "It fails, for the index is complex.", "It fails because the index is complex, for example, and for all angles."),
    ("own", "It has a chunk of its own.", "It has a separate chunk."),
    ("told", "A mistake is told with its place.", "An error is reported with its place."),
    ("is no", "The sum is no matrix.", "The sum is not a matrix; there is no matrix, and it is no longer one."),
    ("who", "It helps whoever writes a scene.", "It helps anyone who writes a scene."),
    ("mend", "Mend the file.", "Correct the file."),
    ("one way", "It is not given in one way.", "It is given twice."),
    ("what", "What it costs is measured.", "The cost is measured."),
    ("that", "That the error shrinks is tested.", "A test checks that the error shrinks."),
    ("to be", "The file is to be read.", "Read the file. The aim is to be a model."),
    ("besides", "It also has a name besides.", "It also has a name."),
    ("save", "All is zero save at the pole.", "All is zero except at the pole."),
    ("question", "Which index is right?", "Only one index is right."),
    ("long", "One" + " and one" * 25 + ".", "One" + " and one" * 10 + "."),
]


class Prose(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.dir = folder.name

    def put(self, name: str, text: str) -> str:
        path = os.path.join(self.dir, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def found(self, text: str, name: str = "a.nw") -> list[tuple[str, str, int]]:
        """(pattern, kind, line) of every hit"""
        out, _ = prose.hits(self.put(name, text))
        return [(pattern, kind, line) for pattern, places in out.items() for kind, line, _ in places]

    def test_every_pattern_has_a_sentence_here(self) -> None:
        self.assertEqual([name for name, _, _ in SENTENCES], list(prose.COMPILED))

    def test_each_pattern_is_found_once_where_it_is(self) -> None:
        for name, bad, _ in SENTENCES:
            with self.subTest(name):
                self.assertEqual(self.found("\\chapter{Radiance}\n\nA sentence. And\nanother.\n" + bad + "\n"), [(name, "prose", 5)])

    def test_an_editor_s_sentence_has_none(self) -> None:
        for name, _, good in SENTENCES:
            with self.subTest(name):
                self.assertEqual(self.found("\\chapter{Radiance}\n" + good + "\n"), [])

    def test_messages_and_comments_of_the_code_are_read_and_joined(self) -> None:
        chapter = ("\\chapter{Radiance}\n<<Refuse>>=\n// The grid\n// answers.\nint ask = told(\"stand\");\n"
                   "throw Error(\"the sum is \"\n            \"no matrix\");\n@\n")
        self.assertEqual(self.found(chapter), [("answer", "comment", 3), ("is no", "message", 6)])

    def test_equations_code_and_citations_are_not_prose(self) -> None:
        self.assertEqual(self.found("\\chapter{Radiance}\nIt has [[ask]] and $want$ and \\cite{mend} and\n"
                                    "\\begin{equation}\nstand\n\\end{equation}\n"
                                    "\\label{eq:told} no % stand\n<<A>>=\nask(stand);\n@ %def ask\n"), [])

    def test_a_title_has_a_term_of_the_field(self) -> None:
        self.assertEqual(self.found("\\chapter{Things by their names}\n"), [("title", "prose", 1)])
        self.assertEqual(self.found("\\chapter{Fresnel reflection}\n"), [])

    def test_readme_and_python_are_read(self) -> None:
        self.assertEqual(self.found("# Name\n\n    ask stand\n\nThe `ask`\nfile wants it.\n", "README.md"), [("want", "prose", 5)])
        self.assertEqual(self.found('"""A module.\n\nIt wants it.\n"""\nx = 1  # a name that stands here\nwant = "stand"\n', "a.py"),
                         [("stand", "comment", 5), ("want", "comment", 3)])

    def test_it_prints_one_screen_or_a_list_and_never_stops_the_build(self) -> None:
        path = self.put("a.nw", "\\chapter{Radiance}\nWhat it costs is told.\n")
        command = [os.path.join(ROOT, "doc", "weaver", "prose.py")]
        done = subprocess.run([*command, path], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"(?m)^told +1 +0 +0 ")
        self.assertLess(done.stdout.count("\n"), 40)
        done = subprocess.run([*command, "--list", "told", path], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, f"{path}:2: What it costs is told.\n"))


if __name__ == "__main__":
    unittest.main()
