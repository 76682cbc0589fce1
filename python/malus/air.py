"""The sun."""
from datetime import datetime, timezone
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _malus


class SunPosition(NamedTuple):
    """Where the sun's centre stands, without refraction."""

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
    times = np.asarray(time) if not isinstance(time, datetime) else np.asarray(time, dtype=object)
    days = np.empty(times.shape)
    for index in np.ndindex(times.shape):
        days[index] = _julian_day(times[index])
    return SunPosition(*_malus.sun(latitude_deg, longitude_deg, days))
