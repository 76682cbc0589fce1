"""Surfaces: Mueller BRDFs, reflectances, emissivities."""
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _malus, checks

Floats = npt.NDArray[np.float64]
KNOWN = "give a name of malus.models()"


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model or a sky.

    Attributes
    ----------
    name, unit, meaning : str
        ``unit`` is empty for a pure number.
    low, high : float
        Interval of a number; both are 0 for a word or a file.
    open : bool
        Whether ``low`` itself is not allowed.
    words : tuple of str
        If not empty, the parameter is one of these words.
    default : str or None
        What it is if it is not given; None if it must be given, or may be absent (``optional``).
    spectral : bool
        Whether it may be an array, one number for each wavelength.
    file : bool
        Whether it is the name of a file.
    optional : bool
        Whether it may be absent and then has no value.
    """

    name: str
    unit: str
    meaning: str
    low: float
    high: float
    open: bool
    words: tuple[str, ...]
    default: str | None
    spectral: bool
    file: bool
    optional: bool


@dataclass(frozen=True)
class Model:
    """A reflectance model: its description and its properties.

    Attributes
    ----------
    name, summary, citation, materials : str
    parameters : dict of str to Parameter
    polarized, reciprocal, conserves : bool
        Whether it polarises light that was not; whether source and viewer may be exchanged; whether it never returns more than
        it receives. The last two are True if they hold with all settings.
    example : dict of str to str
        Parameters to begin with: ``malus.brdf(m.name, 30, 40, 180, **m.example)``.
    """

    name: str
    summary: str
    citation: str
    materials: str
    parameters: dict[str, Parameter]
    polarized: bool
    reciprocal: bool
    conserves: bool
    example: dict[str, str]


def parameters_of(described: dict[str, dict[str, Any]]) -> dict[str, Parameter]:
    return {name: Parameter(name=name, **one) for name, one in described.items()}


def models() -> dict[str, Model]:
    """All reflectance models, by name, with parameters, units and intervals.

    Returns
    -------
    dict of str to Model

    Examples
    --------
    >>> malus.models()["torrance-sparrow"].parameters["sigma"].unit
    'rad'
    """
    def model(name: str, one: dict[str, Any]) -> Model:
        example = dict(word.split("=", 1) for word in one["example"].split())
        rest = {key: value for key, value in one.items() if key not in ("parameters", "example")}
        return Model(name=name, parameters=parameters_of(one["parameters"]), example=example, **rest)
    return {name: model(name, one) for name, one in _malus.models().items()}


def brdf(model: str, theta_i_deg: npt.ArrayLike, theta_r_deg: npt.ArrayLike, phi_deg: npt.ArrayLike,
         wavelength_nm: npt.ArrayLike = 550.0, **parameters: Any) -> Floats:
    """Mueller matrices of a surface per steradian.

    Angles and wavelengths broadcast. Many wavelengths are fastest along a separate axis: the geometry is then computed
    once for all of them.

    Parameters
    ----------
    model : str
        A name of ``malus.models()``.
    theta_i_deg, theta_r_deg : array_like
        Zenith angles of source and viewer, from the surface normal, 0 to 90 [deg]. A NaN gives NaN.
    phi_deg : array_like
        Azimuth from source to viewer, counter-clockwise from above; 180 is specular [deg]. A NaN gives NaN.
    wavelength_nm : array_like
        Wavelength in vacuum [nm].
    **parameters
        Of the model: numbers, words, names of files. A spectral one may be an array of the shape of ``wavelength_nm``.

    Returns
    -------
    numpy.ndarray, float64, shape (..., 4, 4)
        Mueller BRDF [1/sr]. The first axis of the Stokes vectors is perpendicular to the plane of incidence, or of reflection.

    Raises
    ------
    ValueError
        With the one line that ``malus brdf`` prints: unknown model or parameter, an angle out of range, shapes that do not broadcast.

    Examples
    --------
    >>> malus.brdf("lambertian", 30, 40, 180, reflectance=0.2)[0, 0].round(4)
    0.0637
    >>> nm = np.linspace(400, 700, 100)
    >>> malus.brdf("torrance-sparrow", 30, np.arange(90.)[:, None], 180, nm, n=1.5, k=0, sigma=0.1).shape
    (90, 100, 4, 4)
    """
    return _malus.brdf(checks.text("brdf", "model", model, KNOWN), theta_i_deg, theta_r_deg, phi_deg, wavelength_nm, parameters)


def dhr(model: str, theta_i_deg: npt.ArrayLike, wavelength_nm: npt.ArrayLike = 550.0, **parameters: Any) -> Floats:
    """Directional-hemispherical reflectance of unpolarised light.

    Parameters
    ----------
    model : str
        A name of ``malus.models()``.
    theta_i_deg : array_like
        Zenith angle of the source, 0 to 90, without 90 [deg].
    wavelength_nm : array_like
        Wavelength in vacuum [nm].
    **parameters
        As for `brdf`.

    Returns
    -------
    numpy.ndarray, float64, shape (...)
        A part of one; a float for scalars.
    """
    return _malus.dhr(checks.text("dhr", "model", model, KNOWN), theta_i_deg, wavelength_nm, parameters)


def emissivity(model: str, theta_r_deg: npt.ArrayLike, wavelength_nm: npt.ArrayLike = 550.0, **parameters: Any) -> Floats:
    """Stokes column of what a warm surface sends out, as a part of a black body's radiance.

    Parameters
    ----------
    model : str
        A name of ``malus.models()``.
    theta_r_deg : array_like
        Zenith angle of the viewer, 0 to 90, without 90 [deg].
    wavelength_nm : array_like
        Wavelength in vacuum [nm].
    **parameters
        As for `brdf`.

    Returns
    -------
    numpy.ndarray, float64, shape (..., 4)
        Emissivity (e0, e1, e2, e3), with e0 + e1 that of s and e0 - e1 that of p.
    """
    return _malus.emissivity(checks.text("emissivity", "model", model, KNOWN), theta_r_deg, wavelength_nm, parameters)
