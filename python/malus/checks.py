"""Arguments that malus cannot use, refused in the program's manner: one line with function, argument, value and remedy."""
import json
import os
import re
import reprlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

_BRIEF = reprlib.Repr()
_BRIEF.maxother = _BRIEF.maxstring = _BRIEF.maxlong = 60
MOST_NESTED = 100  # objects and lists of a scene in one another


def refusal(function: str, name: str, value: object, problem: str, remedy: str) -> ValueError:
    """The exception to raise. Quotation marks show the type of a value: '2' is not 2."""
    shown = " ".join(_BRIEF.repr(value).split())
    return ValueError(f"malus.{function}: {name} = {shown}: {problem}; {remedy}")


def text(function: str, name: str, value: object, remedy: str) -> str:
    """A word."""
    if not isinstance(value, str):
        raise refusal(function, name, value, f"is of the type {type(value).__name__}", remedy)
    return value


def _item(value: Any) -> Any:
    """The value of an array without axes, unless it is masked."""
    return value.item() if isinstance(value, np.ndarray) and value.ndim == 0 and not _masked(value) else value


def _masked(value: Any) -> bool:
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.is_masked(value))  # type: ignore[no-untyped-call]


def number(function: str, name: str, value: Any, low: float, high: float, remedy: str, unit: str = "") -> float:
    """One real number from low to high; no NaN."""
    value = _item(value)
    if not isinstance(value, int | float | np.integer | np.floating):
        raise refusal(function, name, value, "is not one number", remedy)
    if isinstance(value, int) and abs(value) >= 2**1000:
        raise refusal(function, name, value, "is larger than any number of 64 bits", remedy)
    if not low <= value <= high:
        limits = f"{low:g} to {high:g}" if high < np.inf else f"{low:g} or more"
        raise ValueError(f"malus.{function}: {name} = {float(value):g}{unit}: must be {limits}; {remedy}")
    return float(value)


def whole(function: str, name: str, value: Any, low: int, high: int, remedy: str) -> int:
    """One whole number from low to high."""
    value = _item(value)
    if not isinstance(value, int | np.integer):
        raise refusal(function, name, value, "is not a whole number", remedy)
    if not low <= value <= high:
        raise refusal(function, name, int(value), "does not exist", remedy)
    return int(value)


def tolerance(function: str, value: Any) -> float:
    return number(function, "tolerance", value, 0, np.inf, "give a number such as 1e-12")


def path(function: str, name: str, value: Any, remedy: str) -> str:
    """The name of a file."""
    if not isinstance(value, str | bytes | os.PathLike):
        raise refusal(function, name, value, f"is of the type {type(value).__name__}", remedy)
    return os.fsdecode(value)


def array(function: str, name: str, given: Any) -> npt.NDArray[Any]:
    """An array of any type, in which nothing is hidden."""
    if _masked(given):
        raise ValueError(f"malus.{function}: {name}: has masked elements; fill them, with .filled(np.nan) for holes")
    try:
        return np.asarray(given)
    except ValueError:
        raise ValueError(f"malus.{function}: {name}: is not an array, because its rows have different lengths; "
                         "give rows of one length") from None


def axis(function: str, name: str, given: Any) -> npt.NDArray[np.float64]:
    """A number or an array with one axis; finite numbers, of which there is one at least."""
    values = array(function, name, given)
    if values.dtype.kind not in "fiub":
        raise ValueError(f"malus.{function}: {name}: does not hold real numbers; give a number or an array with one axis")
    if values.ndim > 1:
        raise ValueError(f"malus.{function}: {name}: has the shape {values.shape}; give a number or an array with one axis")
    if not values.size:
        raise ValueError(f"malus.{function}: {name}: has no number; give at least one")
    bad = values[~np.isfinite(values)]
    if bad.size:
        raise ValueError(f"malus.{function}: {name} = {bad.flat[0]:g}: is not a finite number; the axes of a dataset have no holes")
    return values.astype(np.float64).reshape(-1)


def elements(function: str, name: str, given: Any, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """Real numbers whose last axes have this shape."""
    values = array(function, name, given)
    if values.dtype.kind not in "fiub":
        raise ValueError(f"malus.{function}: {name}: does not hold real numbers; give a number or an array")
    if values.shape[-len(shape):] != shape:
        raise ValueError(f"malus.{function}: {name}: has the shape {values.shape}; give an array whose last two axes are a 4 x 4 matrix")
    return values


def stokes_axis(function: str, stokes: xr.DataArray) -> None:
    if "stokes" not in stokes.dims:
        raise ValueError(f"malus.{function}: stokes: is a DataArray without a dimension stokes; it has "
                         f"{', '.join(map(str, stokes.dims)) or 'none'}; rename one of them")


def scene(value: Any, at: str = "", depth: int = 0) -> Any:
    """A scene as JSON: NumPy's numbers and arrays, and paths, become plain values. `at` is the path of a key."""
    if isinstance(value, np.ndarray | np.generic):
        value = array("render", f"scene: {at}", value).tolist()
    if isinstance(value, os.PathLike):
        value = os.fsdecode(value)
    if isinstance(value, Mapping | list | tuple) and depth > MOST_NESTED:
        raise ValueError(f"scene: {at[:60]}...: is nested more than {MOST_NESTED} deep; give an object that does not contain itself")
    if isinstance(value, Mapping):
        return {_key(name, at): scene(one, _below(at, name), depth + 1) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [scene(one, f"{at}[{i}]", depth + 1) for i, one in enumerate(value)]
    if isinstance(value, float) and not np.isfinite(value):
        raise ValueError(f"scene: {at} = {value}: is not a finite number; give one")
    if value is None or isinstance(value, str | int | float):
        return value
    raise ValueError(f"scene: {at} = {' '.join(_BRIEF.repr(value).split())}: is of the type {type(value).__name__}; "
                     "give a text, a number, a list or a dictionary")


def _below(at: str, name: object) -> str:
    """The path of a key, as the program writes it."""
    if re.fullmatch(r"[\w$-]+", str(name)):
        return f"{at}.{name}" if at else str(name)
    return f"{at}[{json.dumps(str(name), ensure_ascii=False)}]"


def _key(name: object, at: str) -> str:
    if isinstance(name, str):
        return name
    raise ValueError(f"scene: {at + ': ' if at else ''}the key {' '.join(_BRIEF.repr(name).split())} is not a text; give keys as texts")


def frames(wanted: Any) -> list[int]:
    """Numbers of frames, each once; none for all."""
    if wanted is None:
        return []
    remedy = "give frames of the scene, which are counted from 0"
    several = isinstance(wanted, Iterable) and not isinstance(wanted, str) and not (isinstance(wanted, np.ndarray) and wanted.ndim == 0)
    numbers = [whole("render", "frames", one, -2**62, 2**62, remedy) for one in (wanted if several else [wanted])]
    if not numbers:
        raise ValueError("malus.render: frames: has no frame; give at least one, or leave it out")
    for i, one in enumerate(numbers):
        if one in numbers[:i]:
            raise ValueError(f"malus.render: frames = {one}: is given twice; give each frame once")
    return numbers
