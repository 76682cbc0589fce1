#!/usr/bin/python3
"""Matrices of copper from Python, beside what nobody can do without, taking turns in one process. Run by make bench."""
import os
import statistics
import time
from collections.abc import Callable

import numpy as np

import malus

COUNT, TURNS = 1_000_000, 9
COPPER = {"n": 0.405, "k": 2.950, "sigma": 0.2}


def milliseconds(task: Callable[[], object]) -> tuple[float, float]:
    """Of the wall's clock, and of all processors."""
    wall, busy = time.perf_counter(), time.process_time()
    task()
    return 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - busy)


def main() -> None:
    rng = np.random.default_rng(2002)
    angles = [rng.uniform(0, 89, COUNT), rng.uniform(0, 89, COUNT), rng.uniform(-360, 360, COUNT)]
    few = np.linspace(0, 89, 100)
    lattice = [few[:, None, None], few[:, None], 4 * few]
    radians = np.deg2rad(angles[2])
    tasks: dict[str, Callable[[], object]] = {
        "a million matrices of copper, angles at random": lambda: malus.brdf("torrance-sparrow", *angles, **COPPER),
        "a lattice of 100 x 100 x 100 angles": lambda: malus.brdf("torrance-sparrow", *lattice, **COPPER),
        "a million matrices of a matt surface": lambda: malus.brdf("lambertian", *angles, reflectance=0.3),
        "their 128 MB of new memory, filled by NumPy": lambda: np.empty((COUNT, 4, 4)).fill(1),
        "six million cosines and sines by NumPy": lambda: [(np.cos(radians), np.sin(radians)) for _ in range(3)],
        "a million exponentials by NumPy": lambda: np.exp(radians),
    }
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in tasks}
    for _ in range(TURNS):
        for name, task in tasks.items():
            times[name].append(milliseconds(task))
    print(f"malus from Python, {len(os.sched_getaffinity(0))} processors, medians of {TURNS} turns")
    print(f"{'':50s} {'wall ms':>8s} {'CPU ms':>8s} {'least CPU':>10s}")
    for name, pairs in times.items():
        wall, busy = (statistics.median(column) for column in zip(*pairs))
        print(f"{name:50s} {wall:8.1f} {busy:8.1f} {min(pair[1] for pair in pairs):10.1f}")
    calls = 2000
    wall, _ = milliseconds(lambda: [malus.brdf("torrance-sparrow", 30, 40, 180, **COPPER) for _ in range(calls)])
    print(f"{'one call for one matrix':50s} {1e3 * wall / calls:8.1f} us")


if __name__ == "__main__":
    main()
