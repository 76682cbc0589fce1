#!/usr/bin/python3
"""Measure the cost of a ray in a large world: the town of scenes/town.py with shared meshes, with all triangles written out, and at 10^9.

    worlds.py MALUS [OUT.csv]

Renders the same picture of the three, and prints CPU seconds a ray, those to begin taken off, and the largest memory of the process. Least of
three runs each, by turns. With OUT.csv it writes the record that item X.worlds reads (validation/worlds.csv is one).
"""
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile

TOWN = pathlib.Path(__file__).resolve().parents[2] / "scenes" / "town.py"
SMALL, LARGE, TURNS = 3e6, 1e9, 3
WORLDS = (("shared", SMALL, True), ("written out", SMALL, False), ("shared", LARGE, True))


def town(work: pathlib.Path, triangles: float, shared: bool) -> pathlib.Path:
    out = work / f"town-{triangles:.0f}-{shared}"
    command = [str(TOWN), "--out", str(out), "--triangles", str(triangles), *([] if shared else ["--flat"])]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    path = out / "town.json"
    scene = json.loads(path.read_text(encoding="utf-8").split("\n", 1)[1])
    scene["sensor"].update(width=240, height=160)
    scene["platform"]["poses"] = scene["platform"]["poses"][:1]
    path.write_text(json.dumps(scene), encoding="utf-8")
    return path


def run(malus: str, path: pathlib.Path, *flags: str) -> tuple[float, float]:
    """CPU seconds, and the largest memory in bytes."""
    out = path.parent / "out"
    subprocess.run(["rm", "-rf", str(out)], check=True)
    command = [malus, "render", str(path), "--out", str(out), *flags]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"worlds.py: malus render {path} ends with {process.returncode}")
    return used.ru_utime + used.ru_stime, 1024.0 * used.ru_maxrss


def followed(path: pathlib.Path) -> int:
    info = json.loads(next((path.parent / "out").glob("**/*run.json")).read_text(encoding="utf-8"))
    return int(info["rays_followed"])


def main() -> None:
    malus = str(pathlib.Path(sys.argv[1]).resolve())
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        paths = [town(pathlib.Path(folder), triangles, shared) for _, triangles, shared in WORLDS]
        best = [[float("inf")] * 3 for _ in paths]
        for _ in range(TURNS):
            for path, least in zip(paths, best):
                begin, _ = run(malus, path, "--dry-run")
                whole, memory = run(malus, path, "--write", "cube,truth")
                least[0], least[1], least[2] = min(least[0], begin), min(least[1], whole), min(least[2], memory)
        for (kind, _, _), path, (begin, whole, memory) in zip(WORLDS, paths, best):
            info = json.loads(subprocess.run([malus, "info", "--json", str(path)], check=True, capture_output=True, text=True).stdout)
            rays = followed(path)
            each = 1e9 * (whole - begin) / rays
            rows.append((kind, info["triangles"], info["instances"], f"{begin:.2f}", f"{memory:.0f}", rays, f"{each:.1f}"))
            print(f"{kind:12} {info['triangles']:>12} triangles, {memory / 2**20:8.0f} MiB, {begin:6.2f} s to begin, {each:8.1f} ns a ray")
    if len(sys.argv) > 2:
        header = ("# title: Cost of a picture of 240 x 160 pixels of a town: shared meshes, written out, and a billion triangles\n"
                  f"# source: tests/bench/worlds.py, CPU seconds and memory of malus render, least of {TURNS} runs each\n"
                  f"# date: {datetime.date.today()}\n"
                  "kind,triangles,instances,begin_s,memory_bytes,rays,ns_per_ray\n")
        pathlib.Path(sys.argv[2]).write_text(header + "".join(",".join(map(str, row)) + "\n" for row in rows), encoding="utf-8")


if __name__ == "__main__":
    main()
