"""Stokes vectors and Mueller matrices in arrays.

A Stokes vector is the last axis, (S0, S1, S2, S3); a Mueller matrix the last two. All axes before broadcast. An
``xarray.DataArray`` with a dimension ``stokes`` is taken as well and comes back as one. Arrays of 32-bit numbers are
read as they are and give 32-bit results; intermediate values have 64 bits. A hole stays one: what is computed from a
NaN is NaN.
"""
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from . import _malus, checks

Bools = npt.NDArray[np.bool_]


def _of_stokes(name: str, function: Callable[..., Any], stokes: Any, *more: Any, keeps: bool = False, **words: Any) -> Any:
    """The function of an array, or of the dimension "stokes" of a DataArray."""
    if not isinstance(stokes, xr.DataArray):
        return function(stokes, *more, **words)
    checks.stokes_axis(name, stokes)
    return xr.apply_ufunc(function, stokes, *more, kwargs=words, input_core_dims=[["stokes"], *[[] for _ in more]],
                          output_core_dims=[["stokes"] if keeps else []])


def _named(array: Any, name: str, unit: str, meaning: str) -> Any:
    if isinstance(array, xr.DataArray):
        array.name = name
        array.attrs = {"units": unit, "long_name": meaning}
    return array


def dop(stokes: Any) -> Any:
    """Degree of polarisation, sqrt(S1^2 + S2^2 + S3^2) / S0.

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"

    Returns
    -------
    array, shape (...)
        0 where there is no light, inf where S0 is 0 and the rest is not, NaN where S0 is negative.
    """
    return _named(_of_stokes("dop", _malus.dop, stokes), "DoP", "1", "degree of polarisation")


def dolp(stokes: Any) -> Any:
    """Degree of linear polarisation, sqrt(S1^2 + S2^2) / S0.

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"

    Returns
    -------
    array, shape (...)
        Special cases as for `dop`.
    """
    return _named(_of_stokes("dolp", _malus.dolp, stokes), "DoLP", "1", "degree of linear polarisation")


def docp(stokes: Any) -> Any:
    """Degree of circular polarisation, |S3| / S0.

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"

    Returns
    -------
    array, shape (...)
        Special cases as for `dop`.
    """
    return _named(_of_stokes("docp", _malus.docp, stokes), "DoCP", "1", "degree of circular polarisation")


def aolp(stokes: Any) -> Any:
    """Angle of linear polarisation, atan2(S2, S1) / 2, in [0, 180).

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"

    Returns
    -------
    array, shape (...) [deg]
        Counter-clockwise from horizontal for who looks back at the source; 0 where nothing is linearly polarised.
    """
    return _named(_of_stokes("aolp", _malus.aolp, stokes), "AoLP", "degree", "angle of linear polarisation")


def is_physical(stokes: Any, tolerance: float = 1e-12) -> Any:
    """Whether light can be so: S0 >= 0, and the polarised part at most S0 (1 + tolerance).

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"
    tolerance : float
        Relative; numbers that were rounded to 32 bits need about 2.4e-7.

    Returns
    -------
    array of bool, shape (...)
    """
    return _of_stokes("is_physical", _malus.is_physical, stokes, tolerance=checks.tolerance("is_physical", tolerance))


def rotate(stokes: Any, angle_deg: npt.ArrayLike) -> Any:
    """The same light about axes that are turned counter-clockwise, looking back at the source.

    Parameters
    ----------
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"
    angle_deg : array_like, shape (...) [deg]

    Returns
    -------
    array, shape (..., 4)
    """
    return _of_stokes("rotate", _malus.rotate, stokes, angle_deg, keeps=True)


def rotate_mueller(mueller: npt.ArrayLike, angle_deg: npt.ArrayLike) -> npt.NDArray[Any]:
    """The same element about turned axes: R(angle) M R(-angle).

    Parameters
    ----------
    mueller : array_like, shape (..., 4, 4)
    angle_deg : array_like, shape (...) [deg]

    Returns
    -------
    array, shape (..., 4, 4)
    """
    return _malus.rotate_mueller(mueller, angle_deg)


def apply(mueller: npt.ArrayLike, stokes: Any) -> Any:
    """Light behind elements, M S.

    Parameters
    ----------
    mueller : array_like, shape (..., 4, 4)
    stokes : array_like, shape (..., 4), or DataArray with a dimension "stokes"
        With a DataArray the matrix has no other axes.

    Returns
    -------
    array, shape (..., 4)
    """
    return _of_stokes("apply", lambda s: _malus.apply(mueller, s), stokes, keeps=True)


def product(*muellers: npt.ArrayLike) -> npt.NDArray[Any]:
    """Elements one after another; light meets the last one first.

    Parameters
    ----------
    *muellers : array_like, shape (..., 4, 4)
        At least one.

    Returns
    -------
    array, shape (..., 4, 4)
    """
    if not muellers:
        raise ValueError("malus.product: needs a Mueller matrix; give one or more")
    factors = [checks.elements("product", f"muellers[{i}]", one, (4, 4)) for i, one in enumerate(muellers)]
    result = factors[0]
    for right in factors[1:]:
        result = _malus.product(result, right)
    return result


def is_realizable(mueller: npt.ArrayLike, tolerance: float = 1e-12) -> Bools:
    """Whether an element can exist: Cloude's coherency matrix has no negative eigenvalue.

    Parameters
    ----------
    mueller : array_like, shape (..., 4, 4)
    tolerance : float
        The smallest eigenvalue is at least -tolerance m00; numbers that were rounded to 32 bits need about 2.4e-7.

    Returns
    -------
    array of bool, shape (...)
    """
    return _malus.is_realizable(mueller, checks.tolerance("is_realizable", tolerance))


def coherency_eigenvalues(mueller: npt.ArrayLike) -> npt.NDArray[Any]:
    """Eigenvalues of Cloude's coherency matrix, falling; their sum is m00.

    Parameters
    ----------
    mueller : array_like, shape (..., 4, 4)

    Returns
    -------
    array, shape (..., 4)
    """
    return _malus.coherency_eigenvalues(mueller)


class LuChipman(NamedTuple):
    """M = depolarizer retarder diattenuator, element by element (Lu and Chipman 1996)."""

    depolarizer: npt.NDArray[Any]  #: (..., 4, 4), m00 = 1
    retarder: npt.NDArray[Any]  #: (..., 4, 4), a rotation of (S1, S2, S3)
    diattenuator: npt.NDArray[Any]  #: (..., 4, 4), symmetric; carries the m00 of M
    diattenuation: npt.NDArray[Any]  #: (...), 0 to 1
    retardance_deg: npt.NDArray[Any]  #: (...), 0 to 180
    depolarization_power: npt.NDArray[Any]  #: (...), 1 - |trace of the depolariser's 3 x 3 part| / 3
    depolarization_index: npt.NDArray[Any]  #: (...), of M: 1 for none, 0 for an ideal depolariser


def lu_chipman(mueller: npt.ArrayLike) -> LuChipman:
    """The factors of Mueller matrices.

    Parameters
    ----------
    mueller : array_like, shape (..., 4, 4)

    Returns
    -------
    LuChipman
        NaN for a matrix that cannot be taken apart: not finite, m00 <= 0 (except the zero matrix, which transmits nothing), or a
        diattenuation above 1.
    """
    return LuChipman(*_malus.lu_chipman(mueller))


def linear_polarizer(angle_deg: npt.ArrayLike) -> npt.NDArray[Any]:
    """Filters that pass light linearly polarised along an angle.

    Parameters
    ----------
    angle_deg : array_like, shape (...) [deg]
        Counter-clockwise from horizontal.

    Returns
    -------
    array, shape (..., 4, 4)
    """
    return _malus.linear_polarizer(angle_deg)


def retarder(retardance_deg: npt.ArrayLike, fast_axis_deg: npt.ArrayLike = 0.0) -> npt.NDArray[Any]:
    """Plates that delay the slow axis against the fast one.

    Parameters
    ----------
    retardance_deg, fast_axis_deg : array_like, shape (...) [deg]

    Returns
    -------
    array, shape (..., 4, 4)
    """
    return _malus.retarder(retardance_deg, fast_axis_deg)
