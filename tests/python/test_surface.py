"""Surfaces from Python against malus brdf, to the last bit (nw/python/PySurface.nw, nw/python/PyArrays.nw)."""
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Array, complaint, numbers, run_malus, seconds_after_ctrl_c

import malus

COPPER: dict[str, Any] = {"n": 0.405, "k": 2.950, "sigma": 0.2}
ELEMENTS = [f"f{i}{j}" for i in range(4) for j in range(4)]


def geometries(rng: np.random.Generator, count: int) -> tuple[Array, Array, Array]:
    return rng.uniform(0, 89, count), rng.uniform(0, 89, count), rng.uniform(-360, 360, count)


def by_program(folder: Path, model: str, parameters: dict[str, Any], columns: dict[str, Array], wavelength_nm: float = 550,
               what: tuple[str, ...] = ()) -> str:
    """The output of malus brdf for a file of geometries. repr() of a float keeps its bits."""
    rows = zip(*(column.tolist() for column in columns.values()))
    (folder / "q.csv").write_text("\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n", encoding="utf-8")
    flags = [word for name, value in parameters.items() for word in ("--param", f"{name}={value}")]
    return run_malus("brdf", "--model", model, *flags, "--input", folder / "q.csv", "--wavelength-nm", repr(float(wavelength_nm)), *what)


@pytest.mark.parametrize("name", sorted(malus.models()))
def test_every_model_is_the_programs_to_the_last_bit(name: str, tmp_path: Path, rng: np.random.Generator) -> None:
    example = malus.models()[name].example
    theta_i, theta_r, phi = geometries(rng, 40)
    text = by_program(tmp_path, name, example, {"theta_i_deg": theta_i, "theta_r_deg": theta_r, "phi_deg": phi})
    assert np.array_equal(malus.brdf(name, theta_i, theta_r, phi, **example).reshape(40, 16), numbers(text, *ELEMENTS))


@pytest.mark.parametrize("name", sorted(malus.models()))
def test_reflectance_is_the_programs(name: str, tmp_path: Path) -> None:
    example = malus.models()[name].example
    theta = np.array([0.0, 17.3, 60.0])
    text = by_program(tmp_path, name, example, {"theta_i_deg": theta}, what=("--dhr",))
    assert np.array_equal(malus.dhr(name, theta, **example), numbers(text, "dhr")[:, 0])


def test_emissivity_is_the_programs(tmp_path: Path) -> None:
    steel = {"n": 8.31, "k": 63, "sigma": 0.1}
    theta = np.array([0.0, 30.0, 60.0, 80.0])
    text = by_program(tmp_path, "torrance-sparrow", steel, {"theta_r_deg": theta}, what=("--emissivity",))
    assert np.array_equal(malus.emissivity("torrance-sparrow", theta, **steel), numbers(text, "e0", "e1", "e2", "e3"))


def test_negative_control_another_roughness_is_another_matrix(tmp_path: Path, rng: np.random.Generator) -> None:
    theta_i, theta_r, phi = geometries(rng, 5)
    text = by_program(tmp_path, "torrance-sparrow", COPPER, {"theta_i_deg": theta_i, "theta_r_deg": theta_r, "phi_deg": phi})
    other = malus.brdf("torrance-sparrow", theta_i, theta_r, phi, n=0.405, k=2.950, sigma=np.nextafter(0.2, 1))
    assert not np.array_equal(other.reshape(5, 16), numbers(text, *ELEMENTS))


def test_a_lattice_of_angles_is_a_list_of_geometries() -> None:
    """Few angles are turned into cosines once; the bits are those of a list, for which they are not."""
    a, b, c = np.linspace(0, 90, 9)[:-1], np.linspace(0, 89, 7), np.linspace(-360, 360, 11)
    lattice = malus.brdf("torrance-sparrow", a[:, None, None], b[:, None], c, **COPPER)
    spread = [np.ascontiguousarray(x).ravel() for x in np.broadcast_arrays(a[:, None, None], b[:, None], c)]
    assert lattice.shape == (8, 7, 11, 4, 4)
    assert np.array_equal(lattice.reshape(-1, 4, 4), malus.brdf("torrance-sparrow", *spread, **COPPER))


def test_a_hundred_bands_are_a_hundred_calls(rng: np.random.Generator) -> None:
    nm = np.linspace(400, 700, 100)
    n, k = np.linspace(0.4, 1.2, 100), np.linspace(2, 3, 100)
    theta_i, theta_r, phi = geometries(rng, 6)
    together = malus.brdf("torrance-sparrow", theta_i[:, None], theta_r[:, None], phi[:, None], nm, n=n, k=k, sigma=0.2)
    assert together.shape == (6, 100, 4, 4)
    for band in range(0, 100, 9):
        alone = malus.brdf("torrance-sparrow", theta_i, theta_r, phi, nm[band], n=n[band], k=k[band], sigma=0.2)
        assert np.array_equal(together[:, band], alone), band


def test_wavelengths_stand_on_any_axis_in_any_order(rng: np.random.Generator) -> None:
    nm, n = np.array([700.0, 400.0, 550.0, 400.0]), np.array([1.3, 1.5, 1.4, 1.5])
    theta_i, theta_r, phi = geometries(rng, 3)
    last = malus.brdf("torrance-sparrow", theta_i[:, None], theta_r[:, None], phi[:, None], nm, n=n, k=0, sigma=0.1)
    first = malus.brdf("torrance-sparrow", theta_i, theta_r, phi, nm[:, None], n=n[:, None], k=0, sigma=0.1)
    assert np.array_equal(last, first.swapaxes(0, 1))
    assert np.array_equal(last[:, 1], last[:, 3])
    assert not np.array_equal(last[:, 0], last[:, 1])


def test_wavelengths_that_vary_with_the_angles(rng: np.random.Generator) -> None:
    nm, n = np.array([700.0, 400.0, 550.0]), np.array([1.3, 1.5, 1.4])
    theta_i, theta_r, phi = geometries(rng, 3)
    paired = malus.brdf("torrance-sparrow", theta_i, theta_r, phi, nm, n=n, k=0, sigma=0.1)
    for i in range(3):
        assert np.array_equal(paired[i], malus.brdf("torrance-sparrow", theta_i[i], theta_r[i], phi[i], nm[i], n=n[i], k=0, sigma=0.1))
    assert np.array_equal(malus.dhr("torrance-sparrow", theta_i, nm, n=n, k=0, sigma=0.1)[1],
                          malus.dhr("torrance-sparrow", theta_i[1], nm[1], n=1.5, k=0, sigma=0.1))


def test_layouts_of_memory_give_the_same(rng: np.random.Generator) -> None:
    theta = rng.uniform(0, 89, (4, 6))
    whole = malus.brdf("torrance-sparrow", theta, theta / 2, 170, **COPPER)
    assert np.array_equal(whole.swapaxes(0, 1), malus.brdf("torrance-sparrow", theta.T, theta.T / 2, 170, **COPPER))
    assert np.array_equal(whole[::-2, ::3], malus.brdf("torrance-sparrow", theta[::-2, ::3], theta[::-2, ::3] / 2, 170, **COPPER))
    single = theta.astype(np.float32)
    assert np.array_equal(malus.brdf("torrance-sparrow", single, 20, 170, **COPPER),
                          malus.brdf("torrance-sparrow", single.astype(np.float64), 20, 170, **COPPER))
    swapped = theta.astype(theta.dtype.newbyteorder())
    assert np.array_equal(whole, malus.brdf("torrance-sparrow", swapped, theta / 2, 170, **COPPER))
    assert malus.brdf("torrance-sparrow", np.empty((0, 3)), 20, 170, **COPPER).shape == (0, 3, 4, 4)
    assert malus.brdf("torrance-sparrow", 30, [20, 40], 170, **COPPER).shape == (2, 4, 4)


def test_a_scalar_is_a_float() -> None:
    assert isinstance(malus.dhr("lambertian", 30, reflectance=0.2), float)
    assert malus.brdf("lambertian", 30, 40, 180, reflectance=0.2).shape == (4, 4)


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 63, 64, 65, 1_000_003])
def test_blocks_that_are_not_full_give_the_same(count: int, rng: np.random.Generator) -> None:
    """Registers, blocks and shares of threads end raggedly; every geometry has the bits that it has alone."""
    angles = geometries(rng, count)
    whole = malus.brdf("torrance-sparrow", *angles, **COPPER)
    assert whole.shape == (count, 4, 4)
    for i in {0, 1, 6, 62, 64, *rng.integers(0, max(count, 1), 50), count - 2, count - 1}:
        if 0 <= i < count:
            alone = malus.brdf("torrance-sparrow", *(float(angle[i]) for angle in angles), **COPPER)
            assert np.array_equal(whole[i], alone), i
    behind = malus.brdf("torrance-sparrow", *(angle[3:] for angle in angles), **COPPER)  # all at other places of their blocks
    assert np.array_equal(whole[3:], behind)


def test_many_elements_in_threads_are_the_few_in_one(rng: np.random.Generator) -> None:
    theta_i, theta_r, phi = geometries(rng, 20_000)
    whole = malus.brdf("torrance-sparrow", theta_i, theta_r, phi, **COPPER)
    for first in (0, 4090, 19_990):
        part = slice(first, first + 10)
        assert np.array_equal(whole[part], malus.brdf("torrance-sparrow", theta_i[part], theta_r[part], phi[part], **COPPER))


def test_a_hole_in_the_angles_is_a_hole_in_the_answer() -> None:
    f = malus.brdf("torrance-sparrow", [30, np.nan], 40, 180, **COPPER)
    assert np.isfinite(f[0]).all() and np.isnan(f[1, 0, 0])
    assert np.isnan(malus.dhr("lambertian", [np.nan, 20], reflectance=0.2)).tolist() == [True, False]


COMMAND = ("brdf", "--theta-i-deg", 30, "--theta-r-deg", 40, "--phi-deg", 180)


@pytest.mark.parametrize("model, parameters", [
    ("torrence-sparrow", {}),
    ("torrance-sparrow", {**COPPER, "sigma": -1}),
    ("torrance-sparrow", {**COPPER, "sigmaa": 1}),
    ("torrance-sparrow", {**COPPER, "shadowing": "v-grove"}),
])
def test_refusals_have_the_programs_sentence(model: str, parameters: dict[str, Any]) -> None:
    flags = [word for name, value in parameters.items() for word in ("--param", f"{name}={value}")]
    expected = complaint(*COMMAND, "--model", model, *flags)
    with pytest.raises(ValueError) as refused:
        malus.brdf(model, 30, 40, 180, **parameters)
    assert str(refused.value).split(": ", 2)[2] == expected.split(": ", 2)[2], (str(refused.value), expected)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("call, message", [
    (lambda: malus.brdf("lambertian", 95, 40, 180, reflectance=0.2),
     "malus.brdf: theta_i_deg = 95 deg: must be 0 to 90; give the angle from the surface normal, in degrees"),
    (lambda: malus.brdf("lambertian", np.zeros(3), np.zeros((2, 4)), 180, reflectance=0.2),
     "malus.brdf: theta_r_deg: has the shape (2, 4) and theta_i_deg the shape (3,), which do not broadcast; "
     "give lengths that are equal or 1, counted from the last axis"),
    (lambda: malus.brdf("lambertian", "steep", 40, 180, reflectance=0.2),
     "malus.brdf: theta_i_deg: does not hold real numbers; give a number or an array"),
    (lambda: malus.brdf("lambertian", 1j, 40, 180, reflectance=0.2),
     "malus.brdf: theta_i_deg: does not hold real numbers; give a number or an array"),
    (lambda: malus.brdf("lambertian", 30, 40, 180, 0, reflectance=0.2),
     "malus.brdf: wavelength_nm = 0 nm: must be above 0; give e.g. 550"),
    (lambda: malus.brdf("torrance-sparrow", 30, 40, 180, [500, 600], n=[1, 2, 3], k=0, sigma=0.1),
     "malus.brdf: n: has the shape (3,) and wavelength_nm the shape (2,); give one number, or one for each wavelength"),
    (lambda: malus.brdf("torrance-sparrow", 30, 40, 180, [500, 500], n=[1.5, 2], k=0, sigma=0.1),
     "malus.brdf: n = 2: is a second value at 500 nm; give one value for a wavelength"),
    (lambda: malus.dhr("lambertian", 90, reflectance=0.2),
     "malus.dhr: theta_i_deg = 90 deg: must be 0 to 90, without 90; give the angle from the surface normal, in degrees"),
    (lambda: malus.brdf("torrance-sparrow", 90, 40, 180, shadowing="none", **COPPER),
     "malus.brdf: theta_i_deg = 90 deg: has no finite BRDF here; stay below 90, or choose a shadowing other than none"),
])
def test_refusals_of_arrays(call: Any, message: str) -> None:
    with pytest.raises(ValueError) as refused:
        call()
    assert str(refused.value) == message


def test_the_first_mistake_is_reported_whatever_the_threads_do() -> None:
    theta = np.zeros(50_000)
    theta[10_000], theta[40_000] = 91, 92
    for _ in range(5):
        with pytest.raises(ValueError, match="theta_i_deg = 91 deg"):
            malus.brdf("lambertian", theta, np.zeros(50_000), 180, reflectance=0.2)


def naps_during(work: Any) -> int:
    """How often another thread woke while the work was done in this one."""
    naps, done = 0, threading.Event()

    def nap() -> None:
        nonlocal naps
        while not done.is_set():
            time.sleep(0.001)
            naps += 1
    sleeper = threading.Thread(target=nap)
    sleeper.start()
    before = naps
    work()
    during = naps - before
    done.set()
    sleeper.join()
    return during


def test_other_threads_go_on_during_a_call(rng: np.random.Generator) -> None:
    """Beside a call that holds Python's lock another thread wakes a few times, before and after; the sum is such a call. On a busy
    machine there are some more of these, and so both are counted: beside a call without the lock the thread wakes each millisecond."""
    theta_i, theta_r, phi = geometries(rng, 3_000_000)
    held = naps_during(lambda: sum(range(20_000_000)))
    assert naps_during(lambda: malus.brdf("torrance-sparrow", theta_i, theta_r, phi, **COPPER)) > 5 * max(held, 1)


def test_models_describe_themselves() -> None:
    sigma = malus.models()["torrance-sparrow"].parameters["sigma"]
    assert (sigma.unit, sigma.low, sigma.default, sigma.spectral) == ("rad", 1e-6, None, True)
    assert "v-groove" in malus.models()["torrance-sparrow"].parameters["shadowing"].words
    listed = {line.split()[0] for line in run_malus("brdf", "--list").split("\n\n")[0].splitlines()}
    assert set(malus.models()) == listed


NM = np.linspace(400, 700, 500)
STEEP = np.linspace(0, 89, 100_000)


@pytest.mark.parametrize("work", [
    lambda: malus.emissivity("torrance-sparrow", STEEP, **COPPER),  # minutes
    lambda: malus.dhr("torrance-sparrow", STEEP, **COPPER),
    lambda: malus.emissivity("torrance-sparrow", STEEP[::1000], NM[:, None], **COPPER),  # few angles, which one thread computes
    lambda: malus.emissivity("torrance-sparrow", STEEP[::50], NM[:, None], **COPPER),
    lambda: malus.dhr("layered-paint", 30, NM, **malus.models()["layered-paint"].example),  # 500 tables of scattered light
    lambda: [malus.brdf("torrance-sparrow", STEEP[:, None], 40, np.arange(100), **COPPER) for _ in range(99)],
    lambda: [malus.brdf("torrance-sparrow", STEEP[:, None], 40, 180, NM[:40], **COPPER) for _ in range(99)],
])
def test_ctrl_c_stops_a_long_call(work: Any) -> None:
    # a second is what a user waits; the rest is for a busy machine
    assert seconds_after_ctrl_c(work) < 4
