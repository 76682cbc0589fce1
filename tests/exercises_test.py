#!/usr/bin/python3
"""The solutions of the exercises: every number that a command of theirs gives is the program's.

Usage: exercises_test.py MALUS.  Regression: a solution quotes what `malus` prints today, rounded as the book has it.
Negative control: the same number with its last digit changed is not in the book.
"""
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MALUS = sys.argv.pop() if len(sys.argv) > 1 else "malus"
COPPER = ["n=0.405", "k=2.950", "sigma=0.2"]


def run(*arguments: str) -> str:
    return subprocess.run([MALUS, *arguments], capture_output=True, text=True, check=True).stdout


def last_row(text: str) -> dict[str, str]:
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    return dict(zip(rows[0], rows[-1]))


def facets(parameters: list[str], *flags: str) -> dict[str, float]:
    """The output of `malus brdf` for the model of Torrance and Sparrow."""
    settings = [flag for parameter in parameters for flag in ("--param", parameter)]
    row = last_row(run("brdf", "--model", "torrance-sparrow", *settings, *flags, "--format", "csv"))
    return {name: float(value) for name, value in row.items()}


def matrix(parameters: list[str], theta_i: float, theta_r: float, phi: float = 180) -> dict[str, float]:
    return facets(parameters, "--theta-i-deg", str(theta_i), "--theta-r-deg", str(theta_r), "--phi-deg", str(phi))


def brdf(parameters: list[str], theta_i: float, theta_r: float) -> tuple[float, float]:
    """f00 and the DoLP of unpolarised light after reflection in the plane of incidence."""
    row = matrix(parameters, theta_i, theta_r)
    return row["f00"], abs(row["f10"]) / row["f00"]


def dhr(parameters: list[str], theta_i: float) -> float:
    return facets(parameters, "--dhr", "--theta-i-deg", str(theta_i))["dhr"]


def grid_excess(rays: int) -> float:
    """Per cent of light that the trial of a sampling finds too much, for a list that begins with so many rays."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("chunky-bar-lambertian.json", "chunky-bar.obj"):
            shutil.copy(os.path.join(ROOT, "scenes", name), folder)
        scene = os.path.join(folder, "chunky-bar-lambertian.json")
        with open(scene, encoding="utf-8") as file:
            text = file.read()
        changed = text.replace('"rays": [91, 1]', f'"rays": [{rays}, 1]')
        if (changed == text) != (rays == 91):
            raise AssertionError("the scene does not have 91 rays")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(changed)
        note = re.search(r"shows ([\d.]+) % too much", run("render", scene, "--dry-run", "--out", os.path.join(folder, "out")))
        if not note:
            raise AssertionError("no note on the sampling")
        return float(note[1])


def zenith(*flags: str) -> tuple[float, float]:
    """I and Q at the zenith with the sun 60 degrees from it."""
    row = last_row(run("sky", *flags, "--mu0", "0.5", "--mu", "1"))
    return float(row["I"]), float(row["Q"])


def sun_zenith(time: str) -> float:
    """Zenith angle in degrees over Rochester on the day of section 7.8."""
    return float(last_row(run("sun", "--latitude-deg", "43.16", "--longitude-deg", "-77.61",
                              "--time", f"2001-06-04T{time}:00-04:00"))["zenith_deg"])


def exercises(chapter: str) -> str:
    """The text of a chapter's exercises; the chapter as "surface/Fresnel", or by its name if it is of the thesis."""
    with open(os.path.join(ROOT, "nw", chapter if "/" in chapter else "thesis/" + chapter) + ".nw", encoding="utf-8") as file:
        return file.read().split("\\section{Exercises}", 1)[1]


class Solutions(unittest.TestCase):
    def quoted(self, chapter: str, value: float, decimals: int) -> None:
        text = exercises(chapter)
        numbers = re.findall(r"(?<![\d.])\d+(?:\.\d+)?(?![\d.]*\d)", text)
        number = f"{value:.{decimals}f}"
        self.assertIn(number, numbers, chapter)
        wrong = f"{value + 3 * 10.0**-decimals:.{decimals}f}"
        self.assertNotIn(wrong, numbers, f"{chapter}: the control")

    def test_smooth_boundary(self) -> None:
        glass = ["n=1.5", "k=0", "sigma=0.001", "diffuse=none"]
        self.quoted("surface/Fresnel", dhr(glass, 0), 3)
        self.quoted("surface/Fresnel", dhr(glass, 56.31), 3)
        principal = matrix([*COPPER, "diffuse=none"], 73, 73)
        self.quoted("surface/Fresnel", principal["f22"] / principal["f00"], 3)
        self.quoted("surface/Fresnel", principal["f23"] / principal["f00"], 3)
        inside = matrix(["n=0.66225", "k=0", "sigma=0.1", "diffuse=none"], 54.62, 54.62)
        self.quoted("surface/Fresnel", inside["f22"] / inside["f00"], 3)
        self.quoted("surface/Fresnel", inside["f23"] / inside["f00"], 3)

    def test_microfacets(self) -> None:
        mirror = ["n=1", "k=1e6", "sigma=0.2", "diffuse=none"]
        self.quoted("surface/Microfacets", matrix(mirror, 45, 45, 90)["f00"], 4)
        hidden = matrix([*mirror, "shadowing=v-groove"], 45, 85)["f00"]
        bare = matrix([*mirror, "shadowing=none"], 45, 85)["f00"]
        self.quoted("surface/Microfacets", hidden, 3)
        self.quoted("surface/Microfacets", bare, 3)
        self.quoted("surface/Microfacets", hidden / bare, 3)

    def test_rough_metal(self) -> None:
        facets_alone = matrix([*COPPER, "diffuse=none"], 30, 40)["f00"]
        for theta_i, theta_r in (30, 40), (40, 30):
            f00 = matrix(COPPER, theta_i, theta_r)["f00"]
            self.quoted("surface/BRDFTorranceSparrow", f00, 4)
            self.quoted("surface/BRDFTorranceSparrow", f00 - facets_alone, 4)
            self.quoted("surface/BRDFTorranceSparrow", matrix([*COPPER, "diffuse=reciprocal"], theta_i, theta_r)["f00"], 4)
        invisible = matrix(["n=1", "k=0", "sigma=0.2"], 30, 40)
        self.quoted("surface/BRDFTorranceSparrow", invisible["f00"], 4)
        self.assertLess(invisible["f10"], 1e-300)
        self.quoted("surface/BRDFTorranceSparrow", dhr(["n=1", "k=1e6", "sigma=0.2"], 0), 3)

    def test_plate(self) -> None:
        self.quoted("Section71", brdf(COPPER, 30, 30)[0], 3)
        there, dolp = brdf(COPPER, 30, 40)
        self.quoted("Section71", there, 3)
        self.quoted("Section71", 100 * dolp, 1)

    def test_states(self) -> None:
        row = last_row(run("sky", "--wavelength-nm", "450", "--albedo", "0", "--mu0", "0.5", "--mu", "0.5", "--phi-deg", "90"))
        total, q, u = (float(row[name]) for name in "IQU")
        linear = math.hypot(q, u)
        chapter = "light/CDPolarimetricMath"
        for value in (total, abs(q), u):
            self.quoted(chapter, value, 5)
        self.quoted(chapter, linear / total, 3)
        self.quoted(chapter, math.degrees(math.atan2(u, q)), 1)
        self.quoted(chapter, math.degrees(math.atan2(u, q)) / 2, 1)
        self.quoted(chapter, (total + linear) / 2, 4)
        self.quoted(chapter, (total - linear) / 2, 4)

    def test_sums(self) -> None:
        self.quoted("render/Radiometry", grid_excess(91), 1)
        self.quoted("render/Radiometry", grid_excess(21), 1)
        flags = [flag for parameter in COPPER for flag in ("--param", parameter)]
        row = last_row(run("brdf", "--model", "torrance-sparrow", *flags, "--theta-i-deg", "30", "--theta-r-deg", "40",
                           "--phi-deg", "180", "--format", "csv"))
        polarizes, turns = float(row["f10"]) / float(row["f00"]), -float(row["f32"]) / float(row["f00"])
        self.quoted("render/Radiometry", polarizes, 3)
        self.quoted("render/Radiometry", turns, 3)
        self.quoted("render/Radiometry", polarizes * turns, 4)

    def test_air(self) -> None:
        light, polarized = zenith("--tau", "0.01", "--depolarization", "0", "--albedo", "0")
        self.quoted("air/RayleighLight", light, 6)
        self.quoted("air/RayleighLight", polarized / light, 3)
        fluxes = [last_row(run("sky", "--tau", "0.5", "--depolarization", "0", "--albedo", albedo, "--mu0", "0.5", "--fluxes"))
                  for albedo in ("0", "0.3")]
        direct, black, bright = (float(fluxes[0]["flux_direct"]), *(float(row["flux_down"]) for row in fluxes))
        factor = (direct + bright) / (direct + black)
        for value in (direct, black, bright):
            self.quoted("air/RayleighLight", value, 4)
        self.quoted("air/RayleighLight", factor, 3)
        self.quoted("air/RayleighLight", (1 - 1 / factor) / 0.3, 3)

    def test_glass(self) -> None:
        glass = ["n=1.5", "k=0"]
        self.quoted("Section72", brdf([*glass, "sigma=0.05", "diffuse=none"], 45, 45)[0], 2)
        bare, bare_dolp = brdf([*glass, "sigma=0.1", "diffuse=none"], 45, 45)
        diffuse, diffuse_dolp = brdf([*glass, "sigma=0.1"], 45, 45)
        self.quoted("Section72", bare, 5)
        self.quoted("Section72", diffuse, 5)
        self.quoted("Section72", bare_dolp, 4)
        self.quoted("Section72", diffuse_dolp, 4)

    def test_aluminium(self) -> None:
        aluminium = ["n=1.304", "k=7.479", "sigma=0.2"]
        for view in (65, 80):
            self.quoted("Section74", 100 * brdf([*aluminium, "diffuse=none"], 5, view)[1], 1)
            self.quoted("Section74", 100 * brdf(aluminium, 5, view)[1], 1)
        facets = brdf([*COPPER, "diffuse=none"], 30, 40)[0]
        there, back = brdf(COPPER, 30, 40)[0], brdf(COPPER, 40, 30)[0]
        for value in (there, back, there - back, there - facets, back - facets):
            self.quoted("Section74", value, 5)

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

    def test_sun(self) -> None:
        self.quoted("Section78", sun_zenith("13:09"), 2)
        morning = sun_zenith("10:00")
        self.quoted("Section78", morning, 2)
        self.quoted("Section78", morning / 2, 2)
        slope = math.tan(math.radians(morning / 2))
        self.quoted("Section78", slope, 3)
        self.quoted("Section78", math.exp(-slope**2 / (2 * 0.1**2)), 4)
        self.quoted("Section78", math.exp(-slope**2 / (2 * 0.3**2)), 2)

    def test_the_year_of_the_sun(self) -> None:
        def rochester(time: str) -> dict[str, float]:
            row = last_row(run("sun", "--latitude-deg", "43.16", "--longitude-deg", "-77.61", "--time", time))
            return {name: float(row[name]) for name in ("zenith_deg", "azimuth_deg", "distance_au")}

        june = rochester("2001-06-21T17:12:15Z")
        self.quoted("air/Sun", june["zenith_deg"], 2)
        self.quoted("air/Sun", june["azimuth_deg"], 2)
        self.quoted("air/Sun", rochester("2001-12-21T17:08:30Z")["zenith_deg"], 2)
        self.quoted("air/Sun", rochester("2001-06-21T17:13:15Z")["azimuth_deg"], 2)
        near, far = (rochester(f"2001-0{month}-04T17:00:00Z")["distance_au"] for month in (1, 7))
        self.quoted("air/Sun", near, 4)
        self.quoted("air/Sun", far, 4)
        self.quoted("air/Sun", (far / near) ** 2, 3)

    def test_sensor(self) -> None:
        x = 0.787
        self.assertAlmostEqual(math.sin(x) / x, 0.9, delta=5e-4)  # x has three digits
        self.quoted("render/Sensor", 2 * x / math.pi, 3)
        self.quoted("render/Sensor", 1000 * 2 * x / math.pi * 10 / (2 * 1000), 1)
        blue, q_blue = zenith("--wavelength-nm", "450", "--albedo", "0")
        red, q_red = zenith("--wavelength-nm", "700", "--albedo", "0")
        for number in (blue, q_blue, red, q_red):
            self.quoted("render/Sensor", number, 4)
        self.quoted("render/Sensor", q_blue / blue, 3)
        self.quoted("render/Sensor", q_red / red, 3)
        self.quoted("render/Sensor", (q_blue + q_red) / (blue + red), 3)
        self.quoted("render/Sensor", (q_blue / blue + q_red / red) / 2, 3)

    def test_minnaert(self) -> None:
        law = ["--param", "reflectance=0.3", "--param", "exponent=1.3"]
        row = last_row(run("brdf", "--model", "minnaert", *law, "--theta-i-deg", "0", "--theta-r-deg", "0",
                           "--phi-deg", "0", "--format", "csv"))
        self.quoted("surface/BRDFMinnaert", float(row["f00"]), 4)

    def test_mie(self) -> None:
        def spheres(*flags: str) -> dict[str, float]:
            return {name: float(value) for name, value in last_row(run("mie", *flags)).items() if value}

        grain = [spheres("--n", "1.5", "--radius-um", "0.01", "--wavelength-nm", nm)["Q_sca"] for nm in ("550", "400")]
        self.quoted("air/Mie", 1e5 * grain[0], 3)
        self.quoted("air/Mie", 1e5 * grain[1], 2)
        self.quoted("air/Mie", grain[1] / grain[0], 2)
        for size in ("100", "450"):
            self.quoted("air/Mie", spheres("--n", "1.33", "--x", size)["Q_ext"], 2)
        self.quoted("air/Mie", spheres("--n", "1.5", "--k", "1", "--x", "100")["Q_abs"], 2)

    def test_haze(self) -> None:
        sky = ["--wavelength-nm", "550", "--albedo", "0.1"]
        clear, q_clear = zenith(*sky)
        thin, q_thin = zenith(*sky, "--aerosol", "maritime", "--aerosol-tau", "0.1")
        hazy, q_hazy = zenith(*sky, "--aerosol", "maritime", "--aerosol-tau", "0.3")
        for degree in (q_clear / clear, q_thin / thin, q_hazy / hazy):
            self.quoted("air/AerosolSky", degree, 2)
        for number in (clear, q_clear, hazy, q_hazy):
            self.quoted("air/AerosolSky", number, 4)


if __name__ == "__main__":
    unittest.main()
