"""Histories of a flight made ready for charts."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from sim.audit.auditor import AuditLimits
from sim.audit.findings import DrivenPulse
from sim.report.figures.histories import FlightHistories


@pytest.mark.parametrize(("lit", "dark"), [(0.0, True), (0.49, True), (0.5, False), (1.0, False)])
def test_an_eclipse_is_where_less_than_half_of_the_sun_is_seen(lit, dark, made_run):
    history = np.ones(200)
    history[50:80] = lit
    assert made_run(ticks=200).flown(lit=history).time.eclipses == (((50.0, 80.0),) if dark else ())


def test_a_zoom_is_where_most_pulses_are(made_run):
    rare = [DrivenPulse(0, 1, Fraction(100 + 900 * i), Fraction(103 + 900 * i)) for i in range(4)]
    dense = [DrivenPulse(1, 1, Fraction(4000 + 103 * i), Fraction(4003 + 103 * i)) for i in range(10)]
    flown = made_run(pulses=(*rare, *dense)).flown()
    begin = flown.busiest(1200.0)
    assert begin <= 4000.0
    assert begin + 1200.0 >= 4000.0 + 9 * 103.0 + 3.0


def test_duty_is_taken_over_one_orbit_and_over_less_at_the_beginning(made_run):
    pulses = tuple(DrivenPulse(1, 1, Fraction(103 * i + 100), Fraction(103 * i + 103)) for i in range(60))
    flown = made_run(ticks=20000, pulses=pulses).flown()
    at_s = np.array([50.0, 103.0, 6180.0, 6180.0 + flown.orbit_s])
    duty = flown.duty(1, at_s)
    assert duty[0] == 0.0
    assert duty[1] == pytest.approx(3.0 / 103.0)
    assert duty[2] == pytest.approx(3.0 / 103.0, rel=0.03)
    assert duty[3] == 0.0
    assert not flown.duty(0, at_s).any()


def test_gaps_are_those_the_limit_speaks_of(made_run):
    pulses = tuple(DrivenPulse(c, 1, Fraction(s), Fraction(s + 3)) for c, s in ((0, 100), (1, 203), (0, 400)))
    assert made_run(pulses=pulses).flown().gaps_s().tolist() == [100.0, 194.0]
    each = made_run(pulses=pulses, limits=AuditLimits(shared=False)).flown()
    assert each.gaps_s().tolist() == [297.0]


def test_the_rate_error_is_that_of_the_inertial_rate(made_run):
    run = made_run(ticks=50)
    q = np.tile([1.0, 0.0, 0.0, 0.0], (50, 1))
    off = replace(run.estimates(), q_body_from_orbit=q, omega_body_radps=np.tile([0.0, 0.0, 1.0e-3], (50, 1)))
    off.omega_body_orbit_radps[:] = 0.0
    still = {"q_body_from_orbit": q, "omega_body_orbit_radps": np.tile([2e-5, 0.0, 0.0], (50, 1))}
    flown = FlightHistories(run.truth() | still, off)
    assert flown.rate_error_degps == pytest.approx(np.degrees(2e-5))


def test_three_sigma_is_thrice_the_root_of_the_trace(made_run):
    run = made_run(ticks=5)
    flown = FlightHistories(run.truth(), run.estimates())
    assert flown.sigma3_deg(0) == pytest.approx(np.degrees(3.0 * np.sqrt(3e-6)))
    assert flown.sigma3_deg(3) == pytest.approx(np.degrees(3.0 * np.sqrt(3e-10)))


def test_a_torque_that_never_acts_is_left_out(page):
    assert "residual dipole" not in page.texts["chart-torques"]
