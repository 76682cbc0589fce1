#!/usr/bin/python3
"""Measure whole commands with all their files, on the copper chunky bar.

    commands.py MALUS [OUT.csv]

Looks for the fewest rays from the first surface whose error of S0 (rms over mean, against a picture with many) is
below a peer's, and prints for each command the least seconds on the clock of some runs, the CPU seconds of that run,
and the seconds that were aimed at. Of the aimed-at errors it also times the cube alone, without pictures, truth and products.
With OUT.csv it writes the same as a record (validation/commands.csv is one).

Then the parking lot, to 2 % in each pixel: by --until, and by so many batches of every pixel that the worst has it. The latter
takes minutes, so their number is computed from the errors of 520 batches, and their time from that of one.
"""
import datetime
import math
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import numpy.typing as npt

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"
NAN = float("nan")
SCENE = SCENES / "chunky-bar-copper.json"
TURNS = 5
RAYS = (2, 3, 4, 5, 6, 7, 9, 12, 17, 25, 33)
ERRORS = ((0.167, 0.12, "band1"), (0.116, 0.15, "band1Finer"))  # of S0, the seconds aimed at, the name in the record


def scene(work: pathlib.Path, side: int, bands: int, rays: int, seed: int = 1) -> pathlib.Path:
    """The bar with so many pixels each way, bands, and rays from the first surface, the sun's included."""
    text = SCENE.read_text(encoding="utf-8")
    patches = ((r'"sampling": "grid-rotated", "rays": \[91, 1\], "seed": 1', f'"sampling": "importance", "rays": [{rays}, 2], "seed": {seed}'),
               (r'"wavelength_nm": \[550\]', f'"wavelength_nm": {[500 + i for i in range(bands)]}'),
               (r'"width": 256, "height": 256', f'"width": {side}, "height": {side}'),
               (r'"pixel_pitch_um": 39.0625', f'"pixel_pitch_um": {10000 / side}'),
               (r'"chunky-bar.obj"', f'"{SCENES / "chunky-bar.obj"}"'))
    for old, new in patches:
        text, count = re.subn(old, new, text)
        assert count == 1, old
    path = work / f"bar-{side}-{bands}-{rays}.json"
    path.write_text(text, encoding="utf-8")
    return path


def render(malus: str, path: pathlib.Path, *flags: str) -> tuple[float, float]:
    """(seconds, CPU seconds) of the command, into a directory that it makes."""
    out = path.with_suffix("")
    subprocess.run(["rm", "-rf", str(out)], check=True)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([malus, "render", str(path), "--out", str(out), *flags], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    seconds, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def first_preview(malus: str, path: pathlib.Path) -> tuple[float, float]:
    """Seconds until --progressive shows a picture, and until the command ends."""
    out = path.with_suffix("")
    subprocess.run(["rm", "-rf", str(out)], check=True)
    start = time.monotonic()
    command = [malus, "render", str(path), "--out", str(out), "--progressive"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None and not (out / f"{path.stem}.preview.png").exists():
            time.sleep(0.002)
        seconds = time.monotonic() - start
    return seconds, time.monotonic() - start


def s0(path: pathlib.Path) -> npt.NDArray[np.float64]:
    cube = np.fromfile(path.with_suffix("") / f"{path.stem}.img", "<f4")
    return cube.reshape(-1, 4)[:, 0].astype(float)


def best(malus: str, path: pathlib.Path, *flags: str) -> tuple[float, float]:
    return min(render(malus, path, *flags) for _ in range(TURNS))


def relative_errors(path: pathlib.Path, bands: int) -> npt.NDArray[np.float64]:
    """Standard error of S0 over S0 of each pixel, in the band where it is largest; of pixels with light in all bands."""
    def channels(name: str) -> npt.NDArray[np.float64]:
        header = (path.with_suffix("") / f"{name}.img.hdr").read_text(encoding="utf-8")
        found = re.search(r"^bands = (\d+)$", header, flags=re.M)
        assert found and "interleave = bip" in header
        cube = np.fromfile(path.with_suffix("") / f"{name}.img", "<f4").reshape(-1, int(found[1]))
        return cube[:, 0:4 * bands:4].astype(float)
    light, errors = channels(path.stem), channels(f"{path.stem}.error")
    lit = (light > 0).all(axis=1)
    worst: npt.NDArray[np.float64] = (errors[lit] / light[lit]).max(axis=1)
    return worst


def parking_lot(work: pathlib.Path) -> pathlib.Path:
    """The lot with 24 x 16 pixels, its meshes made anew."""
    path = work / "lot.json"
    subprocess.run([SCENES / "parking-lot.py", "--out", work / "meshes", "--scene", path], check=True, stdout=subprocess.DEVNULL)
    text = path.read_text(encoding="utf-8")
    for old, new in (('"generated/parking-lot/', f'"{work}/meshes/'), ('"data/', f'"{SCENES}/data/'),
                     ('"width": 480, "height": 320', '"width": 24, "height": 16')):
        assert old in text, old
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path


Rows = list[tuple[str, float, float, float]]  # work, seconds, CPU seconds, seconds aimed at; NaN where it has none


def to_two_percent(malus: str, work: pathlib.Path) -> Rows:
    path = parking_lot(work)
    few = render(malus, path, "--batches", "8")[1]
    many = render(malus, path, "--batches", "520")[1]
    errors = relative_errors(path, 3)
    batch = (many - few) / 512
    evenly = 520 * (errors.max() / 0.02) ** 2 * batch
    until = render(malus, path, "--until", "2%", "--at-most", "100000000")[1] - few + 8 * batch
    reached = relative_errors(path, 3)
    print(f"\nparking lot, 24 x 16 pixels, S0 to 2 % in each: CPU seconds, without those to begin\n"
          f"{'evenly (worst pixel of 520 batches: ' + format(errors.max(), '.2f') + ')':56}{evenly:9.1f}\n"
          f"{'--until 2%':56}{until:9.1f}   ratio {until / evenly:.3f}; above 2 %: {100 * (reached > 0.02).mean():.1f} % of the pixels, "
          f"above 4 %: {100 * (reached > 0.04).mean():.1f} %")
    return [("lotEvenly", NAN, evenly, NAN), ("lotUntil", NAN, until, evenly / 3)]


def write(rows: Rows, path: str) -> None:
    """The record: what chapter "Which sampling" of the book prints as its table of whole commands."""
    head = ("# title: Seconds of whole commands with all their files, copper chunky bar and parking lot\n"
            f"# source: tests/bench/commands.py, {os.cpu_count()} cores\n# date: {datetime.date.today().isoformat()}\n")
    lines = [",".join([work, *("" if math.isnan(number) else f"{number:.3g}" for number in numbers)]) for work, *numbers in rows]
    pathlib.Path(path).write_text(head + "work,clock_s,cpu_s,aim_s\n" + "\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    malus = os.path.abspath(sys.argv[1])
    print(f"\n{'whole commands, copper bar, two reflections':56}{'seconds':>9}{'CPU':>7}{'aim':>7}")

    rows: Rows = []

    def tell(name: str, key: str, path: pathlib.Path, aim: float, *flags: str) -> None:
        seconds, cpu = best(malus, path, *flags)
        print(f"{name:56}{seconds:9.2f}{cpu:7.2f}{aim:7.2f}", flush=True)
        rows.append((key, seconds, cpu, aim))

    with tempfile.TemporaryDirectory() as directory:
        work = pathlib.Path(directory)
        many = scene(work, 256, 1, 513, 4711)
        render(malus, many)
        reference = s0(many)
        errors = {}
        for rays in RAYS:
            path = scene(work, 256, 1, rays)
            render(malus, path)
            errors[rays] = float(np.sqrt(np.mean((s0(path) - reference) ** 2)) / reference.mean())
        for error, aim, key in ERRORS:
            enough = [rays for rays in RAYS if errors[rays] <= error]
            if not enough:
                print(f"the error {error} is not reached by {RAYS[-1]} rays")
                continue
            rays = enough[0]
            tell(f"1 band to the error {error} (it is {errors[rays]:.3f}, {rays} rays)", key, scene(work, 256, 1, rays), aim)
            if error == ERRORS[0][0]:
                tell("the same, only the cube", "band1Cube", scene(work, 256, 1, rays), aim, "--write", "cube")
                tell(f"100 bands to the same error ({rays} rays)", "band100", scene(work, 256, 100, rays), 0.35)
                tell("the same, only the cube", "band100Cube", scene(work, 256, 100, rays), 0.35, "--write", "cube")
        tell("16 x 16 pixels, 1 band: start-up and files", "small", scene(work, 16, 1, 5), 0.05)
        first, _ = min(first_preview(malus, many) for _ in range(TURNS))
        print(f"{'first picture of --progressive, 256 x 256 pixels':56}{first:9.2f}{'':7}{0.1:7.2f}", flush=True)
        rows.append(("preview", first, NAN, 0.1))
        rows += to_two_percent(malus, work)
    if len(sys.argv) == 3:
        write(rows, sys.argv[2])


if __name__ == "__main__":
    main()
