"""Pictures from Python against the cubes of malus render, bit by bit (nw/python/PyScene.nw)."""
import _thread
import copy
import json
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from conftest import complaint, run_malus

import malus

MATT: dict[str, Any] = {
    "malus": 1,
    "bands": {"wavelength_nm": [450, 650]},
    "geometry": [{"ground": {"z_m": 0, "material": "ground", "facet": "1"}}],
    "materials": {"ground": {"model": "torrance-sparrow", "n": 1.5, "k": 0, "sigma": 0.2}},
    "sun": {"zenith_deg": 40, "azimuth_deg": 180, "irradiance_W_m2_nm": 1},
    "sky": {"model": "rayleigh", "albedo": 0.2},
    "sensor": {"kind": "framing", "width": 40, "height": 24, "field_of_view_deg": 70},
    "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 40, 0], "up": [0, 0, 1]},
    "radiometry": {"rays": [8, 1], "seed": 3},
}


def with_sensor(**keys: Any) -> dict[str, Any]:
    scene = copy.deepcopy(MATT)
    scene["sensor"].update(keys)
    return scene


@pytest.fixture(scope="module")
def cubes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory of a scene and of what malus render makes of it."""
    folder = tmp_path_factory.mktemp("matt")
    (folder / "matt.json").write_text(json.dumps(MATT), encoding="utf-8")
    run_malus("render", folder / "matt.json", "--out", folder / "out", "--write", "cube,truth,pictures")
    return folder


def test_light_and_truth_are_those_of_the_cube(cubes: Path) -> None:
    ds, cube, truth = malus.render(cubes / "matt.json"), malus.open(cubes / "out/matt.img"), malus.open(cubes / "out/matt.truth.img")
    assert ds.radiance.dims == ("frame", "y", "x", "band", "stokes") and ds.radiance.shape == (1, 24, 40, 2, 4)
    assert ds.radiance.dtype == np.float32
    xr.testing.assert_equal(ds.radiance.drop_vars(["time_s", "fwhm_nm"]), cube.radiance)  # coordinates as well
    for name in ("facet", "material", "range_m", "sun_hidden", "rays"):
        assert np.array_equal(ds[name].values.astype(np.float32), truth[name].values, equal_nan=True), name
    assert (ds.material == -1).any() and (ds.material == 0).any()
    assert ds.radiance.attrs["units"] == "W m^-2 sr^-1 nm^-1" and "S2 > 0" in ds.radiance.attrs["description"]


def test_negative_control_another_seed_is_another_picture(cubes: Path) -> None:
    ds, other = malus.render(MATT), malus.render(MATT, seed=4)
    assert np.array_equal(ds.radiance, malus.open(cubes / "out/matt.img").radiance)
    assert not np.array_equal(ds.radiance, other.radiance) and other.attrs["seed"] == 4


def test_parts_and_threads_do_not_show() -> None:
    whole = malus.render(MATT)
    part = malus.render(MATT, tile=(5, 3, 30, 20), threads=3)
    xr.testing.assert_equal(part, whole.sel(x=slice(5, 29), y=slice(3, 19)))
    assert np.array_equal(malus.render(MATT, threads=1).radiance, whole.radiance)


def test_frames() -> None:
    scene = copy.deepcopy(MATT)
    scene["platform"] = {"path": "straight", "start_m": [0, 0, 10], "velocity_m_s": [1, 0, 0], "frames": 3, "interval_s": 2,
                         "look": [0, 1, -1], "up": [0, 0, 1]}
    scene["geometry"].append({"obj": "chunky-bar.obj", "materials": {f"chunk{i}": "ground" for i in range(2, 6)}})
    whole, last = malus.render(scene, base="scenes"), malus.render(scene, base="scenes", frames=2)
    assert whole.frame.values.tolist() == [0, 1, 2] and last.frame.values.tolist() == [2] and last.time_s[0] == 4
    xr.testing.assert_equal(last, whole.isel(frame=[2]))
    assert not np.array_equal(whole.radiance[0], whole.radiance[2])


def test_dict_and_netcdf(tmp_path: Path) -> None:
    ds = malus.render(MATT)
    ds.to_netcdf(tmp_path / "matt.nc")
    with xr.open_dataset(tmp_path / "matt.nc") as back:
        assert np.array_equal(back.radiance, ds.radiance) and back.radiance.attrs == ds.radiance.attrs


def test_files_are_looked_for_in_base(tmp_path: Path) -> None:
    scene = copy.deepcopy(MATT)
    scene["geometry"] = [{"obj": "plate.obj"}]
    (tmp_path / "plate.obj").write_text("usemtl ground\nv -9 0 0\nv 9 0 0\nv 9 30 0\nv -9 30 0\nf 1 2 3 4\n", encoding="utf-8")
    assert (malus.render(scene, base=tmp_path).material == 0).any()
    with pytest.raises(ValueError, match="plate.obj"):
        malus.render(scene)


def test_numpy_numbers_are_numbers() -> None:
    scene = with_sensor(width=np.int64(16), height=np.int32(16))
    scene["bands"] = {"wavelength_nm": np.array([450.0, 650.0])}
    assert malus.render(scene).radiance.shape == (1, 16, 16, 2, 4)


def wrong(**keys: Any) -> dict[str, Any]:
    return {**copy.deepcopy(MATT), **keys}


def test_a_wrong_key_has_its_path_and_a_hint(tmp_path: Path) -> None:
    scene = copy.deepcopy(MATT)
    scene["materials"]["ground"]["sigmaa"] = 0.1
    (tmp_path / "s.json").write_text(json.dumps(scene), encoding="utf-8")
    expected = complaint("render", tmp_path / "s.json", "--out", tmp_path / "out")
    sources: list[Any] = [scene, tmp_path / "s.json"]
    for given in sources:
        with pytest.raises(ValueError) as refused:
            malus.render(given)
        message = str(refused.value)
        assert "materials.ground" in message and "did you mean sigma?" in message and "\n" not in message
        assert expected.endswith(message.split(": ", 1)[1])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("words, message", [
    ({"tile": (0, 0, 50, 10)}, "malus.render: tile = (0, 0, 50, 10): is not a part of the picture; "
     "give x0,y0,x1,y1 with x0 < x1 <= 40 and y0 < y1 <= 24"),
    ({"tile": (0, 0, 5)}, "malus.render: tile = (0, 0, 5): is not a part of the picture; "
     "give x0,y0,x1,y1 with x0 < x1 <= 40 and y0 < y1 <= 24"),
    ({"frames": 1}, "malus.render: frames = 1: is not a frame of the scene; give frames from 0 to 0"),
    ({"frames": []}, "malus.render: frames: has no frame; give at least one, or leave it out"),
    ({"seed": -1}, "malus.render: seed = -1: does not consist of whole numbers; give a number such as 1"),
    ({"threads": -1}, "malus.render: threads = -1: must be 0 to 256; give a number of threads, or 0 for all processors"),
])
def test_refusals(words: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as refused:
        malus.render(MATT, **words)
    assert str(refused.value) == message


def test_a_file_that_is_no_cube(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no-cube.img"):
        malus.open(tmp_path / "no-cube.img")


def test_progress_grows_to_the_end() -> None:
    heard: list[tuple[float, str]] = []
    malus.render(MATT, progress=lambda fraction, text: heard.append((fraction, text)))
    assert heard == sorted(heard) and heard[-1][0] == 1 and heard[-1][1].startswith("frame 1 of 1, ")


def endless() -> dict[str, Any]:
    """A scene that would take hours."""
    scene = with_sensor(width=2000, height=2000)
    scene["radiometry"]["rays"] = [2000, 1]
    return scene


def test_an_exception_of_the_callback_stops_the_render() -> None:
    class Enough(Exception):
        pass

    def stop(_: float, __: str) -> None:
        raise Enough
    with pytest.raises(Enough):
        malus.render(endless(), progress=stop)


def test_ctrl_c_stops_a_render_and_other_threads_go_on() -> None:
    """The signal comes from another thread, which can only send it while the render leaves Python's lock alone."""
    began = threading.Event()

    def kill() -> None:
        began.wait()
        _thread.interrupt_main()
    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(KeyboardInterrupt):
        malus.render(endless(), progress=lambda *_: began.set())
    killer.join()
