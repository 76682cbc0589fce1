#!/usr/bin/python3
"""Use the live figures as a reader does (nw/live/LiveFigure.nw): live_test.py [BOOK [LIBRARY [MALUS]]].

A headless Chromium opens the pages of the woven book, drags every slider by key and by value, and compares the numbers
that the page shows with those of the same functions compiled for this machine (build/lib/libmalus_live.so) and, where
there is one, with the command of malus. The book must show each figure that the program has, and no other.

`live_test.py --times` prints how long sliders and pages take, the least of some trials; no test depends on that.
"""
import csv
import ctypes
import glob
import json
import math
import os
import re
import statistics
import subprocess
import sys
import time
import unittest
from typing import Any

import browser

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BOOK = os.path.join(ROOT, "build", "book")
LIBRARY = os.path.join(ROOT, "build", "lib", "libmalus_live.so")
MALUS = os.path.join(ROOT, "build", "malus")
PATIENCE_S = 30
KEYS = {"ArrowRight": 39, "Home": 36}

# moves a control as a hand does, and returns what the page shows then
MOVE = """(([name, control, value]) => {
  const figure = document.querySelector(`figure[data-live="${name}"]`), input = document.getElementById(`live-${name}-${control}`);
  if (control) { input.value = value; input.dispatchEvent(new Event("input", {bubbles: true})); }
  return {values: [...figure.querySelectorAll("input, select")].map((one) => Number(one.value)),
          numbers: [...figure.querySelectorAll(".live-numbers > div")].map((one) => [one.querySelector("dt").textContent,
            one.querySelector(".live-number").textContent]),
          message: figure.querySelector(".live-message").textContent,
          alternative: figure.querySelector(".live-picture").getAttribute("aria-label"),
          drawn: figure.querySelectorAll("svg, .live-printed").length,
          milliseconds: Number(figure.dataset.milliseconds)};
})(%s)"""


class Native:
    """The functions of the figures as this machine runs them."""

    def __init__(self, path: str) -> None:
        self.library = ctypes.CDLL(path)
        self.library.malusLiveFigures.restype = ctypes.c_char_p
        self.library.malusLiveEvaluate.restype = ctypes.c_char_p
        self.figures: list[dict[str, Any]] = json.loads(self.library.malusLiveFigures())

    def evaluate(self, name: str, values: list[float]) -> dict[str, Any]:
        """The result of a figure."""
        number = next(i for i, figure in enumerate(self.figures) if figure["name"] == name)
        answer: dict[str, Any] = json.loads(self.library.malusLiveEvaluate(number, (ctypes.c_double * len(values))(*values)))
        return answer

    def numbers(self, name: str, values: list[float]) -> list[list[str]]:
        """Label and text of all numbers, with the minus of print."""
        return [[number["label"], number["text"].replace("-", "\u2212")] for number in self.evaluate(name, values)["numbers"]]


def homes(book: str) -> dict[str, str]:
    """The page of each figure."""
    found: dict[str, str] = {}
    for path in sorted(glob.glob(os.path.join(book, "*.html"))):
        with open(path, encoding="utf-8") as file:
            for name in re.findall(r'<figure class="live" data-live="([^"]*)"', file.read()):
                assert name not in found, f"{name} is on two pages"
                found[name] = path
    return found


def close(shown: str, value: float) -> bool:
    """Whether a text of five digits is a value, rounded alike."""
    return float(shown.replace("\u2212", "-")) == (0 if abs(value) < 1e-6 else float(f"{value:.5g}"))


def steps(control: dict[str, Any]) -> list[float]:
    """Values to which a control is dragged: both ends and three between."""
    count = round((control["most"] - control["least"]) / control["step"])
    return [control["least"] + control["step"] * round(count * part) for part in (0, 0.23, 0.5, 0.71, 1)]


class LivePage(browser.Browser):
    """A browser that moves controls."""

    def show(self, path: str) -> None:
        """Opens a page and waits for its figures."""
        self.open("file://" + path)
        deadline = time.monotonic() + PATIENCE_S
        while not self.value("document.documentElement.dataset.liveReady"):
            assert time.monotonic() < deadline, f"{path}: its figures do not appear: {self.complaints()}"
            time.sleep(0.02)

    def move(self, name: str, control: str = "", value: float = 0) -> dict[str, Any]:
        """The numbers of a figure after a control was moved."""
        shown: dict[str, Any] = self.value(MOVE % json.dumps([name, control, value]))
        return shown

    def press(self, name: str, control: str, key: str) -> dict[str, Any]:
        """The numbers of a figure after a key was pressed in a control."""
        self.value(f'document.getElementById("live-{name}-{control}").focus()')
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=KEYS[key])
        return self.move(name)


class LiveFigures(unittest.TestCase):
    """Every figure of the book."""

    page: LivePage
    native: Native
    homes: dict[str, str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.native = Native(LIBRARY)
        cls.homes = homes(BOOK)
        page = LivePage()
        page.__enter__()
        cls.addClassCleanup(page.__exit__)
        cls.page = page

    def test_each_figure_has_a_page(self) -> None:
        self.assertEqual(set(self.homes), {figure["name"] for figure in self.native.figures})

    def test_numbers_are_those_of_this_machine(self) -> None:
        compared = 0
        for figure in self.native.figures:
            name = figure["name"]
            self.page.show(self.homes[name])
            for control in figure["controls"]:
                for value in steps(control):
                    shown = self.page.move(name, control["name"], value)
                    self.assertEqual((shown["message"], shown["numbers"]), ("", self.native.numbers(name, shown["values"])),
                                     f"{name}: {control['name']} {value}")
                    compared += len(shown["numbers"])
                self.page.move(name, control["name"], control["initial"])
            self.assertEqual(self.page.complaints(), [])
        self.assertGreater(compared, 100)

    def test_numbers_are_those_of_the_command(self) -> None:
        self.page.show(self.homes["lobe"])
        surfaces: list[dict[str, float]] = [{}, {"n": 1.5, "k": 0.0, "sigma": 0.11}, {"theta_i": 60, "theta_r": 71, "phi": 135}, {"diffuse": 2}]
        for moved in surfaces:
            for control, value in moved.items():
                shown = self.page.move("lobe", control, value)
            shown = self.page.move("lobe")
            n, k, sigma, theta_i, theta_r, phi, diffuse = shown["values"]
            answer = self.malus("brdf", "--model", "torrance-sparrow", "--param", f"n={n}", "--param", f"k={k}", "--param", f"sigma={sigma}",
                                "--param", "diffuse=" + ["none", "thesis", "reciprocal"][int(diffuse)],
                                "--theta-i-deg", f"{theta_i}", "--theta-r-deg", f"{theta_r}", "--phi-deg", f"{phi}", "--format", "csv")
            self.assertEqual(len(shown["numbers"]), 20)
            for label, text in shown["numbers"][:16]:
                self.assertTrue(close(text, float(answer[label])), f"{label}: {text}, malus brdf {answer[label]}")
        self.page.show(self.homes["sky"])
        skies: list[dict[str, float]] = [{}, {"sun": 82, "tau": 0.5}, {"albedo": 0.8, "theta": 33, "phi": 200}]
        for moved in skies:
            for control, value in moved.items():
                self.page.move("sky", control, value)
            shown = self.page.move("sky")
            sun, tau, albedo, theta, phi, _ = shown["values"]
            answer = self.malus("sky", "--tau", f"{tau}", "--albedo", f"{albedo}", "--mu0", repr(math.cos(math.radians(sun))),
                                "--mu", repr(math.cos(math.radians(theta))), "--phi-deg", f"{phi}")
            for (_, text), column in zip(shown["numbers"], "IQUV"):
                self.assertTrue(close(text, float(answer[column])), f"{column}: {text}, malus sky {answer[column]}")

    @staticmethod
    def malus(*arguments: str) -> dict[str, str]:
        """The row that a command prints as CSV."""
        done = subprocess.run([MALUS, *arguments], capture_output=True, text=True, check=True)
        rows = list(csv.DictReader(line for line in done.stdout.splitlines() if not line.startswith("#")))
        return rows[0]

    def test_keys_words_and_reset(self) -> None:
        for figure in self.native.figures:
            name = figure["name"]
            self.page.show(self.homes[name])
            initial = [control["initial"] for control in figure["controls"]]
            first = self.page.move(name)
            self.assertEqual(first["values"], initial)
            self.assertGreater(first["drawn"], 0)
            slider = next(control for control in figure["controls"] if not control["choices"])
            self.assertEqual(self.page.press(name, slider["name"], "Home")["values"][figure["controls"].index(slider)], slider["least"])
            moved = self.page.press(name, slider["name"], "ArrowRight")
            self.assertAlmostEqual(moved["values"][figure["controls"].index(slider)], slider["least"] + slider["step"])
            self.assertTrue(moved["alternative"].startswith(figure["shows"]))
            self.assertNotEqual(moved["alternative"], first["alternative"])
            here = f"document.querySelector('figure[data-live={name}]')"
            self.page.value(f"{here}.querySelector('button').click()")
            self.assertEqual(self.page.move(name)["numbers"], first["numbers"])
            self.assertIn(figure["caption"], self.page.value(f"{here}.querySelector('figcaption').textContent"))

    def test_without_javascript_the_static_figures_stay(self) -> None:
        self.page.call("Emulation.setScriptExecutionDisabled", value=True)
        try:
            for path in set(self.homes.values()):
                self.page.open("file://" + path)
                document = self.page.call("DOM.getDocument")["root"]["nodeId"]
                html = self.page.call("DOM.getOuterHTML", nodeId=document)["outerHTML"]
                self.assertEqual(html.count('class="live" data-live'), len(re.findall(r'data-live="[^"]*" hidden', html)))
                self.assertTrue("<img" in html or "<table" in html, path)
        finally:
            self.page.call("Emulation.setScriptExecutionDisabled", value=False)

    def test_negative_control(self) -> None:
        figure = self.native.figures[0]
        initial = [control["initial"] for control in figure["controls"]]
        other = [initial[0] - figure["controls"][0]["step"], *initial[1:]]
        self.assertNotEqual(self.native.numbers(figure["name"], initial), self.native.numbers(figure["name"], other))
        self.assertIn("error", self.native.evaluate("fresnel", [0, 0, 10]))


def times() -> None:
    """Prints how long the figures take."""
    native = Native(LIBRARY)
    page = LivePage()
    with page:
        for figure in native.figures:
            name, taken, loads, readies = figure["name"], [], [], []
            for _ in range(5):
                page.show(homes(BOOK)[name])
                readies.append(float(page.value("document.documentElement.dataset.liveReady")))
                loads.append(page.value("performance.timing.loadEventEnd - performance.timing.navigationStart"))
            time.sleep(15)  # what is prepared while the page is idle
            for control in figure["controls"]:
                for value in steps(control):  # the least of some: what else the machine does is not the figure's
                    taken.append(min(page.move(name, control["name"], value)["milliseconds"] for _ in range(25)))
                page.move(name, control["name"], control["initial"])
            print(f"{name:10} page loaded {min(loads):5.0f} ms, figures ready {min(readies):5.0f} ms;"
                  f" slider median {statistics.median(taken):6.2f} ms, most {max(taken):6.2f} ms")


if __name__ == "__main__":
    paths = [argument for argument in sys.argv[1:] if os.path.exists(argument)]
    sys.argv = [argument for argument in sys.argv if argument not in paths[:3]]
    BOOK, LIBRARY, MALUS = (os.path.abspath(path) for path in (*paths, *(BOOK, LIBRARY, MALUS)[len(paths):]))
    unittest.TestCase.maxDiff = None
    if sys.argv[1:] == ["--times"]:
        times()
    else:
        unittest.main()
