#!/usr/bin/python3
"""What a build from an empty directory costs, part by part, without a compiler cache.

    build.py BUILD JOBS

Builds into BUILD, which is emptied before. For each part it prints the CPU seconds
of all its processes and the seconds on the clock; at the end the 15 files that took
the compiler longest, as Ninja's log has them. CPU seconds depend little on JOBS and
on the machine's other work, seconds on the clock much: measure on an idle machine.
"""
import os
import resource
import shutil
import subprocess
import sys
import time

# in the order of the build: a part has only what those before it have not made
PARTS = (("library", ["libmalus", "libmalus_scenes"]), ("programs", ["malus", "mathtester"]), ("reproduce", ["reproduce"]),
         ("weave", ["book"]), ("tests", ["all"]))
SLOWEST = 15


def cpu_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def measured(command: list[str]) -> tuple[float, float]:
    """(CPU seconds, seconds) of a command; what it prints is shown only if it fails."""
    cpu, start = cpu_seconds(), time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env={**os.environ, "CCACHE_DISABLE": "1"})
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stdout}")
    return cpu_seconds() - cpu, time.monotonic() - start


def slowest(log: str) -> list[tuple[float, str]]:
    """[(seconds, file)] of the objects in a Ninja log, longest first; the last line of a file counts."""
    seconds: dict[str, float] = {}
    with open(log, encoding="utf-8") as lines:
        for line in lines:
            if not line.startswith("#"):
                start, end, _, output, _ = line.rstrip("\n").split("\t")
                if output.endswith((".o", ".gch", ".pch")):
                    seconds[output] = (int(end) - int(start)) / 1000
    return sorted(((value, output) for output, value in seconds.items()), reverse=True)[:SLOWEST]


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    build, jobs = sys.argv[1:]
    shutil.rmtree(build, ignore_errors=True)
    rows = [("configure", *measured(["cmake", "--preset", "release", "-B", build, "-G", "Ninja"]))]
    rows += [(name, *measured(["cmake", "--build", build, "-j", jobs, "--target", *targets])) for name, targets in PARTS]
    rows.append(("all", sum(cpu for _, cpu, _ in rows), sum(clock for _, _, clock in rows)))
    print(f"{'part':12}{'CPU s':>8}{'clock s':>9}   (-j {jobs})")
    for name, cpu, clock in rows:
        print(f"{name:12}{cpu:8.0f}{clock:9.0f}")
    print(f"\nThe {SLOWEST} slowest files, seconds on the clock:")
    for seconds, output in slowest(os.path.join(build, ".ninja_log")):
        print(f"{seconds:8.1f}  {output}")


main()
