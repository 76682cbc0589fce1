"""The sun and the air from Python against the program, to the last bit (nw/python/PyAir.nw)."""
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import complaint, numbers, run_malus, seconds_after_ctrl_c

import malus

ROCHESTER = (43.16, -77.61)


def test_the_suns_place_is_the_programs(tmp_path: Path) -> None:
    hours = [f"2001-06-21T{hour:02}:00:00Z" for hour in range(11, 23)]
    rows = [f"43.16,-77.61,{hour}" for hour in hours]
    (tmp_path / "q.csv").write_text("\n".join(["latitude_deg,longitude_deg,time", *rows]) + "\n", encoding="utf-8")
    text = run_malus("sun", "--input", tmp_path / "q.csv")
    assert np.array_equal(np.stack(malus.sun(*ROCHESTER, hours), axis=-1), numbers(text, "zenith_deg", "azimuth_deg", "distance_au"))


def test_times_of_all_kinds_are_one_moment() -> None:
    expected = malus.sun(*ROCHESTER, "2001-06-10T17:08:00Z")
    # a Julian day has 4e-10 of a day, and the sun moves by 360 degrees in one
    assert np.allclose(malus.sun(*ROCHESTER, "2001-06-10T13:08:00-04:00"), expected, rtol=0, atol=1e-6)
    assert malus.sun(*ROCHESTER, datetime(2001, 6, 10, 13, 8, tzinfo=timezone(timedelta(hours=-4)))) == expected
    assert malus.sun(*ROCHESTER, np.datetime64("2001-06-10T17:08:00")) == expected
    assert malus.sun(*ROCHESTER, "2001-06-10T17:09:00Z") != expected
    days = np.array(["2001-06-10T17:08", "2001-07-10T17:08"], dtype="datetime64[m]")
    assert malus.sun(np.array([[43.16], [0]]), -77.61, days).zenith_deg.shape == (2, 2)
    # libnova caches a nutation for a tenth of a day: an earlier call may change the twelfth digit
    assert np.isclose(malus.sun(np.array([[43.16], [0]]), -77.61, days).zenith_deg[0, 0], expected.zenith_deg, rtol=0, atol=1e-11)


def test_refusals_of_the_sun() -> None:
    for latitude, longitude, time in [(91, 0, "2001-06-10T17:08:00Z"), (0, 0, "2001-06-10")]:
        expected = complaint("sun", "--latitude-deg", latitude, "--longitude-deg", longitude, "--time", time)
        with pytest.raises(ValueError) as refused:
            malus.sun(latitude, longitude, time)
        assert str(refused.value).split("; ")[1] == expected.split("; ")[1]
    with pytest.raises(ValueError, match="has no time zone"):
        malus.sun(*ROCHESTER, datetime(2001, 6, 10))


def test_a_dome_is_the_programs() -> None:
    text = run_malus("sky", "--wavelength-nm", 450, "--mu0", 0.5, "--albedo", 0.2, "--dome-step-deg", 15, "--irradiance", "astm-e490")
    dome = malus.sky(wavelength_nm=450, mu0=0.5, albedo=0.2, dome_step_deg=15, irradiance="astm-e490")
    assert dome.radiance.dims == ("wavelength_nm", "zenith_deg", "phi_deg", "stokes")
    assert np.array_equal(dome.radiance.values.reshape(-1, 4), numbers(text, "S0", "S1", "S2", "S3"))
    assert np.array_equal(np.repeat(dome.zenith_deg, dome.phi_deg.size), numbers(text, "zenith_deg")[:, 0])
    darker = malus.sky(wavelength_nm=450, mu0=0.5, albedo=0.2 - 1e-9, dome_step_deg=15, irradiance="astm-e490")
    assert not np.array_equal(dome.radiance, darker.radiance)  # the negative control


def test_a_hazy_dome_is_the_programs() -> None:
    haze = "scenes/data/aerosol-spheroids.csv"
    text = run_malus("sky", "--wavelength-nm", 700, "--mu0", 0.5, "--aerosol", haze, "--aerosol-tau", 0.1, "--dome-step-deg", 30)
    dome = malus.sky(wavelength_nm=700, mu0=0.5, aerosol=Path(haze), aerosol_tau=0.1, dome_step_deg=30)
    assert np.array_equal(dome.radiance.values.reshape(-1, 4), numbers(text, "S0", "S1", "S2", "S3"))


@pytest.mark.parametrize("direction, convention", [("down", "iprt"), ("up", "natraj")])
def test_directions_are_the_programs(direction: str, convention: str, tmp_path: Path) -> None:
    mu, phi = [0.2, 0.7, 1.0], [0.0, 33.3, 180.0]
    rows = [f"{m!r},{p!r}" for m in mu for p in phi]
    (tmp_path / "q.csv").write_text("\n".join(["mu,phi_deg", *rows]) + "\n", encoding="utf-8")
    text = run_malus("sky", "--tau", 0.5, "--albedo", 0.25, "--mu0", 0.6, "--tau-obs", 0.3, "--direction", direction,
                     "--convention", convention, "--input", tmp_path / "q.csv")
    light = malus.sky(tau=0.5, albedo=0.25, mu0=0.6, tau_obs=0.3, direction=direction, convention=convention, mu=mu, phi_deg=phi)
    assert np.array_equal(light.radiance.values.reshape(-1, 4), numbers(text, "I", "Q", "U", "V"))
    assert light.stokes.values.tolist() == ["I", "Q", "U", "V"]


def test_a_sky_that_is_not_air_is_the_programs() -> None:
    text = run_malus("sky", "--model", "uniform", "--temperature-K", 230, "--wavelength-nm", 10000, "--mu", 0.5)
    light = malus.sky("uniform", temperature_K=230, wavelength_nm=10000, mu=0.5, phi_deg=0)
    assert np.array_equal(light.radiance.values.reshape(-1, 4), numbers(text, "I", "Q", "U", "V"))
    assert set(malus.skies()) == {line.split()[0] for line in run_malus("sky", "--list").splitlines()}
    assert malus.skies()["rayleigh"]["parameters"]["albedo"].high == 1


def test_wavelengths_are_skies_beside_each_other() -> None:
    both = malus.sky(wavelength_nm=[450, 650], sun_zenith_deg=60, dome_step_deg=30)
    assert np.array_equal(both.radiance[1], malus.sky(wavelength_nm=650, sun_zenith_deg=60, dome_step_deg=30).radiance[0])
    assert not np.array_equal(both.radiance[0], both.radiance[1])


@pytest.mark.parametrize("words, flags", [
    ({"wavelength_nm": 450, "mu0": 0.5, "albdo": 0.1, "mu": 1}, None),
    ({"wavelength_nm": 450, "mu0": 0.5, "albedo": 2, "mu": 1}, ("--wavelength-nm", 450, "--mu0", 0.5, "--albedo", 2, "--mu", 1)),
    ({"model": "raleigh", "mu0": 0.5, "mu": 1}, ("--model", "raleigh", "--mu0", 0.5, "--mu", 1)),
    ({"tau": 0.5, "mu0": 0.5, "tau_obs": 1, "mu": 1}, ("--tau", 0.5, "--mu0", 0.5, "--tau-obs", 1, "--mu", 1)),
])
def test_refusals_of_the_sky(words: dict[str, Any], flags: tuple[Any, ...] | None) -> None:
    with pytest.raises(ValueError) as refused:
        malus.sky(**words)
    assert "\n" not in str(refused.value)
    if flags is None:
        assert "did you mean albedo?" in str(refused.value)
    else:
        assert str(refused.value).split(": ", 2)[2] == complaint("sky", *flags).split(": ", 2)[2]


@pytest.mark.parametrize("words, message", [
    ({"sun_zenith_deg": 95}, "malus.sky: sun_zenith_deg = 95 deg: must be 0 to 90; give the angle from the zenith, in degrees"),
    ({"sun_zenith_deg": 5, "mu0": 1}, "malus.sky: sun_zenith_deg: conflicts with mu0; give one of them"),
    ({"sun_zenith_deg": 5, "dome_step_deg": 7}, "malus.sky: dome_step_deg = 7: does not divide 90; give e.g. 5"),
    ({"sun_zenith_deg": 5, "mu": np.ones((2, 2))}, "malus.sky: mu: has the shape (2, 2); give a number or an array with one axis"),
    ({}, "malus.sky: sun_zenith_deg: is missing; give sun_zenith_deg, or mu0, the cosine of the sun's zenith angle"),
])
def test_refusals_of_the_skys_arrays(words: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as refused:
        malus.sky(wavelength_nm=450, **words)
    assert str(refused.value) == message


NAMES = ["x_eff", "Q_ext", "Q_sca", "Q_abs", "Q_back", "albedo", "asymmetry"]
LENGTHS = ["effective_radius_um", "effective_variance", "C_ext_um2", "C_sca_um2"]


@pytest.mark.parametrize("words", [
    {"n": 1.55, "x": 5.2},
    {"n": 1.33, "medium_n": 1.2, "wavelength_nm": 450, "radius_um": 0.3},
    {"n": 1.44, "wavelength_nm": 550, "effective_radius_um": 0.2, "effective_variance": 0.07},
    {"n": 1.5, "k": 0.01, "wavelength_nm": 550, "median_radius_um": 0.1, "deviation": 1.5, "largest_radius_um": 1},
])
def test_spheres_are_the_programs(words: dict[str, Any]) -> None:
    flags = [word for name, value in words.items() for word in ("--" + name.replace("_", "-"), value)]
    spheres = malus.mie(**words)
    names = NAMES if "x" in words else NAMES + LENGTHS
    assert np.array_equal([getattr(spheres, name) for name in names], numbers(run_malus("mie", *flags), *names)[0])
    by_angle = numbers(run_malus("mie", *flags, "--matrix-step-deg", 30), "angle_deg", "F11", "-F12/F11", "F33/F11", "F34/F11")
    f = spheres.matrix(by_angle[:, 0])
    ours = [f[:, 0, 0], f[:, 0, 1] / f[:, 0, 0], f[:, 2, 2] / f[:, 0, 0], -f[:, 2, 3] / f[:, 0, 0]]
    assert np.array_equal(np.stack(ours, axis=-1), by_angle[:, 1:])
    columns = ["alpha1", "alpha2", "alpha3", "alpha4", "beta1", "beta2"]
    assert np.array_equal(spheres.greek(), numbers(run_malus("mie", *flags, "--greek"), *columns))
    assert malus.mie(**{**words, "n": words["n"] + 1e-9}).Q_ext != spheres.Q_ext  # the negative control


@pytest.mark.parametrize("words, message", [
    ({"n": 1.5}, "malus.mie: radius_um: is missing; give x, radius_um, effective_radius_um, median_radius_um or sizes"),
    ({"n": 1.5, "x": 1, "radius_um": 1}, "malus.mie: radius_um = 1: conflicts with x; specify their size exactly once"),
    ({"n": 1.5, "radius_um": 1}, "malus.mie: wavelength_nm: is missing; give it beside radius_um"),
    ({"n": 1.5, "x": 1, "deviation": 2}, "malus.mie: deviation = 2: has no meaning beside x; leave it out"),
    ({"n": 1000, "x": 1}, "malus.mie: n = 1000: must be 0.01 to 100; correct it"),
])
def test_refusals_of_spheres(words: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as refused:
        malus.mie(**words)
    assert str(refused.value) == message


@pytest.mark.parametrize("work", [
    lambda: malus.sky(wavelength_nm=np.linspace(400, 700, 500), sun_zenith_deg=60, dome_step_deg=2),  # minutes
    lambda: malus.sky(wavelength_nm=500, sun_zenith_deg=60, dome_step_deg=0.1),
    lambda: [malus.mie(1.5, 0.01, wavelength_nm=550, effective_radius_um=5, effective_variance=0.3, largest_radius_um=39) for _ in range(9)],
    lambda: malus.sun(np.zeros(30_000_000), 0, "2001-06-10T17:08:00Z"),
])
def test_ctrl_c_stops_a_long_call(work: Any) -> None:
    # a second is what a user waits; the rest is for a busy machine
    assert seconds_after_ctrl_c(work) < 4
