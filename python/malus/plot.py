"""Pictures of datasets, in the colours of the program's quick looks (nw/files/Quicklooks.nw)."""
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from . import checks
from .stokes import aolp, dolp

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = npt.NDArray[Any]
FRACTIONS = np.array([[0.05, 0.03, 0.25], [0.33, 0.09, 0.43], [0.73, 0.22, 0.33], [0.98, 0.55, 0.15], [0.99, 0.95, 0.60]])
NOTHING = (0.5, 0.5, 0.5)  # a pixel without light has no degree and no angle


def grey(part: Array) -> Array:
    """S0 from 0 to 1, with the eye's gamma."""
    level = np.clip(part, 0, 1) ** (1 / 2.2)
    return np.stack([level] * 3, axis=-1)


def sequential(part: Array) -> Array:
    """Degrees of polarisation as parts of the scale, from dark blue to yellow."""
    at = np.clip(part, 0, 1) * 4
    return np.stack([np.interp(at, range(5), FRACTIONS[:, c]) for c in range(3)], axis=-1)


def hue(turns: Array, value: Array | float = 1.0) -> Array:
    """Angles of polarisation as parts of 180 degrees, dimmed by a value."""
    channels = [np.clip(np.abs((turns + shift) % 1 * 6 - 3) - 1, 0, 1) for shift in (0, 2 / 3, 1 / 3)]
    return np.asarray(np.stack(channels, axis=-1) * np.asarray(value)[..., None])


def stretch(values: Array) -> float:
    """The magnitude that one value in two hundred exceeds; 1 if that is zero."""
    good = np.sort(np.abs(values[np.isfinite(values)]))
    top = float(good[good.size - 1 - good.size // 200]) if good.size else 0.0
    return top if top > 0 else 1.0


def _between(data: Array, row: Array, column: Array) -> Array:
    """Values between the nodes of a lattice, by two straight lines."""
    i, j = np.minimum(row.astype(int), data.shape[0] - 2).clip(0), np.minimum(column.astype(int), data.shape[1] - 2).clip(0)
    down, right = (row - i)[..., None], (column - j)[..., None]
    below, beside = np.minimum(i + 1, data.shape[0] - 1), np.minimum(j + 1, data.shape[1] - 1)
    upper = data[i, j] * (1 - right) + data[i, beside] * right
    lower = data[below, j] * (1 - right) + data[below, beside] * right
    return np.asarray(upper * (1 - down) + lower * down)


def _fisheye(stokes: xr.DataArray, pixels: int = 480) -> Array:
    """A dome seen from below its middle: zenith in the middle, the sun's azimuth below it, clockwise from above; NaN beyond the horizon."""
    zenith, phi = stokes.zenith_deg.values, stokes.phi_deg.values
    right, down = np.meshgrid(*[(np.arange(pixels) + 0.5) / pixels * 2 - 1] * 2)
    from_zenith, azimuth = 90 * np.hypot(right, down), np.degrees(np.arctan2(right, -down)) - 180
    data = stokes.transpose("zenith_deg", "phi_deg", "stokes").values
    data = np.concatenate([data, data[:, :1]], axis=1)  # the circle closes
    row = np.interp(from_zenith, zenith, np.arange(zenith.size))
    column = np.interp((azimuth - phi[0]) % 360, np.append(phi - phi[0], 360), np.arange(phi.size + 1))
    seen = _between(data, row, column)
    seen[(from_zenith > 90) | (from_zenith > zenith[-1] + 1e-9)] = np.nan
    return seen


def _panel(axes: "Axes", picture: Array, title: str, scale: Any, top: float, sky: bool) -> None:
    """An image with its scale beside it."""
    from matplotlib.cm import ScalarMappable  # pylint: disable=import-outside-toplevel
    from matplotlib.colors import ListedColormap, Normalize  # pylint: disable=import-outside-toplevel
    alpha = np.isfinite(picture).all(axis=-1, keepdims=True)
    image = np.concatenate([np.where(alpha, picture, 0), alpha], axis=-1)
    axes.imshow(image, extent=(-90, 90, -90, 90) if sky else None, interpolation="nearest")
    axes.set_title(title, fontsize=11)
    bar = axes.figure.colorbar(ScalarMappable(Normalize(0, top), ListedColormap(scale(np.linspace(0, 1, 256)))), ax=axes, shrink=0.78,
                               pad=0.03, aspect=22)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, length=2)
    if top == 180:
        bar.set_ticks([0, 45, 90, 135, 180])


def _chosen(light: xr.DataArray, axis: str, name: str, given: int) -> xr.DataArray:
    """One of an axis, counted from 0; the light itself if a selection has left only one."""
    index = checks.whole("plot", name, given, -2**62, 2**62, "give the number of one, counted from 0")
    if axis not in light.dims:
        return light
    if not -light.sizes[axis] <= index < light.sizes[axis]:
        raise ValueError(f"malus.plot: {name} = {index}: does not exist; they are counted from 0 to {light.sizes[axis] - 1}")
    return light.isel({axis: index})


def _mark_sky(axes: "Axes", sun_deg: float | None, background: str) -> None:
    """Horizon, rings of 30 and 60 degrees, and the sun."""
    turn = np.linspace(0, 2 * np.pi, 361)
    for ring, width in ((30, 0.4), (60, 0.4), (90, 1.0)):
        rim = ring == 90
        axes.plot(ring * np.sin(turn), ring * np.cos(turn), color="0.15" if rim else background, lw=width, alpha=1 if rim else 0.5)
    if sun_deg is not None and sun_deg <= 90:
        axes.plot(0, -sun_deg, "o", ms=9, mfc="#ffd23f", mec="black", mew=0.9, clip_on=False)
    axes.set_axis_off()
    axes.set_xlim(-93, 93)
    axes.set_ylim(-93, 93)


@xr.register_dataset_accessor("malus")  # type: ignore[no-untyped-call]
class MalusAccessor:
    """Methods of a dataset of malus: ``ds.malus.plot()``."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def plot(self, *, frame: int = 0, band: int | None = None, figsize: tuple[float, float] | None = None) -> "Figure":
        """S0, degree and angle of linear polarisation, in the colours of ``malus products``.

        The scale of S0 and of the DoLP ends at what one pixel in two hundred exceeds. The angle is a hue, dimmed by the DoLP.
        A sky is drawn as a fisheye: the zenith in the middle, the sun's azimuth below it, azimuths clockwise from above.

        Parameters
        ----------
        frame : int
            Which of the frames, counted from 0 in this dataset.
        band : int, optional
            Which of the bands or wavelengths; the middle one if not given.
        figsize : (float, float), optional
            Inches.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
        if "radiance" not in self._dataset or "stokes" not in self._dataset.radiance.dims:
            raise ValueError("malus.plot: the dataset has no Stokes radiance; take one of malus.sky, malus.render or malus.open")
        light = self._dataset.radiance
        sky = "zenith_deg" in light.dims
        bands = "wavelength_nm" if sky else "band"
        light = _chosen(light, bands, "band", light.sizes.get(bands, 0) // 2 if band is None else band)
        if not sky:
            light = _chosen(light, "frame", "frame", frame)
        stokes = _fisheye(light) if sky else light.transpose("y", "x", "stokes").values
        if stokes.shape[-1] < 3:
            raise ValueError("malus.plot: the dataset lacks S1 or S2; it was measured without")
        full = np.concatenate([stokes, np.zeros((*stokes.shape[:-1], 4 - stokes.shape[-1]), stokes.dtype)], axis=-1)
        degree, angle, black = dolp(full), aolp(full), (full == 0).all(axis=-1)
        tops = stretch(full[..., 0]), stretch(np.where(black, np.nan, degree))
        beyond = ~np.isfinite(full).all(axis=-1)
        pictures = [grey(full[..., 0] / tops[0]), sequential(degree / tops[1]), hue(angle / 180, np.minimum(1, degree / tops[1]))]
        for picture in pictures[1:]:
            picture[black] = NOTHING
        for picture in pictures:
            picture[beyond] = np.nan
        figure, axes = pyplot.subplots(1, 3, figsize=figsize or (12, 3.9 if sky else 1.0 + 3.4 * stokes.shape[0] / stokes.shape[1]),
                                       constrained_layout=True)
        unit = re.sub(r"\^(-?\d+)", r"$^{\1}$", str(self._dataset.radiance.attrs.get("units", "")))
        titles = [f"S0 [{unit}]", "DoLP", "AoLP [deg]"]
        for panel, picture, title, scale, top in zip(axes, pictures, titles, (grey, sequential, hue), (*tops, 180.0)):
            _panel(panel, picture, title, scale, top, sky)
            if sky:
                cosine = self._dataset.attrs.get("mu0")
                _mark_sky(panel, None if cosine is None else float(np.degrees(np.arccos(cosine))), "white")
            else:
                panel.tick_params(labelsize=8, length=2)
        where = next((light.coords[name].item() for name in ("wavelength_nm", bands) if name in light.coords), "")
        heading = str(self._dataset.attrs.get("title", ""))
        suffix = f"{where:g} nm" if isinstance(where, float) and np.isfinite(where) else str(where) if isinstance(where, str) else ""
        figure.suptitle(", ".join(word for word in (heading, suffix) if word), fontsize=12)
        return figure
