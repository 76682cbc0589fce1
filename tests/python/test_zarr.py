"""Datasets of malus as Zarr: written by xarray, read back with the same numbers, coordinates and attributes (nw/python/PyScene.nw)."""
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from conftest import run_malus
from test_netcdf import SCENE

import malus

zarr = pytest.importorskip("zarr", reason="Zarr is not tested: install python3-zarr")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("zarr")
    (made / "plate.json").write_text(json.dumps(SCENE), encoding="utf-8")
    run_malus("render", made / "plate.json", "--out", made / "out", "--write", "cube,truth,netcdf")
    return made


def through_zarr(ds: xr.Dataset, to: Path) -> xr.Dataset:
    ds.to_zarr(to)
    with xr.open_dataset(to, engine="zarr") as back:
        return back.load()


def test_renders_and_skies_come_back_the_same(folder: Path, tmp_path: Path) -> None:
    for i, ds in enumerate((malus.render(folder / "plate.json"), malus.render(folder / "plate.json", batches=3),
                            malus.sky(wavelength_nm=[450, 550], mu0=0.5, dome_step_deg=30, albedo=np.float32(0.2)),
                            malus.sky(tau=0.3, mu0=0.5, dome_step_deg=30))):
        xr.testing.assert_identical(through_zarr(ds, tmp_path / f"{i}.zarr"), ds)


def test_cubes_come_back_the_same(folder: Path, tmp_path: Path) -> None:
    frames = [folder / f"out/plate.000{i}.img" for i in (0, 1)]
    cubes: list[Any] = [frames[0], frames, folder / "out/plate.0000.truth.img", folder / "out/plate.0000.nc"]
    for i, cube in enumerate(cubes):
        ds = malus.open(cube)
        back = through_zarr(ds, tmp_path / f"{i}.zarr")
        xr.testing.assert_identical(back, ds)
    light = zarr.open(str(tmp_path / "1.zarr"), mode="r")["radiance"][:]  # not by xarray
    assert light.tobytes() == b"".join(frame.read_bytes() for frame in frames)


def test_negative_control_another_number_is_another_dataset(folder: Path, tmp_path: Path) -> None:
    ds = malus.open(folder / "out/plate.0000.img")
    back = through_zarr(ds, tmp_path / "a.zarr")
    back.radiance.values[0, 3, 4, 0, 0] += 1
    with pytest.raises(AssertionError):
        xr.testing.assert_identical(back, ds)
