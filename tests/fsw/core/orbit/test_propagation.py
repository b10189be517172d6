from math import dist, pi, radians, sqrt

import pytest

from fsw.core.algebra.vector import cross, dot, norm, unit
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.propagation import circular_orbit, sgp4_orbit, state_eci

EPOCH_S = 1_700_000_000
TLE_EPOCH_UNIX_S = 1427328000 + 86400 * 0.11593543
"""2015-03-26 is day 85 of the year, so day 86 begins one day after it."""


@pytest.fixture
def circle():
    return circular_orbit(550.0, 97.6, 40.0, 25.0, EPOCH_S)


def replaced(line, first_column, text):
    return line[: first_column - 1] + text + line[first_column - 1 + len(text) :]


def test_sgp4_is_asked_for_the_right_moment(itamsat):
    epoch_s = TLE_EPOCH_UNIX_S + 86400.0
    for minutes in (0.0, 0.25, 700.0, 3000.0):
        error, r_km, v_kmps = itamsat.satellite.sgp4_tsince(minutes)
        r_m, v_mps = state_eci(itamsat, epoch_s + 60.0 * minutes)
        assert error == 0
        assert dist(r_m, [1000.0 * x for x in r_km]) < 0.01
        assert dist(v_mps, [1000.0 * x for x in v_kmps]) < 1e-5


def test_the_elements_are_those_of_an_800_km_orbit(itamsat, itamsat_epoch_unix_s):
    r_m, v_mps = state_eci(itamsat, itamsat_epoch_unix_s)
    normal = unit(cross(r_m, v_mps))
    assert norm(r_m) == pytest.approx(7.17e6, abs=3e4)
    assert normal[2] == pytest.approx(-0.151, abs=0.002)


@pytest.mark.parametrize("offset_s", [0.0, 0.1, 12345.67])
def test_velocity_is_the_rate_of_position(itamsat, itamsat_epoch_unix_s, offset_s):
    unix_s = itamsat_epoch_unix_s + offset_s
    (before, _), (after, _) = state_eci(itamsat, unix_s - 1.0), state_eci(itamsat, unix_s + 1.0)
    _, v_mps = state_eci(itamsat, unix_s)
    assert dist([(b - a) / 2.0 for a, b in zip(before, after, strict=True)], v_mps) < 0.05


def test_positions_do_not_depend_on_what_was_asked_before(tle):
    fresh, used = sgp4_orbit(*tle["UO-11"]), sgp4_orbit(*tle["UO-11"])
    for unix_s in (1.77e9, 1.76e9, 1.8e9):
        state_eci(used, unix_s)
    assert state_eci(used, 1.765e9) == state_eci(fresh, 1.765e9)
    assert used == fresh


@pytest.mark.parametrize("days", [60, 90, 400, 10_000])
def test_long_after_its_decay_there_is_no_position_either(decaying, itamsat_epoch_unix_s, days):
    """SGP4 itself reports no error there and gives 170 000 km and more."""
    assert state_eci(sgp4_orbit(*decaying), itamsat_epoch_unix_s + 86400 * days) is None


def test_a_decayed_orbit_has_no_position_and_says_so_without_raising(decaying):
    orbit = sgp4_orbit(*decaying)
    assert state_eci(orbit, TLE_EPOCH_UNIX_S + 86400.0) is not None
    assert state_eci(orbit, TLE_EPOCH_UNIX_S + 30 * 86400.0) is None


def test_blanks_and_line_ends_after_the_lines_are_forgiven(tle, itamsat):
    line1, line2 = tle["ITAMSAT"]
    assert sgp4_orbit(line1 + "  \r\n", line2 + "\n") == itamsat


@pytest.mark.parametrize(
    ("mean_motion", "reason"),
    [("99.00000000", "decayed"), (" 0.00000000", "less than zero"), (" 6.39000000", "225 minutes")],
)
def test_elements_that_cannot_fly_are_refused(tle, checksummed, mean_motion, reason):
    line1, line2 = tle["ITAMSAT"]
    with pytest.raises(ValueError, match=reason):
        sgp4_orbit(line1, checksummed(replaced(line2, 53, mean_motion)))


def test_a_circle_has_its_radius_and_speed_everywhere(circle):
    for step in range(50):
        r_m, v_mps = state_eci(circle, EPOCH_S + 117.0 * step)
        assert norm(r_m) == pytest.approx(6928137.0, abs=1e-6)
        assert norm(v_mps) == pytest.approx(sqrt(MU_M3PS2 / 6928137.0), rel=1e-14)
        assert abs(dot(unit(r_m), unit(v_mps))) < 1e-14


def test_a_circle_closes_after_its_period(circle):
    period_s = 2.0 * pi * sqrt(6928137.0**3 / MU_M3PS2)
    assert dist(state_eci(circle, EPOCH_S)[0], state_eci(circle, EPOCH_S + period_s)[0]) < 0.01


def test_the_velocity_of_a_circle_is_the_rate_of_its_position(circle):
    for offset_s in (0.0, 1000.0, 4000.0):
        (a, _), (b, _) = (state_eci(circle, EPOCH_S + offset_s + d) for d in (-0.5, 0.5))
        assert (
            dist([y - x for x, y in zip(a, b, strict=True)], state_eci(circle, EPOCH_S + offset_s)[1]) < 0.01
        )


def test_a_circle_crosses_its_node_going_north_at_u_zero():
    r_m, v_mps = state_eci(circular_orbit(550.0, 60.0, 40.0, 0.0, EPOCH_S), EPOCH_S)
    assert unit(r_m) == pytest.approx((0.7660444431, 0.6427876097, 0.0), abs=1e-10)
    assert v_mps[2] == pytest.approx(norm(v_mps) * sqrt(3.0) / 2.0)


def test_u_is_counted_from_the_node_in_the_direction_of_flight(circle):
    node, _ = state_eci(circular_orbit(550.0, 97.6, 40.0, 0.0, EPOCH_S), EPOCH_S)
    rate_radps = sqrt(MU_M3PS2 / 6928137.0**3)
    late, _ = state_eci(circle, EPOCH_S - radians(25.0) / rate_radps)
    assert dist(node, late) < 0.01


@pytest.mark.parametrize("altitude_km", [0.0, -10.0, float("nan"), float("inf")])
def test_a_circle_that_is_not_above_the_ground_is_refused(altitude_km):
    with pytest.raises(ValueError, match=r"altitude above 0 km|finite"):
        circular_orbit(altitude_km, 97.6, 0.0, 0.0, EPOCH_S)
