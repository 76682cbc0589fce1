"""Common code of the tests of the Python module: the program beside it, and random numbers that are the same each time."""
import csv
import io
import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

Array = npt.NDArray[Any]

PROGRAM = os.environ.get("MALUS_PROGRAM", "build/malus")


def run_malus(*words: object) -> str:
    """The output of the program; an error of the program is one of the test."""
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def table(text: str) -> dict[str, list[str]]:
    """The columns of a table of the program, as texts."""
    rows = list(csv.DictReader(io.StringIO("".join(line + "\n" for line in text.splitlines() if not line.startswith("#")))))
    return {name: [row[name] for row in rows] for name in rows[0]}


def numbers(text: str, *columns: str) -> Array:
    """Columns of a table as float64, one behind the other in the last axis."""
    columns_of = table(text)
    return np.stack([np.array(columns_of[name], dtype=float) for name in columns], axis=-1)


def complaint(*words: object) -> str:
    """The one line that the program refuses with."""
    done = subprocess.run([PROGRAM, *map(str, words)], check=False, capture_output=True, text=True)
    assert done.returncode == 2, done
    return done.stderr.strip()


def sentence(message: str) -> str:
    """A message without the place before it, which is another in Python."""
    return message.split(": ", 2)[-1]


def seconds_after_ctrl_c(work: Callable[[], object], after_s: float = 0.3) -> float:
    """How long work goes on after a Ctrl-C, which comes from outside as it does from a terminal."""
    times = [0.0]

    def press() -> None:
        times[0] = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)
    finger = threading.Timer(after_s, press)
    finger.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
        return time.monotonic() - times[0]
    finally:
        finger.cancel()
        finger.join()


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2002)
