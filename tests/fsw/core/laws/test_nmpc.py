"""Nonlinear prediction for damping: it damps, and its rule saves most of the search."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws import nmpc
from fsw.core.laws.motion import motion
from fsw.core.laws.nmpc import NmpcGains, NmpcReferenceGains, nmpc_damping, nmpc_reference
from fsw.core.laws.plan import tumbling

MOST_AM2 = 2.0
BOTH = pytest.mark.parametrize(
    ("law", "name", "kind"),
    [(nmpc_damping, "nmpc_damping", NmpcGains), (nmpc_reference, "nmpc_reference", NmpcReferenceGains)],
)
RATE = tuple(np.radians(4.0) * np.array([0.5, -0.7, 0.51]))


@pytest.fixture
def flight(bench, monkeypatch):
    """A short flight, and how many steps each search took."""

    def fly(law, name, gains, seconds=100.0):
        searches, body = [], bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=MOST_AM2)

        def counted(*args):
            found = tumbling.descend(*args)
            searches.append(found[2])
            return found

        monkeypatch.setattr(nmpc, "descend", counted)
        settings = replace(bench.config(body, 2.5, {name: gains}), mean_dipole_am2=MOST_AM2)
        flown = bench.fly(
            law,
            bench.setpoint(),
            body=body,
            omega_body=RATE,
            seconds=seconds,
            step_s=2.5,
            settings=settings,
        )
        return flown, searches

    return fly


@pytest.mark.interpreted
@BOTH
def test_it_takes_energy_away(flight, law, name, kind):
    """Nearly as much as coils at their limits can against the rate normal to the field."""
    flown, _ = flight(law, name, kind(iterations=2.0))
    assert flown.energy_j[-1] < 0.95 * flown.energy_j[0]
    assert np.abs(flown.m_body).max() <= MOST_AM2


@pytest.mark.interpreted
@pytest.mark.long
def test_the_rule_saves_most_of_the_search_and_loses_little(flight):
    """The source: a stop at a sufficient fall of the cost."""
    by_rule, few = flight(nmpc_damping, "nmpc_damping", NmpcGains())
    to_the_end, many = flight(nmpc_damping, "nmpc_damping", NmpcGains(gamma=-1.0))
    assert np.mean(few[1:]) < 0.3 * np.mean(many[1:])
    lost_by_rule, lost_to_the_end = (run.energy_j[0] - run.energy_j[-1] for run in (by_rule, to_the_end))
    assert lost_by_rule > 0.85 * lost_to_the_end


@pytest.fixture
def asked(bench, turned):
    def ask(law, name, kind, memory=(), tick=9, orbit=None, **changed):
        orbit = orbit or bench.Orbit()
        body = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=MOST_AM2)
        settings = replace(bench.config(body, 1.0, {name: kind(iterations=1.0)}), mean_dipole_am2=MOST_AM2)
        c = turned((1, -2, 3), 15.0) @ orbit.c_orbit_from_eci(9.0)
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array(RATE), None)
        return law(inputs.replace(**changed), memory, bench.setpoint(), settings)

    return ask


@BOTH
def test_its_first_dipole_is_against_the_rate(asked, bench, turned, law, name, kind):
    orbit = bench.Orbit()
    c = turned((1, -2, 3), 15.0) @ orbit.c_orbit_from_eci(9.0)
    b = c @ orbit.b_eci_t(9.0)
    m = asked(law, name, kind).m_body_am2
    assert np.cross(m, b) @ np.array(RATE) < 0.0


@BOTH
def test_a_dipole_is_given_for_a_step_and_then_planned_anew(asked, law, name, kind):
    memory = asked(law, name, kind).memory
    assert asked(law, name, kind, memory, tick=13).memory == memory
    assert asked(law, name, kind, memory, tick=14).memory[0] == 14


@BOTH
def test_no_step_of_a_plan_is_shorter_than_a_tick(asked, law, name, kind):
    """The dipole cannot change within it: a horizon of a second is one of twelve ticks of a second."""
    short, whole = (asked(law, name, partial(kind, horizon_s=horizon_s)) for horizon_s in (1.0, 12.0))
    assert short == whole


@pytest.mark.interpreted
def test_the_reference_begins_at_the_damping_laws_course(flight, monkeypatch):
    """With no search at all its dipole is that of the law."""
    monkeypatch.setattr(tumbling, "LENGTHS", np.zeros(1))
    flown, _ = flight(nmpc_reference, "nmpc_reference", NmpcReferenceGains(), seconds=5.0)
    b = flown.c_body_from_eci[0] @ np.array(flown_field())
    expected = tumbling.reference_dipole(b, np.array(RATE), MOST_AM2, NmpcReferenceGains().steepness)
    assert flown.m_body[0] == pytest.approx(expected)


def flown_field():
    """The direct dipole's field at the ascending node on axis 1: along the pole."""
    return (0.0, 0.0, 7.812e15 / 7178137.0**3)


@BOTH
@pytest.mark.parametrize("missing", ["attitude", "reference"])
def test_without_knowledge_nothing_is_asked_for(asked, law, name, kind, missing):
    assert any(asked(law, name, kind).m_body_am2)
    changed = {missing: UNKNOWN if missing == "attitude" else None}
    assert asked(law, name, kind, **changed).m_body_am2 == (0.0, 0.0, 0.0)


@BOTH
def test_without_a_field_nothing_is_asked_for(asked, bench, law, name, kind):
    assert asked(law, name, kind, orbit=bench.Orbit(dipole=0.0)).m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "gains", [{"horizon_s": 0.0}, {"iterations": 0.0}, {"weight": -1.0}, {"effort": -1.0}]
)
def test_numbers_out_of_range_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        NmpcGains(**gains)


@pytest.mark.interpreted
def test_a_search_may_end_at_the_old_cost_less_the_fall_asked_for(asked, monkeypatch):
    """J(t - dt) - gamma |omega|^2, gamma relative to the mean moment; six seconds into the old plan."""
    enough = []

    def seen(case, start, cost, iterations):
        enough.append(cost)
        return tumbling.descend(case, start, cost, iterations)

    monkeypatch.setattr(nmpc, "descend", seen)
    asked(nmpc_damping, "nmpc_damping", partial(NmpcGains, gamma=0.02), memory=(3.0, 0.007, *(0.0,) * 36))
    fall = 0.02 * (1.02 + 1.85 + 1.95) / 3.0 * np.dot(RATE, RATE)
    assert enough == pytest.approx([0.007 - fall], rel=1e-9)
    assert fall > 1e-5


def test_what_is_planned_for_is_what_is_known(bench, turned):
    """Wheel and change of the field too, which a flight of a minute hardly shows."""
    orbit, c = bench.Orbit(), turned((1, -2, 3), 15.0)
    settings = bench.config(bench.Body(np.diag([1.02, 1.85, 1.95]), (0.01, -0.02, 0.03)), 1.0)
    inputs = bench.inputs_at(orbit, 9, 1.0, c, np.array(RATE), None)
    reference = inputs.reference.replace(b_rate_eci_tps=(1e-8, -2e-8, 3e-8))
    moving = motion(inputs, settings)
    case = nmpc.case_of(moving, reference, NmpcGains(), None, settings)
    assert case.wheel_body_nms.tolist() == [0.01, -0.02, 0.03]
    assert case.b_rate_eci_tps.tolist() == [1e-8, -2e-8, 3e-8]
    assert case.c_body_from_eci == pytest.approx(c)
    assert case.omega_body_radps == pytest.approx(np.array(RATE))


@pytest.mark.interpreted
@BOTH
@pytest.mark.parametrize(
    ("rate_radps", "horizon_s"),
    [
        (0.1, 60.0),
        (0.62, 60.0),
        (0.7, 12.0 * np.pi / 0.7),
        (3.1, 12.0 * np.pi / 3.1),
        (3.2, None),
        (50.0, None),
    ],
)
def test_a_step_is_no_longer_than_half_a_turn_and_no_shorter_than_a_tick(
    bench, monkeypatch, law, name, kind, rate_radps, horizon_s
):
    planned = []

    def seen(case, *args):
        planned.append(case)
        return tumbling.descend(case, *args)

    monkeypatch.setattr(nmpc, "descend", seen)
    body, orbit = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=MOST_AM2), bench.Orbit()
    settings = replace(bench.config(body, 1.0, {name: kind()}), mean_dipole_am2=MOST_AM2)
    omega = rate_radps * np.array([0.6, 0.64, -0.48])
    inputs = bench.inputs_at(orbit, 9, 1.0, orbit.c_orbit_from_eci(9.0), omega, None)
    demand = law(inputs, (), bench.setpoint(), settings)
    assert any(demand.m_body_am2) is (horizon_s is not None)
    assert [case.horizon_s for case in planned] == pytest.approx(
        [] if horizon_s is None else [horizon_s], rel=1e-6
    )
