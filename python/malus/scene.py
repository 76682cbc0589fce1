"""Pictures: rendered, or read from cubes."""
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import _malus, checks

Watcher = Callable[[float, str], object]
PIXEL = {"x": {"long_name": "pixel in its row, from the left", "units": "1"},
         "y": {"long_name": "row, from the top", "units": "1"}}


class _Bar:
    """tqdm over a fraction that grows."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.bar = None
        else:
            self.bar = tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}{postfix}")

    def __call__(self, fraction: float, text: str) -> None:
        if self.bar is not None:
            self.bar.set_postfix_str(text, refresh=False)
            self.bar.update(round(100 * fraction, 1) - self.bar.n)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


def _dataset(found: dict[str, Any]) -> xr.Dataset:
    pixels = ("frame", "y", "x")
    variables = {
        "radiance": ((*pixels, "band", "stokes"), found["radiance"],
                     {"units": found["unit"], "long_name": "Stokes radiance", "description": found["description"]}),
        "range_m": (pixels, found["range_m"], {"units": "m", "long_name": "distance to the first hit of a pixel; NaN: the sky"}),
        "facet": (pixels, found["facet"], {"long_name": "number in the attribute facets; -1: the sky"}),
        "material": (pixels, found["material"], {"long_name": "number in the attribute materials; -1: the sky"}),
        "sun_hidden": (pixels, found["sun_hidden"], {"long_name": "whether the first hit is in the sun's shadow"}),
        "rays": (pixels, found["rays"], {"units": "1", "long_name": "rays that were followed"}),
    }
    if "stokes_standard_error" in found:
        variables["stokes_standard_error"] = (
            (*pixels, "band", "stokes"), found["stokes_standard_error"],
            {"units": found["unit"], "long_name": "standard error of the Stokes radiance", "description": found["description"]})
    if "temperature_K" in found:
        variables["temperature_K"] = (pixels, found["temperature_K"],
                                      {"units": "K", "long_name": "temperature of the first hit of a pixel; NaN: the sky, or cold"})
    height, width = found["rays"].shape[1:]
    coordinates = {
        "frame": ("frame", np.array(found["frames"], dtype=np.int64), {"long_name": "number of the frame, from 0"}),
        "time_s": ("frame", np.array(found["time_s"], dtype=np.float64), {"units": "s", "long_name": "time after that of frame 0"}),
        "y": ("y", found["y0"] + np.arange(height), PIXEL["y"]),
        "x": ("x", found["x0"] + np.arange(width), PIXEL["x"]),
        "band": ("band", found["bands"], {"long_name": "name of the band, or its wavelength in nm"}),
        "wavelength_nm": ("band", np.array(found["wavelength_nm"]), {"units": "nm"}),
        "fwhm_nm": ("band", np.array(found["fwhm_nm"]), {"units": "nm", "long_name": "full width at half maximum"}),
        "stokes": ("stokes", ["S0", "S1", "S2", "S3"], {"long_name": "component", "description": found["description"]}),
    }
    attributes = {"title": found["title"], "scene": found["scene"], "seed": found["seed"], "program": f"malus {_malus.__version__}",
                  "facets": found["facets"], "materials": found["materials"]}
    if found["begins"]:
        attributes["begins"] = found["begins"]
    return xr.Dataset(variables, coordinates, attributes)


def _word(value: object) -> str:
    """As the command line would have it."""
    return "" if value is None else str(value)


def render(scene: dict[str, Any] | str | os.PathLike[str], *, frames: int | Iterable[int] | None = None,
           tile: Sequence[int] | None = None, seed: int | None = None, batches: int | None = None,
           until: float | str | None = None, at_most: int | str | None = None, threads: int = 0,
           base: str | os.PathLike[str] | None = None, progress: bool | Watcher = False) -> xr.Dataset:
    """Polarimetric pictures of a scene, in memory.

    Parameters
    ----------
    scene : path or dict
        A scene file, or its content with the same keys (``malus schema`` lists them).
    frames : int or iterable of int, optional
        Frames from 0; all if not given.
    tile : (x0, y0, x1, y1), optional
        Only this part of the picture; x1 and y1 are beyond its end.
    seed : int, optional
        Instead of the scene's.
    batches : int, optional
        Independent estimates of each pixel, of which the picture is the mean; from 2 on with its standard error. 1 if not given.
    until : float or str, optional
        How large the standard error may be: of S0 relative to it (0.01, "1%"), or of the DoLP ("dolp=0.002"). Each pixel gets the
        batches that it needs after the first 32, or `batches`.
    at_most : int or str, optional
        With `until`, rays of a pixel at most, 100000 if not given; "10min": minutes of the call; "100000,10min": both. With minutes the
        picture depends on the machine.
    threads : int
        0 for all processors. The numbers do not depend on it.
    base : path, optional
        Where the files that a dict names are looked for; the current directory if not given.
    progress : bool or callable
        True: a bar, if tqdm is installed. A function is called with a fraction and a line of text, in this thread; what it raises
        stops the render.

    Returns
    -------
    xarray.Dataset
        ``radiance`` (frame, y, x, band, stokes), float32 [W m^-2 sr^-1 nm^-1], with the numbers of ``malus render``'s cube, and the
        truth of each pixel's first ray: ``range_m``, ``facet``, ``material``, ``sun_hidden``, ``rays``, and ``temperature_K`` if
        the weather heats the scene. With several batches also ``stokes_standard_error``, of the shape of ``radiance``.

    Raises
    ------
    ValueError
        With the one line that ``malus render`` prints; a wrong key has its path.
    KeyboardInterrupt
        After Ctrl-C, when the tiles in work are finished.
    """
    wanted = checks.frames(frames)
    folder = "" if base is None else checks.path("render", "base", base, "give the name of a directory")
    if isinstance(scene, Mapping):
        path, text = None, json.dumps(checks.scene(scene))
    else:
        path, text = checks.path("render", "scene", scene, "give the name of a scene file, or a dictionary"), ""
        if not path:
            raise ValueError("malus.render: scene: is empty; give the name of a scene file, or a dictionary")
    if not (progress is None or isinstance(progress, bool | np.bool_) or callable(progress)):
        raise checks.refusal("render", "progress", progress, "is neither True nor False nor a function",
                             "give True for a bar, or a function of a fraction and a text")
    bar = _Bar() if isinstance(progress, bool | np.bool_) and progress else None
    watcher = bar if bar else progress if callable(progress) else None
    try:
        return _dataset(_malus.render(path, text, folder, wanted, tile, seed, threads, watcher,
                                      _word(batches), _word(until), _word(at_most)))
    finally:
        if bar:
            bar.close()


def _numbers_in(description: str, pattern: str, otherwise: Sequence[int]) -> Sequence[int]:
    found = re.search(pattern, description)
    return [int(number) for number in found.groups()] if found else otherwise


def _of_cube(found: dict[str, Any]) -> xr.Dataset:
    """One frame from disk. Frame and first pixel, which the header has in words, become coordinates."""
    data = found["data"]
    height, width = data.shape[:2]
    frame, = _numbers_in(found["description"], r", frame (\d+)", [0])
    x0, y0 = _numbers_in(found["description"], r", pixels from (\d+) (\d+)", [0, 0])
    coordinates = {"frame": ("frame", [frame], {"long_name": "number of the frame, from 0"}),
                   "y": ("y", y0 + np.arange(height), PIXEL["y"]), "x": ("x", x0 + np.arange(width), PIXEL["x"])}
    attributes = {name: found[name] for name in ("description", "time", "map_info") if found[name]}
    components = found["components"]
    if components is None:
        variables = {channel.replace(" ", "_"): (("frame", "y", "x"), data[None, :, :, i]) for i, channel in enumerate(found["channels"])}
        return xr.Dataset(variables, coordinates, attributes)
    each = len(components)
    coordinates["band"] = ("band", [name.split(" ", 1)[-1] for name in found["channels"][::each]], {})
    for name in ("wavelength_nm", "fwhm_nm"):
        if found[name]:
            coordinates[name] = ("band", np.array(found[name][::each]), {"units": "nm"})
    coordinates["stokes"] = ("stokes", [f"S{i}" for i in components], {"long_name": "component"})
    radiance = data.reshape(1, height, width, -1, each)
    return xr.Dataset({"radiance": (("frame", "y", "x", "band", "stokes"), radiance,
                                    {"units": found["unit"], "long_name": "Stokes radiance", "description": found["description"]})},
                      coordinates, attributes)


def _demand_frames(paths: list[str], frames: list[xr.Dataset]) -> None:
    """Frames of one picture: the same pixels, bands and components, and no frame twice."""
    def differ(name: str) -> bool:
        return (name in first.coords) != (name in frame.coords) or name in first.coords and not first[name].equals(frame[name])

    first, seen = frames[0], {frames[0].frame.item(): paths[0]}
    for path, frame in zip(paths[1:], frames[1:]):
        for name in ("y", "x", "band", "stokes"):
            if differ(name):
                raise ValueError(f"malus.open: {path}: has other coordinates {name} than {paths[0]}; open files that are not frames of one "
                                 "picture separately, and put parts together with malus merge")
        number = frame.frame.item()
        if number in seen:
            raise ValueError(f"malus.open: {path}: is frame {number}, as {seen[number]} is; put parts together with malus merge")
        seen[number] = path


def open(cube: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> xr.Dataset:  # pylint: disable=redefined-builtin
    """A cube of malus, or those of several frames, as a dataset.

    Parameters
    ----------
    cube : path, or iterable of paths
        ENVI cubes (``plate.img`` beside ``plate.img.hdr``) or netCDF (``plate.nc``) as ``malus render`` writes them.
        Paths in one call are frames of one picture.

    Returns
    -------
    xarray.Dataset
        Of a Stokes cube ``radiance`` (frame, y, x, band, stokes), float32, as from `render`; of another cube a variable for each channel.
        ``malus.open(cube).to_zarr("cube.zarr")`` makes a Zarr of it, where zarr is installed.

    Raises
    ------
    ValueError
        For a file that is not such a cube, with its place; for cubes that are not frames of one picture.
    """
    several: Iterable[Any] = cube if isinstance(cube, Iterable) and not isinstance(cube, str | bytes | os.PathLike) else [cube]
    paths = [checks.path("open", "cube", path, "give the name of a cube, or of several") for path in several]
    if not all(paths) or not paths:
        raise ValueError("malus.open: cube: has no cube; give at least one")
    frames = [_of_cube(_malus.read_cube(path)) for path in paths]
    _demand_frames(paths, frames)
    return frames[0] if len(frames) == 1 else xr.concat(frames, dim="frame", combine_attrs="drop_conflicts", join="exact")
