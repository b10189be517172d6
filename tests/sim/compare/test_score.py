"""The figures of a flight, from records with given figures."""

from dataclasses import asdict
from math import ceil, degrees, sqrt

import numpy as np
import pytest

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver, cases
from sim.compare.score import fly_case, history, judge
from sim.scenario.controlled import Controlled
from sim.scenario.schema import load, orbit_period_s

CONTINUOUS = {"coils": {"driver": "continuous", "max_dipole_am2": 8.0, "on_fraction": 0.5}}
ATTITUDE = Controlled("attitude", "whole attitude", "deg", 5.0)
AXIS = Controlled("axis", "axis 1 from the vertical", "deg", 5.0)
SPIN = Controlled("spin", "spin rate about axis 1", "deg/s", 0.1)
ORBIT_S = orbit_period_s(load("microsat"))
ORBIT_TICKS = ceil(ORBIT_S)
"""At one tick a second."""


@pytest.mark.long
def test_settled_is_under_five_degrees_from_then_on(plant_record, case_of):
    errors = [60.0] * 100 + [4.0] * 100 + [5.5] + [4.99] * ORBIT_TICKS
    assert judge(case_of(), plant_record(errors), ATTITUDE).settle_orbits == pytest.approx(201 / ORBIT_S)


@pytest.mark.long
def test_what_is_not_settled_at_the_end_never_was(plant_record, case_of):
    assert judge(case_of(), plant_record([1.0] * ORBIT_TICKS + [5.01]), ATTITUDE).settle_orbits is None
    assert judge(case_of(), plant_record([1.0] * ORBIT_TICKS), ATTITUDE).settle_orbits == 0.0


@pytest.mark.long
@pytest.mark.parametrize("within_s", [1, ORBIT_TICKS - 1])
def test_what_is_small_for_less_than_the_last_orbit_has_not_been_seen_to_stay(
    plant_record, case_of, within_s
):
    errors = [60.0] * 300 + [1.0] * within_s
    assert judge(case_of(), plant_record(errors), ATTITUDE).settle_orbits is None


@pytest.mark.long
def test_pointing_is_of_the_last_orbit_alone(plant_record, case_of):
    orbit = round(ORBIT_S)
    score = judge(case_of(), plant_record([90.0] * 50 + [3.0] * (orbit - 1000) + [4.0] * 1000), ATTITUDE)
    assert score.error_rms == pytest.approx(sqrt((9.0 * (orbit - 1000) + 16.0 * 1000) / orbit))
    assert score.error_max == pytest.approx(4.0)
    assert judge(case_of(), plant_record([90.0] * 50 + [3.0] * (orbit - 1)), ATTITUDE).error_max > 89.0


def test_where_the_axis_counts_a_turn_about_it_does_not(plant_record, case_of):
    by_axis = {"flight": {"modes": {"axis_only": True}}}
    about_axis_1 = plant_record([30.0] * 300, by_axis, axis=(1.0, 0.0, 0.0))
    assert judge(case_of(), about_axis_1, AXIS).error_rms == pytest.approx(0.0, abs=1e-6)
    assert judge(case_of(), plant_record([30.0] * 300, by_axis), AXIS).error_rms == pytest.approx(30.0)
    whole = judge(case_of(), plant_record([30.0] * 300, axis=(1.0, 0.0, 0.0)), ATTITUDE)
    assert whole.error_rms == pytest.approx(30.0)


def test_rate_is_judged_beside_the_spin_that_is_wanted(plant_record, case_of):
    rate = (0.017, 0.004, 0.0)
    still = judge(case_of(), plant_record([1.0] * 300, rate_radps=rate), ATTITUDE)
    spun = judge(
        case_of(), plant_record([1.0] * 300, {"control": {"spin_radps": 0.02}}, rate_radps=rate), ATTITUDE
    )
    assert still.rate_rms_degps == pytest.approx(degrees(sqrt(0.017**2 + 0.004**2)))
    assert spun.rate_rms_degps == pytest.approx(degrees(0.005))


@pytest.mark.long
def test_a_spin_is_judged_by_its_rate_about_axis_1(plant_record, case_of):
    """Whatever the attitude, and whatever the rate about the other axes."""
    spun = plant_record(
        [170.0] * ORBIT_TICKS, {"control": {"spin_radps": 0.02}}, rate_radps=(0.017, 0.4, 0.1)
    )
    score = judge(case_of("spin_up"), spun, SPIN._replace(threshold=degrees(0.0031)))
    assert (score.error_rms, score.error_max) == pytest.approx((degrees(0.003),) * 2)
    assert score.settle_orbits == 0.0
    assert judge(case_of("spin_up"), spun, SPIN).settle_orbits is None
    assert history(spun, SPIN).error == pytest.approx(degrees(0.003))


def test_pulses_by_the_audit(plant_record, case_of):
    dipoles = np.zeros((400, 3))
    dipoles[111:114, 0] = 0.5
    dipoles[241:244, 2] = -8.0
    score = judge(case_of("lqr"), plant_record([2.0] * 400, dipole_am2=dipoles), ATTITUDE)
    assert (score.law, score.aim, score.driver) == ("lqr", Aim.THREE_AXIS, Driver.PULSED)
    assert score.dipole_squared_a2m4s == pytest.approx(3 * 0.25 + 3 * 64.0)
    assert (score.pulses, score.limits_ok, score.mode_final) == (2, True, "ACQUIRE")
    assert score.duty == pytest.approx(6 / 399)  # the last status tells of the tick before


def test_a_continuous_driver_gives_its_mean_in_a_part_of_the_tick(plant_record, case_of):
    dipoles = np.zeros((400, 3))
    dipoles[100:150] = (0.3, 0.0, -0.4)
    dipoles[150, 0] = 1e-9  # the current dies away
    score = judge(
        case_of(driver=Driver.CONTINUOUS), plant_record([2.0] * 400, CONTINUOUS, dipole_am2=dipoles), ATTITUDE
    )
    assert score.dipole_squared_a2m4s == pytest.approx(50 * 0.25 / 0.5)  # 1 A m^2 over half a second each
    assert score.duty == pytest.approx(0.5 * 50 / 400)
    assert score.pulses is None


def test_limits_that_were_broken_are_told(plant_record, case_of):
    too_soon = plant_record([2.0] * 400, pulses=((0, 110), (2, 212)))
    assert judge(case_of(), too_soon, ATTITUDE).limits_ok is False
    assert judge(case_of(), too_soon, ATTITUDE).pulses == 2


@pytest.mark.long
def test_history_is_the_mean_square_over_a_quarter_of_an_orbit_about_each_time(plant_record):
    ticks, half = round(1.5 * ORBIT_S), ORBIT_S / 8
    errors = np.where(np.arange(ticks) < 4000, 3.0, 1.0)
    got = history(plant_record(errors), ATTITUDE)
    assert len(got.t_s) == len(got.error) == 90
    assert (got.t_s[0], got.t_s[-1]) == (0.0, ticks - 1)
    share = np.clip((4000 - (got.t_s - half)) / (2 * half), 0.0, 1.0)
    inside = (got.t_s > half) & (got.t_s < ticks - half)
    assert got.error[inside] == pytest.approx(np.sqrt(9.0 * share + 1.0 - share)[inside], rel=2e-3)
    assert got.error[[0, -1]] == pytest.approx([3.0, 1.0])
    assert got.time.eclipses[0] == (120.0, 200.0)


def test_history_of_a_long_flight_stays_small(plant_record, monkeypatch):
    monkeypatch.setattr("sim.compare.score.MOST_POINTS", 15)
    assert len(history(plant_record([1.0] * round(0.5 * ORBIT_S)), ATTITUDE).t_s) == 15


def test_history_of_a_few_ticks(plant_record):
    got = history(plant_record([3.0, 4.0]), ATTITUDE)
    assert got.error == pytest.approx([sqrt(12.5)] * 2)
    assert got.t_s == pytest.approx([0.0, 1.0])


def test_a_law_that_cannot_be_flown_is_a_line():
    (case,) = cases("microsat", {}, ("lqr",), (Driver.PULSED,), 1, 1e6)
    score, drawn = fly_case(case, ATTITUDE)
    assert drawn is None
    assert "a run has at most" in score.failure
    filled = {"law", "aim", "driver", "failure", "tuned"}
    assert {key for key, value in asdict(score).items() if value is not None} == filled
