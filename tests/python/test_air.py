"""The sun and the air from Python against the program, to the last bit."""
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from conftest import complaint, numbers, run_malus

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
    # libnova remembers a nutation for a tenth of a day: what was asked before may show in the twelfth place
    assert np.isclose(malus.sun(np.array([[43.16], [0]]), -77.61, days).zenith_deg[0, 0], expected.zenith_deg, rtol=0, atol=1e-11)


def test_refusals_of_the_sun() -> None:
    for latitude, longitude, time in [(91, 0, "2001-06-10T17:08:00Z"), (0, 0, "2001-06-10")]:
        expected = complaint("sun", "--latitude-deg", latitude, "--longitude-deg", longitude, "--time", time)
        with pytest.raises(ValueError) as refused:
            malus.sun(latitude, longitude, time)
        assert str(refused.value).split("; ")[1] == expected.split("; ")[1]
    with pytest.raises(ValueError, match="has no time zone"):
        malus.sun(*ROCHESTER, datetime(2001, 6, 10))
