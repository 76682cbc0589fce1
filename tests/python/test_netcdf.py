"""netCDF of malus render, read by netCDF4 and xarray, against the ENVI cube and against malus.render, bit by bit
(nw/files/NetCDF.nw, nw/python/PyScene.nw)."""
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from conftest import complaint, run_malus

import malus

netCDF4 = pytest.importorskip("netCDF4")

SCENE: dict[str, Any] = {
    "malus": 1, "title": "a plate, a horizon, two frames",
    "bands": {"wavelength_nm": [450, 650]},
    "geometry": [{"ground": {"z_m": 0, "material": "ground", "facet": "the ground"}}],
    "materials": {"ground": {"model": "torrance-sparrow", "n": 1.5, "k": 0, "sigma": 0.2}},
    "sun": {"latitude_deg": 43, "longitude_deg": -77.6, "time": "2001-06-10T13:08:00-04:00", "irradiance_W_m2_nm": 1},
    "sky": {"model": "rayleigh", "albedo": 0.2},
    "sensor": {"kind": "framing", "width": 24, "height": 16, "field_of_view_deg": 70},
    "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 40, 0], "up": [0, 0, 1], "frames": 2, "interval_s": 90},
    "radiometry": {"rays": [8, 1], "seed": 3},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory of a scene and of what malus render makes of it."""
    made = tmp_path_factory.mktemp("plate")
    (made / "plate.json").write_text(json.dumps(SCENE), encoding="utf-8")
    run_malus("render", made / "plate.json", "--out", made / "out", "--write", "cube,truth,netcdf")
    return made


def test_netcdf4_reads_the_bits_of_the_cube(folder: Path) -> None:
    with netCDF4.Dataset(folder / "out/plate.0001.nc") as data:
        light = data["radiance"]
        assert light.dimensions == ("frame", "y", "x", "band", "stokes") and light.units == "W m^-2 sr^-1 nm^-1"
        assert data.Conventions == "CF-1.8" and data.data_model == "NETCDF4"
        assert np.isnan(light._FillValue) and "S2 > 0" in light.description  # pylint: disable=protected-access
        assert data.seed == 3 and data.source.startswith("malus ") and data.title == SCENE["title"]
        light.set_auto_mask(False)
        cube = np.fromfile(folder / "out/plate.0001.img", dtype="<f4")
        assert light[:].tobytes() == cube.tobytes()
        record = json.loads((folder / "out/plate.0001.run.json").read_text(encoding="utf-8"))
        assert data.convention_stokes == record["conventions"]["stokes"] and data.rays_followed == record["rays_followed"]
        assert list(data["material_name"][:]) == record["materials"] and list(data["facet_name"][:]) == record["facets"]


def test_xarray_reads_what_malus_renders(folder: Path) -> None:
    rendered = malus.render(folder / "plate.json")
    for frame in (0, 1):
        with xr.open_dataset(folder / f"out/plate.000{frame}.nc") as ds:
            expected = rendered.isel(frame=[frame])
            assert ds.radiance.dtype == np.float32
            for name in ("radiance", "range_m", "facet", "material", "sun_hidden", "rays"):
                assert ds[name].dims == expected[name].dims
                assert np.array_equal(ds[name].values, expected[name].values, equal_nan=ds[name].dtype.kind == "f"), name
            for name in ("frame", "time_s", "y", "x", "band", "wavelength_nm", "stokes"):
                assert name in ds.coords and ds[name].values.tolist() == expected[name].values.tolist(), name
            assert ds.time.values[0] == np.datetime64("2001-06-10T17:08:00") + np.timedelta64(90 * frame, "s")
            assert ds.wavelength_nm.units == "nm" and np.isnan(ds.range_m).any() and (ds.material == -1).any()
            np.testing.assert_array_equal(malus.dolp(ds.radiance), malus.dolp(expected.radiance))


def test_errors_are_those_of_the_cube_and_of_the_module(folder: Path) -> None:
    run_malus("render", folder / "plate.json", "--frames", "1", "--batches", "3", "--out", folder / "errors", "--write", "cube,error,netcdf")
    rendered = malus.render(folder / "plate.json", frames=1, batches=3)
    assert "stokes_standard_error" not in malus.render(folder / "plate.json", frames=1)
    error = np.fromfile(folder / "errors/plate.0001.error.img", dtype="<f4").reshape(16, 24, 20)[:, :, :8].reshape(1, 16, 24, 2, 4)
    with xr.open_dataset(folder / "errors/plate.0001.nc") as ds:
        assert ds.stokes_standard_error.dims == ds.radiance.dims and ds.stokes_standard_error.units == ds.radiance.units
        for found in (ds.stokes_standard_error, rendered.stokes_standard_error):
            assert np.array_equal(found.values, error) and (found.values[..., 0] > 0).any()
        assert np.array_equal(ds.radiance.values, rendered.radiance.values)
    for batches, words in ((0, "is not a number of batches"), (4097, "give a number from 1 to 4096")):
        with pytest.raises(ValueError, match=words):
            malus.render(folder / "plate.json", batches=batches)
    aim = ("--until", "dolp=0.05", "--batches", "8")
    run_malus("render", folder / "plate.json", "--frames", "1", *aim, "--out", folder / "sure", "--write", "cube,error")
    sure = malus.render(folder / "plate.json", frames=1, until="dolp=0.05", batches=8)
    cube = np.fromfile(folder / "sure/plate.0001.img", dtype="<f4").reshape(1, 16, 24, 2, 4)
    assert np.array_equal(sure.radiance.values, cube) and sure.rays.values.max() > sure.rays.values.min()
    with pytest.raises(ValueError, match="malus.render: until = 2: is not between 0 and 1"):
        malus.render(folder / "plate.json", until=2)
    grid = {**SCENE, "radiometry": {"sampling": "grid-rotated", "rays": [8, 1]}}
    with pytest.raises(ValueError, match="sampling is grid-rotated; set radiometry.sampling"):
        malus.render(grid, batches=2)


def test_what_are_no_frames_of_one_picture_is_not_joined(folder: Path) -> None:
    for part in ("0,0,8,8", "8,8,16,16", "1/2", "2/2"):
        run_malus("render", folder / "plate.json", "--frames", "0", "--part", part, "--out", folder / "parts", "--write", "cube,truth")
    tiles = sorted((folder / "parts").glob("plate.0000.*-*-*-??.img")) + sorted((folder / "parts").glob("plate.0000.0-0-8-8.img"))
    strips = sorted((folder / "parts").glob("plate.0000.part-?-of-2.img"))
    assert len(tiles) == len(strips) == 2
    whole = folder / "out/plate.0000.img"
    cases: list[tuple[list[Path], str]] = [(tiles, "has other coordinates y than"),
                                           (strips, "is frame 0, as .* is; put parts together with malus merge"),
                                           ([whole, whole], "is frame 0, as"), ([], "has no cube")]
    for paths, words in cases:
        with pytest.raises(ValueError, match=words):
            malus.open(paths)
    film = malus.open([whole, folder / "out/plate.0001.img"])
    assert film.frame.values.tolist() == [0, 1] and np.isfinite(film.radiance).all()


def test_negative_control_another_frame_has_other_bits(folder: Path) -> None:
    with xr.open_dataset(folder / "out/plate.0000.nc") as first, xr.open_dataset(folder / "out/plate.0001.nc") as second:
        assert not np.array_equal(first.radiance.values, second.radiance.values)


def test_frames_go_one_behind_the_other(folder: Path) -> None:
    parts = [xr.open_dataset(folder / f"out/plate.000{frame}.nc") for frame in (0, 1)]
    film = xr.concat(parts, dim="frame", data_vars="minimal", combine_attrs="drop_conflicts")
    assert film.radiance.shape == (2, 16, 24, 2, 4) and film.frame.values.tolist() == [0, 1]
    assert film.time.values[1] - film.time.values[0] == np.timedelta64(90, "s")


def test_the_bytes_depend_on_the_light_alone(folder: Path, tmp_path: Path) -> None:
    run_malus("render", folder / "plate.json", "--out", tmp_path, "--write", "netcdf", "--threads", 3, "--frames", 1)
    assert (tmp_path / "plate.0001.nc").read_bytes() == (folder / "out/plate.0001.nc").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plate.0001.nc", "plate.0001.run.json"]


def test_merged_parts_are_the_bytes_of_the_whole(folder: Path, tmp_path: Path) -> None:
    for part in (1, 2, 3):
        run_malus("render", folder / "plate.json", "--out", tmp_path, "--write", "cube,truth,netcdf", "--part", f"{part}/3")
    assert not list(tmp_path.glob("*.nc"))
    run_malus("merge", tmp_path)
    for name in ("plate.0000.nc", "plate.0001.nc"):
        assert (tmp_path / name).read_bytes() == (folder / "out" / name).read_bytes()


def test_open_and_info_take_it_like_a_cube(folder: Path) -> None:
    cube, netcdf = (malus.open(folder / f"out/plate.0001.{ending}") for ending in ("img", "nc"))
    xr.testing.assert_identical(cube, netcdf)
    of_cube, of_netcdf = (json.loads(run_malus("info", "--json", folder / f"out/plate.0001.{ending}")) for ending in ("img", "nc"))
    assert of_cube.pop("file") != of_netcdf.pop("file") and of_cube == of_netcdf


def test_filters_leave_what_they_tell(tmp_path: Path) -> None:
    run_malus("render", "scenes/mosaic.json", "--out", tmp_path, "--write", "cube,netcdf")
    stem = tmp_path / "mosaic"
    cube, netcdf = (malus.open(f"{stem}.recovered.{ending}") for ending in ("img", "nc"))
    xr.testing.assert_identical(cube, netcdf)
    assert netcdf.stokes.values.tolist() == ["S0", "S1", "S2"]


def test_what_is_no_netcdf_is_refused(folder: Path, tmp_path: Path) -> None:
    whole = (folder / "out/plate.0000.nc").read_bytes()
    (tmp_path / "text.nc").write_text("text", encoding="utf-8")
    (tmp_path / "cut.nc").write_bytes(whole[:len(whole) // 2])
    xr.Dataset({"rain": ("t", [1.0])}).to_netcdf(tmp_path / "rain.nc")
    for name, words in (("text.nc", "cannot be read as netCDF"), ("cut.nc", "cannot be read as netCDF"), ("none.nc", "does not exist"),
                        ("rain.nc", "radiance: does not exist, or of another shape")):
        line = complaint("info", tmp_path / name)
        assert name in line and words in line and "\n" not in line
        with pytest.raises(ValueError, match=name):
            malus.open(tmp_path / name)
