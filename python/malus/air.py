"""The sun, the sky, and small spheres."""
import math
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from . import _malus, checks
from .surface import parameters_of


ANGLE = "give the angle from the zenith, in degrees"
SUNLIGHT = 'give "pi", "astm-e490" or a number'


class SunPosition(NamedTuple):
    """The position of the sun's centre, without refraction."""

    zenith_deg: npt.NDArray[np.float64]  #: (...), above 90: below the horizon
    azimuth_deg: npt.NDArray[np.float64]  #: (...), compass, clockwise from north, 0 to 360
    distance_au: npt.NDArray[np.float64]  #: (...)


def _julian_day(time: Any) -> float:
    if isinstance(time, np.datetime64):
        time = np.datetime_as_string(time, unit="s") + "Z"  # as NumPy has it, universal time
    elif isinstance(time, datetime):
        if time.tzinfo is None:
            raise ValueError(f"malus.sun: time = {time.isoformat()}: has no time zone; give e.g. tzinfo=timezone.utc")
        time = time.astimezone(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return _malus.julian_day(str(time))


def sun(latitude_deg: npt.ArrayLike, longitude_deg: npt.ArrayLike, time: Any) -> SunPosition:
    """Zenith angle, compass azimuth and distance of the sun. The arguments broadcast.

    Parameters
    ----------
    latitude_deg : array_like
        North positive, -90 to 90 [deg].
    longitude_deg : array_like
        East positive, -180 to 180 [deg].
    time : str, datetime, numpy.datetime64 (universal time), or an array of them
        A text is ISO 8601 with an offset, "2001-06-10T13:08:00-04:00"; a datetime has a time zone. Whole seconds.

    Returns
    -------
    SunPosition
        Arrays of the common shape; floats for scalars.

    Examples
    --------
    >>> malus.sun(43.16, -77.61, "2001-06-10T13:08:00-04:00").zenith_deg.round(2)
    20.11
    """
    times = checks.array("sun", "time", time) if not isinstance(time, datetime) else np.asarray(time, dtype=object)
    days = np.empty(times.shape)
    for index in np.ndindex(times.shape):
        days[index] = _julian_day(times[index])
    return SunPosition(*_malus.sun(latitude_deg, longitude_deg, days))


def skies() -> dict[str, dict[str, Any]]:
    """All skies, by name: summary, example and parameters with units and intervals.

    Returns
    -------
    dict of str to dict
        ``skies()["rayleigh"]["parameters"]["albedo"]`` is a `Parameter`.
    """
    return {name: {**one, "parameters": parameters_of(one["parameters"])} for name, one in _malus.skies().items()}


def sky(model: str = "rayleigh", *, wavelength_nm: npt.ArrayLike | None = None, sun_zenith_deg: float | None = None,
        mu0: float | None = None, zenith_deg: npt.ArrayLike | None = None, mu: npt.ArrayLike | None = None,
        phi_deg: npt.ArrayLike | None = None, dome_step_deg: float = 5.0, direction: str = "down", tau_obs: float | None = None,
        irradiance: str | float = "pi", convention: str = "malus", **parameters: Any) -> xr.Dataset:
    """Polarised light of the sky, or what the air sends up to space.

    Every combination of wavelengths, zenith angles and azimuths is computed. The keywords are the flags of ``malus sky``.

    Parameters
    ----------
    model : str
        A name of ``malus.skies()``.
    wavelength_nm : float or 1-D array, optional
        [nm]; it may be left out where the optical depth ``tau`` is given instead.
    sun_zenith_deg, mu0 : float
        The position of the sun: its zenith angle [deg] or the cosine of it.
    zenith_deg, mu : 1-D array, optional
        Zenith angles of the lines of sight [deg], or their cosines. If neither is given: from 0 to 90 in steps of ``dome_step_deg``.
    phi_deg : 1-D array, optional
        Azimuths from the sun, clockwise from above [deg]; if not given, all around in the same steps.
    dome_step_deg : float
        Divides 90 [deg].
    direction : {"down", "up"}
        Direction of travel of the light.
    tau_obs : float, optional
        Optical depth over the observer.
    irradiance : {"pi", "astm-e490"} or float
        Of the sun above the air. With "astm-e490" the radiance is in W m^-2 sr^-1 nm^-1, else in units of the irradiance per steradian.
    convention : {"malus", "natraj", "iprt"}
        Signs of Q and U.
    **parameters
        Of the sky: ``tau``, ``albedo``, ``aerosol`` and others; ``malus.skies()`` describes them.

    Returns
    -------
    xarray.Dataset
        ``radiance`` (wavelength_nm, zenith_deg, phi_deg, stokes), float64.

    Examples
    --------
    >>> dome = malus.sky(wavelength_nm=450, sun_zenith_deg=60, albedo=0.1)
    >>> float(malus.dolp(dome.radiance).max().round(2))
    0.74
    """
    if "depolarisation" in parameters:
        parameters["depolarization"] = parameters.pop("depolarisation")
    if sun_zenith_deg is not None:
        if mu0 is not None:
            raise ValueError("malus.sky: sun_zenith_deg: conflicts with mu0; give one of them")
        mu0 = _cosine(checks.number("sky", "sun_zenith_deg", sun_zenith_deg, 0, 90, ANGLE, " deg"), "sun_zenith_deg")
    if zenith_deg is not None and mu is not None:
        raise ValueError("malus.sky: zenith_deg: conflicts with mu; give one of them")
    if mu0 is not None:
        mu0 = checks.number("sky", "mu0", mu0, 0, 1, "give the cosine of the sun's zenith angle")
    if tau_obs is not None:
        tau_obs = checks.number("sky", "tau_obs", tau_obs, 0, np.inf, "give the optical depth over the observer")
    checks.text("sky", "model", model, "give a name of malus.skies()")
    checks.text("sky", "convention", convention, "give malus, natraj or iprt")
    if direction not in ("down", "up"):
        raise ValueError(f"malus.sky: direction = {direction}: is not one of the words allowed here; choose from: down, up")
    step = checks.number("sky", "dome_step_deg", dome_step_deg, 0.1, 90, "give e.g. 5")
    steps = round(90 / step)
    if abs(steps * step - 90) > 1e-9:
        raise ValueError(f"malus.sky: dome_step_deg = {step:g}: does not divide 90; give e.g. 5")
    if mu is not None:
        cosines = checks.axis("sky", "mu", mu)
        for one in cosines:
            if not 1e-9 <= one <= 1:
                raise ValueError(f"malus.sky: mu = {one:g}: must be 1e-09 to 1; give cosine of the zenith angle of the line of sight")
        zenith = np.degrees(np.arccos(cosines))
    else:
        zenith = np.append(np.arange(steps) * step, 90.0) if zenith_deg is None else checks.axis("sky", "zenith_deg", zenith_deg)
        cosines = np.array([_cosine(one, "zenith_deg") for one in zenith])
    phi = np.arange(4 * steps) * step if phi_deg is None else checks.axis("sky", "phi_deg", phi_deg)
    nm = checks.axis("sky", "wavelength_nm", wavelength_nm) if wavelength_nm is not None else np.empty(0)
    words = irradiance if isinstance(irradiance, str) else repr(checks.number("sky", "irradiance", irradiance, 0, 1e9, SUNLIGHT))
    light = _malus.sky(model, nm.tolist(), mu0, cosines.tolist(), phi.tolist(), direction == "up", tau_obs, words, convention, parameters)
    first = "Q = ll - rr" if convention == "iprt" else "Q = rr - ll"
    frame = (f"{first}, l in the meridian plane, r horizontal; U = 2 Re lr*; V > 0: the field turns counter-clockwise as seen "
             "looking at the source; azimuths clockwise from above")
    unit = "W m^-2 sr^-1 nm^-1" if irradiance == "astm-e490" else "sr^-1"
    coordinates = {
        "wavelength_nm": ("wavelength_nm", nm if nm.size else [np.nan], {"units": "nm"}),
        "zenith_deg": ("zenith_deg", zenith, {"units": "degree", "long_name": "zenith angle of the line of sight"}),
        "phi_deg": ("phi_deg", phi, {"units": "degree", "long_name": "azimuth from the sun, clockwise from above"}),
        "stokes": ("stokes", ["S0", "S1", "S2", "S3"] if convention == "malus" else ["I", "Q", "U", "V"], {"description": frame}),
    }
    given = {name: value for name, value in {**parameters, "mu0": mu0, "tau_obs": tau_obs}.items() if value is not None}
    attributes = {"title": f"Light of the sky, model {model}", "model": model, "direction": direction, "irradiance": irradiance,
                  "convention": convention, "program": f"malus {_malus.__version__}",
                  **{name: value if isinstance(value, int | float | str) else str(value) for name, value in given.items()}}
    meaning = {"units": unit, "long_name": f"Stokes radiance for the irradiance {irradiance}", "description": frame}
    return xr.Dataset({"radiance": (tuple(coordinates), light, meaning)}, coordinates, attributes)


def _cosine(zenith_deg: float, name: str) -> float:
    if not 0 <= zenith_deg <= 90:
        raise ValueError(f"malus.sky: {name} = {zenith_deg:g} deg: must be 0 to 90; {ANGLE}")
    return 0.0 if zenith_deg == 90 else math.cos(zenith_deg * math.pi / 180)


@dataclass(frozen=True)
class Spheres:
    """Scattering by small spheres; the result of `mie`.

    Attributes
    ----------
    x_eff : float
        Effective size, 2 pi r / wavelength in the medium.
    Q_ext, Q_sca, Q_abs, Q_back : float
        Efficiencies: cross sections over the mean pi r^2. Q_back is that of radar.
    albedo, asymmetry : float
        Of single scattering; mean cosine of the scattering angle.
    effective_radius_um, effective_variance, C_ext_um2, C_sca_um2 : float or None
        Size and cross sections of a mean sphere; None if only the size ``x`` was given.
    """

    x_eff: float
    Q_ext: float
    Q_sca: float
    Q_abs: float
    Q_back: float
    albedo: float
    asymmetry: float
    effective_radius_um: float | None
    effective_variance: float | None
    C_ext_um2: float | None
    C_sca_um2: float | None
    _answer: _malus.SpheresOfCall = field(repr=False, compare=False)

    def matrix(self, angle_deg: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Scattering matrix by angle.

        Parameters
        ----------
        angle_deg : array_like, shape (...)
            Scattering angle, 0 straight on [deg].

        Returns
        -------
        array, shape (..., 4, 4)
            In axes perpendicular and parallel to the plane of scattering, S1 > 0 perpendicular; the mean of [0, 0] over all directions is 1.
        """
        return self._answer.matrix(angle_deg)

    def greek(self) -> npt.NDArray[np.float64]:
        """Greek constants in de Haan's convention.

        Returns
        -------
        array, shape (terms, 6)
            alpha1, alpha2, alpha3, alpha4, beta1, beta2 for l = 0, 1, ...
        """
        return self._answer.greek()


def mie(n: float, k: float = 0.0, *, medium_n: float = 1.0, wavelength_nm: float | None = None, x: float | None = None,
        radius_um: float | None = None, effective_radius_um: float | None = None, effective_variance: float | None = None,
        median_radius_um: float | None = None, deviation: float | None = None, largest_radius_um: float | None = None) -> Spheres:
    """Scattering of light by small spheres. Their size is said in one of four ways.

    Parameters
    ----------
    n, k : float
        Index of refraction n + ik of the spheres.
    medium_n : float
        Index of the medium around them.
    wavelength_nm : float
        In vacuum [nm]; needed except with ``x``.
    x : float
        Size 2 pi r / wavelength in the medium, instead of lengths.
    radius_um : float
        Radius of spheres that are all alike [um].
    effective_radius_um, effective_variance : float
        Of a gamma law [um].
    median_radius_um, deviation : float
        Of a log-normal law by number [um], geometric standard deviation.
    largest_radius_um : float, optional
        No sphere of a law is larger [um].

    Returns
    -------
    Spheres

    Examples
    --------
    >>> round(malus.mie(1.55, x=5.2).Q_ext, 4)
    3.1361
    """
    words = {"n": n, "k": k, "medium_n": medium_n, "wavelength_nm": wavelength_nm, "x": x, "radius_um": radius_um,
             "effective_radius_um": effective_radius_um, "effective_variance": effective_variance,
             "median_radius_um": median_radius_um, "deviation": deviation, "largest_radius_um": largest_radius_um}
    answer = _malus.SpheresOfCall(words)
    return Spheres(**answer.efficiencies(), _answer=answer)
