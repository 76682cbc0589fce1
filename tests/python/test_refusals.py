"""Calls that malus cannot do: each is a ValueError with one line, which names the argument
(nw/python/PyArrays.nw, nw/python/PyModule.nw)."""
import copy
from typing import Any

import numpy as np
import pytest
import xarray as xr

import malus

SCENE: dict[str, Any] = {
    "malus": 1, "bands": {"wavelength_nm": [450]}, "geometry": [{"ground": {"z_m": 0, "material": "ground", "facet": "1"}}],
    "materials": {"ground": {"model": "lambertian", "reflectance": 0.2}},
    "sun": {"zenith_deg": 40, "azimuth_deg": 180, "irradiance_W_m2_nm": 1}, "sky": {"model": "rayleigh"},
    "sensor": {"kind": "framing", "width": 8, "height": 8, "field_of_view_deg": 70},
    "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 40, 0], "up": [0, 0, 1]}, "radiometry": {"rays": [2, 1], "seed": 3},
}
NAN, INF = float("nan"), float("inf")
EMPTY: list[Any] = []
NOON = "2001-06-10T17:08:00Z"
masked: Any = np.ma.array  # for mypy, which has no type for it
MASKED = masked([30.0, 40.0], mask=[False, True])
LIGHT = xr.DataArray(np.ones((2, 4)), dims=("x", "stokes"))


def scene(*path: Any) -> dict[str, Any]:
    """The scene with another value, the last word, under a path."""
    whole = copy.deepcopy(SCENE)
    inner: Any = whole
    for name in path[:-2]:
        inner = inner[name]
    inner[path[-2]] = path[-1]
    return whole


def itself() -> dict[str, Any]:
    """A scene that contains itself."""
    whole = scene("title", "round")
    whole["sky"]["sky"] = whole
    return whole


def brdf(**words: Any) -> Any:
    given: dict[str, Any] = {"model": "lambertian", "theta_i_deg": 30, "theta_r_deg": 40, "phi_deg": 180, "reflectance": 0.2, **words}
    return malus.brdf(**given)


def sky(**words: Any) -> Any:
    given: dict[str, Any] = {"wavelength_nm": 450, "mu0": 0.5, "mu": 1, "phi_deg": 0, **words}
    return malus.sky(**given)


def render(**words: Any) -> Any:
    given: dict[str, Any] = {"scene": SCENE, **words}
    return malus.render(**given)


WORDS: list[tuple[Any, dict[str, Any]]] = [  # one wrong word in a call that is good else
    *((brdf, {"model": value}) for value in (3, None, b"lambertian", EMPTY, "")),
    *((brdf, {"theta_i_deg": value}) for value in ("a", None, object(), [[1], [1, 2]], 1j, MASKED, np.ma.masked, INF, -1)),
    *((brdf, {"phi_deg": value}) for value in ("a", INF, [0] * 99 + [-INF], MASKED)),
    *((brdf, {"wavelength_nm": value}) for value in ("a", NAN, INF, 0, MASKED)),
    *((brdf, {"reflectance": value}) for value in ("a", "a\nb", NAN, b"2", object(), {1}, 10**400, 2, MASKED, np.ones(2))),
    *((sky, {"model": value}) for value in (3, None, "blue")),
    *((sky, {"convention": value}) for value in (3, "mine")),
    *((sky, {"direction": value}) for value in (3, "left")),
    *((sky, {"mu0": value}) for value in ("a", [0.5], NAN, 2, 10**400, np.ma.masked)),
    *((sky, {"tau_obs": value}) for value in ("a", NAN, -1, INF)),
    *((sky, {"irradiance": value}) for value in (None, [1, 2], NAN, INF, "a", -1)),
    *((sky, {"mu": value}) for value in ("a", [NAN], EMPTY, 2, np.ones((2, 2)), [[1], [1, 2]])),
    *((sky, {"phi_deg": value}) for value in ("a", [NAN], [INF], EMPTY, MASKED)),
    *((sky, {"wavelength_nm": value}) for value in ("a", NAN, INF, EMPTY, MASKED, -1)),
    *((sky, {"dome_step_deg": value}) for value in ("a", NAN, INF, 0, -5, 1e-6, 7, None)),
    *((sky, {"albedo": value}) for value in ("a", object(), [0.1, 0.2], NAN, 2)),
    *((sky, {"sun_zenith_deg": value, "mu0": None}) for value in ("a", [60, 70], NAN, INF, -1, b"1")),
    *((malus.mie, {"x": 1, "n": value}) for value in ("a", [1.5, 1.6], NAN, object(), None, 1000, MASKED)),
    *((malus.mie, {"n": 1.5, "x": value}) for value in ("a", INF, -1)),
    *((malus.sun, {"longitude_deg": 0, "time": NOON, "latitude_deg": value}) for value in ("a", NAN, 91, MASKED)),
    *((malus.sun, {"latitude_deg": 0, "longitude_deg": 0, "time": value}) for value in
      (5, None, object(), b"noon", "noon", "a\nb", np.datetime64("NaT"), [[NOON], [NOON, NOON]])),
    *((malus.is_realizable, {"mueller": np.eye(4), "tolerance": value}) for value in ("a", NAN, None, -1, np.ones(3))),
    *((malus.is_physical, {"stokes": np.ones(4), "tolerance": value}) for value in ("a", NAN, None, -1)),
    *((malus.lu_chipman, {"mueller": value}) for value in ("a", np.ones((4, 3)), None)),
    *((malus.dolp, {"stokes": value}) for value in
      ("abcd", None, np.ones(3), LIGHT.rename(stokes="s"), masked(np.ones((2, 4)), mask=[[0] * 4, [1] * 4]))),
    *((malus.rotate, {"stokes": LIGHT, "angle_deg": value}) for value in ("a", np.ones(3), None)),
    *((malus.retarder, {"retardance_deg": value}) for value in ("a", None, object())),
    *((render, {"threads": value}) for value in ("2", 1.5, None, -1, 2**40, 2**70)),
    *((render, {"frames": value}) for value in ("0", "x", [0.7], [0, 0], 2**70, [-1], 1, object(), EMPTY)),
    *((render, {"seed": value}) for value in ("3", 1.5, -1, 2**70)),
    *((render, {"tile": value}) for value in ("abcd", (0, 0, 2.5, 3), object(), np.zeros((2, 2)), (0, 0, 9, 9))),
    *((render, {"batches": value}) for value in ("x", 1.5, [2], 0)),
    *((render, {"until": value}) for value in ("x", NAN, object(), 2)),
    *((render, {"until": 0.1, "at_most": value}) for value in ("x", 0)),
    *((render, {"progress": value}) for value in (5, "bar", EMPTY)),
    *((render, {"base": value}) for value in (5, EMPTY)),
    *((render, {"scene": value}) for value in (object(), {1, 2}, None, [1], "", 7)),
    *((malus.open, {"cube": value}) for value in (5, None, [5], EMPTY, "", [""])),
]


@pytest.mark.parametrize("call, words", WORDS, ids=lambda value: getattr(value, "__name__", " ".join(repr(value).split())[:70]))
def test_a_wrong_word_is_named_in_one_line(call: Any, words: dict[str, Any]) -> None:
    name = list(words)[0] if call in (brdf, sky) else list(words)[-1]
    with pytest.raises(ValueError) as refused:
        call(**words)
    message = str(refused.value)
    assert "\n" not in message and name in message and "; " in message, message
    assert len(message) < 400


@pytest.mark.parametrize("given, words", [
    (scene("materials", "ground", "reflectance", NAN), "materials.ground.reflectance = nan: "),
    (scene("bands", "wavelength_nm", np.array([450, INF])), "bands.wavelength_nm[1] = inf: "),
    (scene("geometry", 0, "ground", "z_m", NAN), "geometry[0].ground.z_m = nan: "),
    (scene("materials", "my paint", {"n": NAN}), 'materials["my paint"].n = nan: '),
    (scene("title", b"x"), "title = b'x': is of the type bytes; "),
    (scene("title", {1}), "title = {1}: is of the type set; "),
    (scene("sky", "model", np.datetime64("2001-06-10")), "sky.model = "),
    (scene("bands", "wavelength_nm", MASKED), "bands.wavelength_nm: has masked elements; "),
    (scene("sun", (1, 2), 3), "sun: the key (1, 2) is not a text; "),
    (itself(), "sky.sky.sky."),
])
def test_a_value_that_no_scene_can_hold_has_its_path(given: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError) as refused:
        malus.render(given)
    assert words in str(refused.value) and "\n" not in str(refused.value) and "scene: " in str(refused.value)


def test_factors_are_counted() -> None:
    cases: list[tuple[Any, str]] = [
        ((np.ones((5, 3)),), "muellers[0]: has the shape (5, 3)"), ((np.eye(4), "a"), "muellers[1]: does not hold"),
        ((masked(np.eye(4), mask=np.eye(4)),), "muellers[0]: has masked elements")]
    for factors, words in cases:
        with pytest.raises(ValueError) as refused:
            malus.product(*factors)
        assert words in str(refused.value)


def test_what_is_drawn_has_a_number() -> None:
    picture = malus.render(SCENE)
    cases: list[dict[str, Any]] = [{"band": "a"}, {"band": 0.5}, {"frame": None}, {"frame": [0]}]
    for words in cases:
        with pytest.raises(ValueError, match=list(words)[0]):
            picture.malus.plot(**words)


def test_a_surplus_word_is_pythons_own_error() -> None:
    with pytest.raises(TypeError, match="bogus"):
        malus.dolp(np.ones(4), bogus=1)  # type: ignore[call-arg]  # pylint: disable=unexpected-keyword-arg


def test_negative_control_what_is_odd_but_good() -> None:
    assert np.isnan(brdf(phi_deg=NAN, model="torrance-sparrow", reflectance=None, n=1.5, k=0, sigma=0.1)).all()
    assert np.isfinite(brdf(phi_deg=1e300, theta_i_deg=np.array(30), wavelength_nm=np.float32(550))).all()
    assert np.isfinite(brdf(theta_i_deg=masked([30, 40]))).all()  # nothing is masked
    assert sky(mu0=np.array(0.5), irradiance=np.float32(1)).sizes["stokes"] == 4
    given = {**SCENE, "title": np.str_("a"), "bands": {"wavelength_nm": (np.float32(450),)}}
    cases: list[dict[str, Any]] = [{"frames": np.int64(0)}, {"frames": range(1)}, {"frames": np.array(0)}, {"frames": np.array([0])},
                                   {"threads": np.int8(1)}]
    for words in cases:
        assert malus.render(given, **words).sizes["frame"] == 1
