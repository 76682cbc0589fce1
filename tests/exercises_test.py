#!/usr/bin/python3
"""The solutions of the exercises: every number that a command of theirs gives is the program's.

Usage: exercises_test.py MALUS.  Regression: a solution quotes what `malus` prints today, rounded as the book has it.
Negative control: the same number with its last digit changed is not in the book.
"""
import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MALUS = sys.argv.pop() if len(sys.argv) > 1 else "malus"
COPPER = ["n=0.405", "k=2.950", "sigma=0.2"]


def run(*arguments: str) -> str:
    return subprocess.run([MALUS, *arguments], capture_output=True, text=True, check=True).stdout


def last_row(text: str) -> dict[str, str]:
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    return dict(zip(rows[0], rows[-1]))


def brdf(parameters: list[str], theta_i: float, theta_r: float) -> tuple[float, float]:
    """f00 and the DoLP of unpolarised light after reflection in the plane of incidence."""
    flags = [flag for parameter in parameters for flag in ("--param", parameter)]
    row = last_row(run("brdf", "--model", "torrance-sparrow", *flags, "--theta-i-deg", str(theta_i),
                       "--theta-r-deg", str(theta_r), "--phi-deg", "180", "--format", "csv"))
    f00, f10 = float(row["f00"]), float(row["f10"])
    return f00, abs(f10) / f00


def zenith(*flags: str) -> tuple[float, float]:
    """I and Q at the zenith with the sun 60 degrees from it."""
    row = last_row(run("sky", *flags, "--mu0", "0.5", "--mu", "1"))
    return float(row["I"]), float(row["Q"])


def exercises(chapter: str) -> str:
    with open(os.path.join(ROOT, "nw", "thesis", chapter + ".nw"), encoding="utf-8") as file:
        return file.read().split("\\section{Exercises}", 1)[1]


class Solutions(unittest.TestCase):
    def quoted(self, chapter: str, value: float, decimals: int) -> None:
        text = exercises(chapter)
        numbers = re.findall(r"(?<![\d.])\d+(?:\.\d+)?(?![\d.]*\d)", text)
        number = f"{value:.{decimals}f}"
        self.assertIn(number, numbers, chapter)
        wrong = f"{value + 3 * 10.0**-decimals:.{decimals}f}"
        self.assertNotIn(wrong, numbers, f"{chapter}: the control")

    def test_plate(self) -> None:
        self.quoted("Section71", brdf(COPPER, 30, 30)[0], 3)
        there, dolp = brdf(COPPER, 30, 40)
        self.quoted("Section71", there, 3)
        self.quoted("Section71", 100 * dolp, 1)

    def test_glass(self) -> None:
        glass = ["n=1.5", "k=0"]
        self.quoted("Section72", brdf([*glass, "sigma=0.05", "diffuse=none"], 45, 45)[0], 2)
        bare, bare_dolp = brdf([*glass, "sigma=0.1", "diffuse=none"], 45, 45)
        diffuse, diffuse_dolp = brdf([*glass, "sigma=0.1"], 45, 45)
        self.quoted("Section72", bare, 5)
        self.quoted("Section72", diffuse, 5)
        self.quoted("Section72", bare_dolp, 4)
        self.quoted("Section72", diffuse_dolp, 4)

    def test_zenith(self) -> None:
        light, polarized = zenith("--tau", "1e-6", "--depolarization", "0", "--albedo", "0")
        self.quoted("Section77", polarized / light, 1)
        black, q_black = zenith("--wavelength-nm", "450", "--albedo", "0")
        red, q_red = zenith("--wavelength-nm", "700", "--albedo", "0")
        bright, q_bright = zenith("--wavelength-nm", "450", "--albedo", "0.5")
        self.quoted("Section77", q_black / black, 2)
        self.quoted("Section77", q_red / red, 2)
        self.quoted("Section77", q_bright / bright, 2)
        self.quoted("Section77", black, 4)
        self.quoted("Section77", bright, 4)
        # the digits that the book guarantees: fourteen of two sums in another order
        self.assertAlmostEqual(q_bright / q_black, 1, delta=1e-14)


if __name__ == "__main__":
    unittest.main()
