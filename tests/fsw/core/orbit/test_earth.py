from math import pi

import pytest

from fsw.core.orbit.earth import days_since_j2000, gmst82_rad, rotate_about_pole


def test_sidereal_time_agrees_with_erfa(reference_rows):
    rows = reference_rows("earth_sun.csv")
    assert len(rows) == 60
    for row in rows:
        assert gmst82_rad(row["unix_s"]) == pytest.approx(float(row["gmst82_rad"]), abs=1e-9)


def test_the_turn_by_sidereal_time_is_ecef_from_eci(reference_rows):
    v = (0.3, -1.7, 2.9)
    for row in reference_rows("earth_sun.csv"):
        expected = [sum(float(row[f"t2p_{i}{j}"]) * v[j - 1] for j in (1, 2, 3)) for i in (1, 2, 3)]
        assert rotate_about_pole(gmst82_rad(row["unix_s"]), v) == pytest.approx(expected, abs=1e-8)


def test_a_turn_back_restores_the_vector():
    v = (0.3, -1.7, 2.9)
    assert rotate_about_pole(-1.234, rotate_about_pole(1.234, v)) == pytest.approx(v, abs=1e-15)


def test_j2000_is_day_zero_at_noon():
    assert days_since_j2000(946728000.0) == 0.0
    assert days_since_j2000(946728000.0 + 86400.0) == 1.0


def test_sidereal_time_gains_one_turn_a_year_on_the_sun():
    gain = (gmst82_rad(1.6e9 + 86400.0) - gmst82_rad(1.6e9)) % (2.0 * pi)
    assert gain == pytest.approx(2.0 * pi / 365.2422, rel=1e-5)
