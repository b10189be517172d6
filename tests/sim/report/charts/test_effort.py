"""Continuous coils and a driven wheel, as the report draws them: how much, and against which limits."""

from dataclasses import replace

import numpy as np
import pytest

from sim.audit.auditor import AuditLimits
from sim.audit.findings import DipoleCount
from sim.report.charts.lines import Lines
from sim.report.charts.sections import sections
from sim.scenario.schema import load, orbit_period_s

TICKS, FRACTION = 7000, 0.6
CONTINUOUS = AuditLimits(on_fraction=FRACTION)
COILS_AND_WHEEL = {"coils": {"on_fraction": FRACTION}}


def dipoles():
    """Of 10 A m^2 full scale: coil 0 every other tick, coil 1 for the first 1000, coil 2 decays only."""
    m_am2 = np.zeros((TICKS, 3))
    m_am2[::2, 0], m_am2[:1000, 1], m_am2[:, 2] = 3.0, -6.0, 1e-6
    return m_am2


def lines_of(run, *cuts):
    truth = run.truth() | {"m_body_am2": dipoles(), "wheel_nms": np.linspace(-0.01, 0.03, TICKS)}
    lines, estimates = Lines(TICKS, run.scenario), run.estimates()
    edges = (0, *cuts, TICKS)
    for rows in map(slice, edges[:-1], edges[1:]):
        lines.take({name: history[rows] for name, history in truth.items()}, estimates.part(rows))
    return lines


@pytest.fixture
def run(made_run):
    return made_run(pulses=(), scenario=load("microsat-wheel", COILS_AND_WHEEL), limits=CONTINUOUS)


def coils_section(run, *cuts, driven=(3500, 1000, 0), any_driven=4000):
    audit = replace(run.audit(), dipoles=DipoleCount(TICKS, driven, any_driven))
    (found,) = (one for one in sections(run.scenario, lines_of(run, *cuts), audit) if one.anchor == "coils")
    return found


def driven_by_tick():
    driven = np.abs(dipoles()) > 1e-3
    return np.column_stack((driven, driven.any(axis=1)))


@pytest.mark.parametrize("cuts", [(), (1, 999, 1001, 5700, 6999)])
def test_duty_is_that_of_the_orbit_before(run, cuts):
    """And of the flight so far, where that is less: the first point stands at the first tick."""
    orbit = round(orbit_period_s(run.scenario))
    assert TICKS - orbit > 1000, "coil 1 is driven no more within the last orbit"
    duty = lines_of(run, *cuts).line("duty")
    assert duty[0] == pytest.approx([FRACTION, FRACTION, 0.0, FRACTION])
    assert duty[-1] == pytest.approx(FRACTION * driven_by_tick()[-orbit:].mean(axis=0), abs=2e-4)
    assert duty.max() == pytest.approx(FRACTION)
    assert (duty[:, 2] == 0.0).all()


@pytest.mark.long
def test_continuous_coils_and_the_wheel_are_drawn_against_their_limits(run):
    found = coils_section(run)
    assert found.title == "Coils and wheel against their limits"
    assert [chart.name for chart in found.charts] == ["continuous_duty", "wheel"]
    duty, wheel = (chart.data["panels"][0] for chart in found.charts)
    assert [one["label"] for one in duty["series"]] == ["coil 0", "coil 1", "coil 2", "any coil"]
    assert [level["value"] for level in duty["levels"]] == pytest.approx([100.0 * FRACTION])
    assert [level["value"] for level in wheel["levels"]] == pytest.approx([120.0, -120.0])
    assert wheel["label"] == "momentum [mN m s]"


@pytest.mark.long
def test_where_no_coil_was_driven_the_wheel_still_is_drawn(run):
    found = coils_section(run, driven=(0, 0, 0), any_driven=0)
    assert found.note == "No coil was driven."
    assert [chart.name for chart in found.charts] == ["wheel"]


@pytest.mark.long
def test_a_pulsed_flight_without_a_wheel_is_drawn_by_its_pulses(made_run):
    run = made_run()
    drawn = sections(run.scenario, run.lines(run.truth(), run.estimates()), run.audit())
    (found,) = (one for one in drawn if one.anchor == "coils")
    assert found.title == "Coils against their limits"
    assert [chart.name for chart in found.charts] == ["raster", "zoom", "duty", "gaps_and_levels"]
