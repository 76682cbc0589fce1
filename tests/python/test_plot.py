"""Pictures of datasets, and the examples (nw/python/PyModule.nw)."""
import doctest
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import xarray as xr
from conftest import Array, run_malus
from malus import plot

import malus

BAR = 84  # pixels that the program's scale takes beside a picture


@pytest.fixture(scope="module")
def dome() -> xr.Dataset:
    return malus.sky(wavelength_nm=[450, 650], sun_zenith_deg=60, albedo=0.1)


def image(axes: Any) -> Array:
    return np.asarray(axes.images[0].get_array())


def test_the_colours_are_those_of_the_quick_looks(tmp_path: Path) -> None:
    """The scales beside the program's pictures, row by row; a colour there is one of 256."""
    run_malus("sky", "--wavelength-nm", 450, "--mu0", 0.5, "--picture", tmp_path / "dome")
    scales: tuple[tuple[str, Any], ...] = (("S0", plot.grey), ("DoLP", plot.sequential), ("AoLP", plot.hue))
    for name, scale in scales:
        picture = matplotlib.image.imread(tmp_path / f"dome.{name}.png")[..., :3]
        height = picture.shape[0]
        shown = picture[:, picture.shape[1] - BAR + 10]
        expected = scale(1 - np.arange(height) / (height - 1))
        assert np.abs(shown - expected).max() < 1.01 / 255, name
        assert np.abs(shown[::-1] - expected).max() > 0.1 or name == "AoLP"


def test_a_sky_is_the_programs_picture(tmp_path: Path) -> None:
    """The same place has the same degree of polarisation, away from the marks of the neutral points."""
    text = run_malus("sky", "--wavelength-nm", 450, "--mu0", 0.5, "--picture", tmp_path / "dome")
    assert "Babinet" in text
    fine = malus.sky(wavelength_nm=450, mu0=0.5, dome_step_deg=1)
    figure = fine.malus.plot()
    ours = image(figure.axes[1])
    theirs = matplotlib.image.imread(tmp_path / "dome.DoLP.png")[:, :-BAR, :3]
    for right, down in ((0.2, 0.5), (0.1, -0.5), (0.6, 0.2), (-0.6, 0.2), (0.3, -0.7)):
        here = ours[round((down + 1) / 2 * 479), round((right + 1) / 2 * 479), :3]
        there = theirs[round((down + 1) / 2 * 240), round((right + 1) / 2 * 240)]
        assert np.abs(here - there).max() < 0.05, (right, down)  # pixels of two sizes, half of one apart
    turned = image(figure.axes[2])[:, ::-1]
    assert np.nanmax(np.abs(turned - image(figure.axes[2]))) > 0.5  # right is not left: azimuths turn clockwise


def test_panels_have_names_and_scales(dome: xr.Dataset) -> None:
    figure = dome.malus.plot(band=1)
    assert [axes.get_title().split(" ")[0] for axes in figure.axes[:3]] == ["S0", "DoLP", "AoLP"]
    assert "650 nm" in figure._suptitle.get_text()  # pylint: disable=protected-access
    assert image(figure.axes[0])[0, 0, 3] == 0 and image(figure.axes[0])[240, 240, 3] == 1  # nothing beyond the horizon


def test_a_picture_without_light_is_grey() -> None:
    light = np.zeros((1, 4, 5, 1, 4), np.float32)
    light[..., 0, :, 0, :] = [1, 0.5, 0, 0]
    ds = xr.Dataset({"radiance": (("frame", "y", "x", "band", "stokes"), light)}, {"band": ["550"]})
    figure = ds.malus.plot()
    assert np.allclose(image(figure.axes[1])[2, 1], [0.5, 0.5, 0.5, 1]) and np.allclose(image(figure.axes[2])[0, 0, :3], [1, 0, 0])


def test_a_selection_is_drawn_and_what_is_not_there_is_named() -> None:
    """A band or a frame that was chosen before is the one that is drawn."""
    light = np.zeros((2, 4, 5, 3, 4), np.float32)
    light[..., 0] = 1
    light[1, :, :, 2, 1] = 0.5
    ds = xr.Dataset({"radiance": (("frame", "y", "x", "band", "stokes"), light)}, {"band": ["450", "550", "650"]})
    whole = image(ds.malus.plot(frame=1, band=2).axes[2])
    for chosen in (ds.isel(frame=1, band=2), ds.isel(frame=1).sel(band="650", drop=True), ds.isel(frame=[1], band=[2])):
        assert np.array_equal(image(chosen.malus.plot().axes[2]), whole)
    assert not np.array_equal(image(ds.isel(frame=0, band=2).malus.plot().axes[2]), whole)  # negative control
    for call, words in (({"band": 3}, r"band = 3: does not exist; they are counted from 0 to 2"), ({"frame": 5}, "frame = 5")):
        with pytest.raises(ValueError, match=words):
            ds.malus.plot(**call)


def test_other_datasets_are_refused() -> None:
    with pytest.raises(ValueError, match="has no Stokes radiance"):
        xr.Dataset({"a": ("x", [1.0])}).malus.plot()


@pytest.mark.parametrize("example", sorted(Path("examples").glob("*.py")), ids=str)
def test_examples_run(example: Path, tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, example.resolve()], cwd=tmp_path, env=os.environ, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.glob("*.png"))


def test_the_readmes_lines_are_the_example() -> None:
    """The code in README runs: it is the example, line by line."""
    lines = Path("examples/polarized_sky.py").read_text(encoding="utf-8").split('"""')[2].strip().splitlines()
    readme = Path("README.md").read_text(encoding="utf-8")
    assert all(f"    {line}\n" in readme for line in lines if line)


def test_docstrings_tell_the_truth() -> None:
    for module in (malus, sys.modules["malus.surface"], sys.modules["malus.air"]):
        assert doctest.testmod(module, extraglobs={"malus": malus, "np": np}).failed == 0
