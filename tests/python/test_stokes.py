"""Stokes vectors and Mueller matrices in arrays (nw/python/PyLight.nw)."""
from typing import Any

import numpy as np
import pytest
import xarray as xr
from conftest import Array

import malus

HORIZONTAL, DIAGONAL, CIRCULAR = [1, 1, 0, 0], [1, 0, 1, 0], [1, 0, 0, 1]


def physical(rng: np.random.Generator, *shape: int) -> Array:
    """Light that can exist: a part of it polarised."""
    s = rng.normal(size=(*shape, 4))
    s[..., 0] = np.linalg.norm(s[..., 1:], axis=-1) * rng.uniform(1, 3, shape)
    return s


def test_states_of_the_textbook() -> None:
    light = np.array([HORIZONTAL, DIAGONAL, CIRCULAR, [2, -1, 0, 0], [1, 0, -1, 0], [0, 0, 0, 0]])
    assert malus.dop(light).tolist() == [1, 1, 1, 0.5, 1, 0]
    assert malus.dolp(light).tolist() == [1, 1, 0, 0.5, 1, 0]
    assert malus.docp(light).tolist() == [0, 0, 1, 0, 0, 0]
    assert malus.aolp(light).tolist() == [0, 45, 0, 90, 135, 0]
    assert malus.is_physical(light).all() and not malus.is_physical([1, 1, 1, 0])


def test_formulas_are_those_of_the_header(rng: np.random.Generator) -> None:
    s = physical(rng, 5, 7)
    # a fused multiply-add rounds once less than NumPy
    assert np.allclose(malus.dolp(s), np.sqrt(s[..., 1] ** 2 + s[..., 2] ** 2) / s[..., 0], rtol=5e-16, atol=0)
    # atan2 of two libraries may differ in the last place
    assert np.allclose(malus.aolp(s), np.degrees(np.arctan2(s[..., 2], s[..., 1]) / 2) % 180, rtol=0, atol=1e-13)
    assert not np.allclose(malus.aolp(s), np.degrees(np.arctan2(s[..., 1], s[..., 2]) / 2) % 180, rtol=0, atol=1e-13)


def test_an_angle_of_32_bits_stays_below_180() -> None:
    s = np.array([1, 1, -1e-12, 0])
    assert 179.9 < malus.aolp(s) < 180
    assert malus.aolp(s.astype(np.float32)) == 0
    assert malus.aolp(s.astype(np.float32)).dtype == np.float32


def test_32_bits_go_in_and_come_out(rng: np.random.Generator) -> None:
    s = physical(rng, 100).astype(np.float32)
    assert malus.dolp(s).dtype == np.float32
    assert np.array_equal(malus.dolp(s), malus.dolp(s.astype(np.float64)).astype(np.float32))
    assert malus.rotate(s, np.arange(100.0)).dtype == np.float32


def test_layouts_of_memory_give_the_same(rng: np.random.Generator) -> None:
    s = physical(rng, 6, 8)
    planes = np.moveaxis(np.ascontiguousarray(np.moveaxis(s, -1, 0)), 0, -1)  # as a cube of type BSQ lies
    assert not planes.flags.c_contiguous
    assert np.array_equal(malus.dolp(planes), malus.dolp(s))
    assert np.array_equal(malus.dolp(s[::-1, ::2]), malus.dolp(s)[::-1, ::2])
    shifted = np.frombuffer(b"\0" + s.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(s.shape)
    assert np.array_equal(malus.dolp(shifted), malus.dolp(s))


def test_products_are_those_of_numpy(rng: np.random.Generator) -> None:
    a, b, s = rng.normal(size=(3, 1, 4, 4)), rng.normal(size=(5, 4, 4)), rng.normal(size=(5, 4))
    # sums of four products in another order, or fused: a few roundings
    assert np.allclose(malus.product(a, b), a @ b, rtol=0, atol=1e-14)
    assert np.allclose(malus.apply(a, s), np.einsum("abij,bj->abi", np.broadcast_to(a, (3, 5, 4, 4)), s), rtol=0, atol=1e-14)
    assert malus.product(a, b).shape == (3, 5, 4, 4)
    assert not np.allclose(malus.product(a, b), b @ a, rtol=0, atol=1e-14)
    assert np.allclose(malus.product(a, b, b), a @ b @ b, rtol=0, atol=1e-13)


def test_rotations(rng: np.random.Generator) -> None:
    assert np.allclose(malus.rotate(HORIZONTAL, 45), [1, 0, -1, 0], rtol=0, atol=1e-15)
    s, angle = physical(rng, 50), rng.uniform(-180, 180, 50)
    turned = malus.rotate(s, angle)
    assert np.allclose(malus.dolp(turned), malus.dolp(s), rtol=1e-14)  # a rotation keeps lengths but for rounding
    off = (malus.aolp(s) - angle - malus.aolp(turned) + 90) % 180 - 90
    assert np.abs(off).max() < 1e-11
    polarizer = malus.linear_polarizer([0, 30, 60])
    assert np.allclose(malus.rotate_mueller(polarizer[0], [0, -30, -60]), polarizer, rtol=0, atol=1e-15)


def test_an_element_taken_apart() -> None:
    passing = np.array([[0.625, 0.375, 0, 0], [0.375, 0.625, 0, 0], [0, 0, 0.5, 0], [0, 0, 0, 0.5]])  # all along, a quarter across
    m = malus.product(malus.retarder(90, 20), malus.rotate_mueller(passing, -10))
    parts = malus.lu_chipman(m)
    # products of three matrices with numbers of about one
    assert np.allclose(malus.product(*parts[:3]), m, rtol=0, atol=1e-12)
    assert np.isclose(parts.retardance_deg, 90, rtol=0, atol=1e-9) and abs(parts.depolarization_power) < 1e-12
    both = malus.lu_chipman(np.stack([m, np.diag([1, 0.5, 0.5, 0.5])]))
    assert both.retarder.shape == (2, 4, 4) and np.isclose(both.depolarization_power[1], 0.5, rtol=0, atol=1e-12)


def test_a_dead_pixel_is_a_hole_and_spoils_no_other() -> None:
    good, dead = malus.retarder(90, 20), np.full((4, 4), np.nan)
    beyond = np.eye(4) + 2 * np.eye(4, k=1)  # a diattenuation of 2
    parts = malus.lu_chipman(np.stack([good, dead, -good, beyond, np.zeros((4, 4)), good]))
    for part, alone in zip(parts, malus.lu_chipman(good)):
        assert np.isnan(part[1:4]).all() and np.isfinite(part[4]).all()
        assert np.array_equal(part[0], alone) and np.array_equal(part[5], alone)


def test_what_can_exist() -> None:
    mirror, transposer = np.diag([1.0, 1, -1, -1]), np.diag([1.0, 1, 1, -1])
    assert malus.is_realizable(np.stack([mirror, transposer, np.eye(4)])).tolist() == [True, False, True]
    assert np.allclose(malus.coherency_eigenvalues(mirror), [1, 0, 0, 0], rtol=0, atol=1e-15)


def test_a_dataarray_comes_back_as_one(rng: np.random.Generator) -> None:
    s = xr.DataArray(physical(rng, 3, 5), dims=("y", "band", "stokes"), coords={"band": np.arange(5)}).transpose("stokes", "y", "band")
    dolp = malus.dolp(s)
    assert dolp.dims == ("y", "band") and dolp.attrs["units"] == "1" and dolp.band.size == 5
    assert np.array_equal(dolp.values, malus.dolp(np.moveaxis(s.values, 0, -1)))
    assert malus.rotate(s, 30).dims == ("y", "band", "stokes")
    assert malus.apply(malus.linear_polarizer(0), s).dims == ("y", "band", "stokes")


@pytest.mark.parametrize("call, message", [
    (lambda: malus.dolp(np.zeros((2, 3))),
     "malus.dolp: stokes: has the shape (2, 3); give an array whose last axis holds S0, S1, S2, S3"),
    (lambda: malus.is_realizable(np.zeros(4)),
     "malus.is_realizable: mueller: has the shape (4,); give an array whose last two axes are a 4 x 4 matrix"),
    (lambda: malus.apply(np.zeros((3, 4, 4)), np.zeros((2, 4))),
     "malus.apply: stokes: has the shape (2, 4) and mueller the shape (3, 4, 4), which do not broadcast; "
     "give lengths that are equal or 1, counted from the last axis"),
])
def test_refusals(call: Any, message: str) -> None:
    with pytest.raises(ValueError) as refused:
        call()
    assert str(refused.value) == message
