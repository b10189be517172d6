from datetime import datetime

import numpy as np
import pytest

from sim.plant.environment.earth import gmst82_rad, turn_about_pole


@pytest.fixture(scope="module")
def earth(reference):
    return reference("earth_sun.csv")


def sidereal(row):
    """Angle at a row's time, from a whole-second epoch before it and the rest."""
    days = float(row["jd_utc1"]) - 2440587.5 + float(row["jd_utc2"])
    unix_s = datetime.fromisoformat(row["utc_iso"]).timestamp()
    assert days * 86400 == pytest.approx(unix_s, abs=1e-3)
    return gmst82_rad(int(unix_s) - 5000, np.array([5000.0 + unix_s % 1.0]))


def test_sidereal_time_against_the_reference(earth):
    for row in earth.rows:
        difference = sidereal(row)[0] - float(row["gmst82_rad"])
        assert abs(np.angle(np.exp(1j * difference))) < 1e-9


def test_turn_takes_true_equator_axes_to_earth_fixed_axes(earth):
    for row in earth.rows:
        columns = turn_about_pole(sidereal(row).repeat(3), np.eye(3)).T
        expected = [[float(row[f"t2p_{i}{j}"]) for j in (1, 2, 3)] for i in (1, 2, 3)]
        assert columns == pytest.approx(np.array(expected), abs=1e-9)


def test_times_are_an_array_over_the_epoch():
    epoch, times = 1_427_424_417, np.array([0.0, 0.25, 1e5])
    one_by_one = [gmst82_rad(epoch, np.array([t]))[0] for t in times]
    assert gmst82_rad(epoch, times).tolist() == one_by_one
    assert gmst82_rad(epoch + 100_000, np.zeros(1))[0] == pytest.approx(one_by_one[2], abs=1e-10)
