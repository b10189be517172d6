"""The figures by which the flights of a population are judged, of flights made up."""

from math import inf

import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.campaign.consistency import consistency_figures
from sim.record.estimates import EstimateRecorder
from sim.scenario.schema import load

ORBIT = 6041
TICKS = 4 * ORBIT
OVERRIDES = {
    "body": {"inertia_kgm2": [[1.02, 0.01, 0.0], [0.01, 1.7, 0.02], [0.0, 0.02, 1.95]]},
    "flight": {"body": {"inertia_kgm2": [1.0, 1.85, 1.95]}},
    "disturbance": {"residual_dipole_am2": [0.03, 0.0, -0.04]},
    "sensors": {
        "magnetometer": {"misalignment_deg": [0.6, 0.0, 0.8]},
        "sun": {"misalignment_deg": [0.0, 0.3, -0.4]},
    },
}


def turn(angles_deg, axis):
    half = 0.5 * np.radians(angles_deg)
    q = np.zeros((len(half), 4))
    q[:, 0], q[:, axis] = np.cos(half), np.sin(half)
    return q


class Made:
    """A flight turned about axis 3; the estimate errs about it too. Sigma is 0.1, 0.2 and 0.3 deg.

    True and estimated rate are zero.
    """

    def __init__(self):
        self.scenario = load("microsat", OVERRIDES)
        self.pointing_deg = np.full(TICKS, 2.0)
        self.error_deg = np.full(TICKS, 0.5)
        self.valid = np.ones(TICKS, dtype=bool)
        self.mode = np.full(TICKS, Mode.ACQUIRE)
        self.mode[-1] = Mode.POINT
        self.axis = 3

    def figures(self):
        truth = {
            "t_s": np.arange(TICKS, dtype=float),
            "q_body_from_orbit": turn(self.pointing_deg, self.axis),
            "omega_body_orbit_radps": np.zeros((TICKS, 3)),
        }
        estimates = EstimateRecorder(TICKS).estimates()
        estimates.q_body_from_orbit[:] = turn(self.pointing_deg - self.error_deg, self.axis)
        sigma = np.radians([0.1, 0.2, 0.3])
        estimates.covariance[:] = np.diag([*sigma**2, 1e-10, 1e-10, 1e-10])
        estimates.valid[:] = self.valid
        estimates.omega_body_orbit_radps[:] = 0.0
        estimates.omega_body_radps[:] = 0.0
        estimates.mode[:] = self.mode
        return consistency_figures(self.scenario, truth, estimates)


@pytest.fixture
def made():
    return Made()


def test_what_differs_from_the_table(made):
    found = made.figures()
    assert found["dipole_am2"] == pytest.approx(0.05)
    assert found["inertia_percent"] == pytest.approx(100.0 * (1.0 - 1.7 / 1.85))
    assert found["misalignment_deg"] == pytest.approx(1.5)


@pytest.mark.parametrize(("axis", "most_deg"), [(1, 0.3), (2, 0.6), (3, 0.9)])
def test_each_axis_is_held_against_its_own_sigma(made, axis, most_deg):
    made.axis = axis
    made.error_deg[:] = 0.99 * most_deg
    made.error_deg[: ORBIT // 2] = 1.01 * most_deg
    found = made.figures()
    inside = {number: found[f"inside_{number}"] for number in (1, 2, 3)}
    assert inside.pop(axis) == pytest.approx(7.0 / 8.0, abs=1e-4)
    assert set(inside.values()) == {1.0}


def test_honesty_counts_after_convergence_while_the_attitude_is_valid(made):
    made.error_deg[:1000] = 20.0
    made.error_deg[1000:2000] = 1.0
    made.error_deg[5000:6000] = 30.0
    made.valid[5000:6000] = False
    found = made.figures()
    assert found["inside_3"] == pytest.approx(1.0 - 1000 / (TICKS - 2000), abs=1e-9)
    expected = (1000 * 1.0 + (TICKS - 3000) * 0.25) / (TICKS - 2000)
    assert found["estimate_deg"] == pytest.approx(np.sqrt(expected))


def test_nees_compares_the_error_with_its_covariance_after_convergence(made):
    """An error of 0.5 deg with a sigma of 0.3 deg."""
    made.error_deg[:1000] = 20.0
    assert made.figures()["nees"] == pytest.approx((0.5 / 0.3) ** 2, rel=1e-4)


@pytest.mark.long
def test_after_the_first_tick_in_point_honesty_is_counted_again_by_itself(made):
    """A tumble, in which the filter is surer than it may be, comes before; what follows later counts."""
    tumble, out, quarter = slice(0, ORBIT), slice(2 * ORBIT, 3 * ORBIT), TICKS // 4
    made.mode[ORBIT:] = Mode.POINT
    made.mode[out] = Mode.DETUMBLE
    made.error_deg[tumble] = 1.8
    assert made.figures()["inside_3"] == pytest.approx(0.75)
    found = made.figures()
    assert [found[f"point_inside_{axis}"] for axis in (1, 2, 3)] == [1.0, 1.0, 1.0]
    assert found["point_estimate_deg"] == pytest.approx(0.5)
    assert found["point_nees"] == pytest.approx((0.5 / 0.3) ** 2, rel=1e-4)
    made.error_deg[out] = 1.8
    found = made.figures()
    assert found["point_inside_3"] == pytest.approx(1.0 - quarter / (TICKS - ORBIT))
    assert found["point_nees"] == pytest.approx((2.0 * (0.5 / 0.3) ** 2 + 36.0) / 3.0, rel=1e-3)


def test_in_point_a_filter_that_has_not_converged_is_judged_too(made):
    made.error_deg[:] = 2.5
    made.mode[ORBIT:] = Mode.POINT
    found = made.figures()
    assert (found["point_inside_3"], found["point_estimate_deg"]) == (0.0, pytest.approx(2.5))


@pytest.mark.parametrize("how", ["never in POINT", "not valid there"])
def test_a_satellite_that_never_comes_to_point_with_a_valid_attitude_is_not_honest_there(made, how):
    made.error_deg[:] = 0.1
    made.mode[-1] = Mode.ACQUIRE if how == "never in POINT" else Mode.POINT
    made.valid[-1] = how == "never in POINT"
    found = made.figures()
    assert [found[f"point_inside_{axis}"] for axis in (1, 2, 3)] == [0.0, 0.0, 0.0]
    assert (found["point_estimate_deg"], found["point_nees"]) == (inf, inf)
    assert found["inside_3"] == 1.0


@pytest.mark.parametrize("how", ["large", "not valid"])
def test_a_filter_that_never_converges_is_not_honest(made, how):
    made.error_deg[:] = 2.5 if how == "large" else 0.1
    made.valid[:] = how == "large"
    found = made.figures()
    assert [found[f"inside_{axis}"] for axis in (1, 2, 3)] == [0.0, 0.0, 0.0]
    assert (found["estimate_deg"], found["nees"]) == (inf, inf)


def test_the_longest_time_that_it_is_valid_and_wrong(made):
    made.error_deg[100:150] = 5.1
    made.error_deg[200:270] = 10.1
    made.error_deg[400:900] = 90.0
    made.valid[430:900] = False
    found = made.figures()
    assert (found["wrong_5deg_s"], found["wrong_10deg_s"]) == (70.0, 70.0)
    made.valid[210:250] = False
    found = made.figures()
    assert (found["wrong_5deg_s"], found["wrong_10deg_s"]) == (50.0, 30.0)


def test_pointing_is_that_of_the_last_three_orbits(made):
    made.pointing_deg[: ORBIT - 10] = 60.0
    made.pointing_deg[-ORBIT:] = 5.0
    found = made.figures()
    assert found["pointing_deg"] == pytest.approx(np.sqrt((2 * 4.0 + 25.0) / 3.0), rel=1e-3)
    assert found["pointed_orbits"] == pytest.approx(1.0, abs=0.01)
    assert found["in_point"] == 1.0


def test_one_that_is_off_at_the_end_never_points(made):
    made.pointing_deg[-1] = 10.1
    assert made.figures()["pointed_orbits"] == inf
    made.pointing_deg[-600], made.pointing_deg[-1] = 10.1, 9.9
    assert made.figures()["pointed_orbits"] == inf, "pointed for 599 s"
