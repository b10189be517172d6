"""Whole flights that miss their requirement, each for a reason that is known: it is told, and no wrong one.

Some take seconds; ``make verdicts`` flies those too (``TORQUER_FAILING_FLIGHTS=all``).
"""

import os
from typing import NamedTuple

import pytest

from fsw.input.schema import merge
from sim.campaign.flight import record_scenario
from sim.report.requirements.judge import Outcome
from sim.scenario.requirements import expectation
from sim.scenario.schema import load, parse_settings

PERFECT = "knowledge=perfect"
UNDISTURBED = (
    "disturbance.torque_nm=[0,0,0]",
    "flight.uncertainty.torque_nm=0.0",
    "flight.uncertainty.torque_variation_nm=0.0",
)


class Flight(NamedTuple):
    """A flight: its settings, its length, the cause to be told, and what else is true of it."""

    settings: tuple[str, ...]
    orbits: float
    cause: str
    also: frozenset[str] = frozenset()
    scenario: str = "microsat"
    expected: str = "ape<2"
    quick: bool = True


WRONG_TABLE = frozenset({"estimate"})
"""By a table that is wrong beyond its bounds the filter is misled."""
FLIGHTS = {
    "weak coils": Flight(
        (PERFECT, "coils.levels_am2=[0.05,0.1,0.2]", *UNDISTURBED), 1.5, "weak", quick=False
    ),
    "coarse levels": Flight((PERFECT, "coils.levels_am2=[20.0,30.0,40.0]"), 1.5, "coarse", quick=False),
    "unstable gains": Flight((PERFECT, "control.k_a=1.6e6"), 0.5, "unstable", scenario="kalman-50kg"),
    "wrong inertia": Flight(
        ("flight.body.inertia_kgm2=[1.95,1.85,1.02]",), 1.0, "mismatch", WRONG_TABLE, quick=False
    ),
    "dark start": Flight(('time.epoch_utc="2015-03-27T03:25:00Z"',), 0.3, "dark"),
    "tumbling": Flight(("initial.rate_degps=[3,3,3]",), 0.3, "tumbling"),
    "residual dipole": Flight(
        ("disturbance.residual_dipole_am2=[0.3,0.3,0.3]",), 0.5, "disturbance", WRONG_TABLE | {"mismatch"}
    ),
    "undeclared dipole": Flight(
        ("disturbance.residual_dipole_am2=[0.0005,-0.008,0.005]",), 2.0, "mismatch", WRONG_TABLE, quick=False
    ),
    "saturated dipole": Flight(
        (PERFECT, "coils.max_dipole_am2=0.002", *UNDISTURBED), 0.5, "weak", scenario="kalman-50kg"
    ),
    "large torque": Flight((PERFECT, "disturbance.torque_nm=[3e-7,3e-7,3e-7]"), 1.0, "any_law", quick=False),
    "isolated unit": Flight(('fault=[{kind="mag_nan",at_s=1000.0}]',), 0.4, "isolated"),
    "mode never reached": Flight(
        (PERFECT, "flight.modes.slow_degps=0.0001", "flight.modes.fast_degps=1.0"), 0.5, "never_in_point"
    ),
    "commanded SAFE": Flight(
        (PERFECT, 'telecommand=[{message="TC_MODE",mode="SAFE",at_s=300.0}]'), 0.3, "safe"
    ),
    "wrong estimate": Flight(("sensors.sun.misalignment_deg=[15.0,0,0]",), 0.4, "estimate", {"mismatch"}),
    "not settled yet": Flight((PERFECT,), 1.7, "not_settled", expected="ape<0.7", quick=False),
    "slow": Flight((PERFECT,), 1.1, "slow", expected="settling<0.3", quick=False),
    "upside down": Flight(
        (PERFECT, "initial.angle_deg=175"), 1.7, "slow", expected="settling<0.3", quick=False
    ),
    "sent back to DETUMBLE": Flight(
        (PERFECT, 'telecommand=[{message="TC_MODE",mode="DETUMBLE",at_s=2000.0}]'),
        1.1,
        "fell_back",
        expected="settling<0.3",
        quick=False,
    ),
    "axes turned": Flight(
        (PERFECT, "body.inertia_kgm2=[1.95,1.85,1.02]", "initial.angle_deg=60"), 4.0, "gravity", quick=False
    ),
    "strong coils, short flight": Flight(
        (PERFECT, "coils.levels_am2=[0.25,1.0,4.0]", "initial.angle_deg=90"), 0.3, "short"
    ),
    "too short": Flight((PERFECT,), 0.3, "short"),
}
ALL = os.environ.get("TORQUER_FAILING_FLIGHTS") == "all"


def outcome(flight):
    by_then = {"by_orbit": flight.orbits, "last_orbits": min(1.0, flight.orbits)}
    expected = expectation(flight.expected, 1.0).model_dump(mode="json", exclude_none=True) | by_then
    scenario = load(flight.scenario, merge(parse_settings(flight.settings), {"requirement": [expected]}))
    record = record_scenario(scenario, 1, flight.orbits)
    (one,) = record.summary()["requirements"]
    return one


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, flight in FLIGHTS.items() if flight.quick or ALL])
def test_a_flight_that_fails_is_told_why(name):
    flight = FLIGHTS[name]
    one = outcome(flight)
    assert one["verdict"] == Outcome.FAILED
    causes = [reason["cause"] for reason in one["reasons"]]
    assert flight.cause in causes
    assert set(causes) <= {flight.cause} | flight.also


@pytest.mark.long
def test_a_flight_that_does_what_is_expected_is_told_no_cause():
    flight = Flight((PERFECT, "initial.angle_deg=0.5", "initial.rate_degps=[0,0,0]"), 0.3, "")
    one = outcome(flight)
    assert (one["verdict"], one["reasons"]) == (Outcome.MET, [])
