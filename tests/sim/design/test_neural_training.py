"""Training of the neural units: its flights are those of the law, and it lowers the cost."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from fsw.core.laws.pd_neural import NeuralGains
from sim.design import neural_training as training
from sim.design.neural_training import MOST_AM2, PD_GAINS, Trials, cost, orbit_rms_deg, train, trials
from sim.design.theory.bodies import BODIES
from sim.validate.review.law_flight import LawFlight, fly

BODY = BODIES[2]
WEIGHTS = (0.3, -0.25, 0.3, 0.9, -0.05, -0.4, 0.05)


def disturbed(torque, dipole):
    """A constant torque and that of a residual dipole, on the direct dipole's field of a circular orbit.

    It is told the velocity at the beginning of a step: the field is that of its middle.
    """
    i, turned = radians(BODY.inclination_deg), 0.5 * training.STEP_S * BODY.rate_radps
    normal, pole = np.array([0.0, -np.sin(i), np.cos(i)]), np.array([0.0, 0.0, 1.0])

    def extra(c_body_from_eci, velocity_eci_mps):
        ahead = np.array(velocity_eci_mps) / np.linalg.norm(velocity_eci_mps)
        along = np.cos(turned) * np.cross(ahead, normal) + np.sin(turned) * ahead
        b_body = np.array(c_body_from_eci) @ (BODY.field_t * (pole - 3.0 * along[2] * along))
        return tuple((torque + np.cross(dipole, b_body)).tolist())

    return extra


@pytest.mark.long
@pytest.mark.parametrize("dipole", [(0.0, 0.0, 0.0), (8e-3, -6e-3, 9e-3)], ids=["torque", "and dipole"])
def test_its_flights_are_those_of_the_law(dipole):
    turn = radians(40.0) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    half = 0.5 * radians(40.0)
    q = np.concatenate([[np.cos(half)], np.sin(half) * turn / radians(40.0)])
    torque = (1e-7, -0.5e-7, 0.8e-7)
    flown = Trials(q[None], np.array([torque]), np.array([dipole]))
    ours = orbit_rms_deg(BODY, PD_GAINS, np.array([WEIGHTS]), flown, MOST_AM2, orbits=2)[0, 0]
    history = fly(
        LawFlight(
            "pd_neural",
            BODY.inertia_kgm2,
            k_w=PD_GAINS.k_w,
            k_a=PD_GAINS.k_a,
            gains=NeuralGains(*WEIGHTS),
            rotation_rad=tuple(turn.tolist()),
            relative=True,
            orbits=2.0,
            step_s=training.STEP_S,
            most_am2=MOST_AM2,
            extra=disturbed(torque, dipole),
        )
    )
    theirs = [
        np.sqrt(np.mean(history.angle_deg[(history.orbits >= n) & (history.orbits < n + 1)] ** 2))
        for n in (0, 1)
    ]
    assert ours == pytest.approx(theirs, rel=0.01)


def test_a_residual_dipole_acts_as_one_of_the_coils_does():
    """In the axes of the body."""
    body = replace(BODY, inertia_kgm2=((1.02, 0.13, -0.09), (0.13, 1.85, 0.21), (-0.09, 0.21, 1.95)))
    dipole, none, b_t = np.array([[3e-3, -2e-3, 4e-3]]), np.zeros((1, 3)), np.array([2e-5, -1e-5, 3e-5])
    x = np.array([[0.8, 0.36, -0.288, 0.384, 1e-3, -2e-3, 3e-3]])
    own, free = (
        training._Flights(body, PD_GAINS, np.array([WEIGHTS]), none, residual) for residual in (dipole, none)
    )
    by_coils, moved = free.rates(x, b_t, dipole), own.rates(x, b_t, none)
    assert moved == pytest.approx(by_coils, rel=1e-12)
    assert np.abs(moved - free.rates(x, b_t, none))[0, 4:].min() > 1e-9


def test_both_signs_of_a_quaternion_are_one_attitude():
    loop = training._Flights(BODY, PD_GAINS, np.array([WEIGHTS]), np.zeros((1, 3)), np.zeros((1, 3)))
    x, b_t = np.array([[0.8, 0.36, -0.288, 0.384, 1e-3, -2e-3, 3e-3]]), np.array([2e-5, -1e-5, 3e-5])
    other = np.concatenate([-x[:, :4], x[:, 4:]], axis=1)
    for seen, expected in zip(loop.dipole(other, b_t, None), loop.dipole(x, b_t, None), strict=True):
        assert seen == pytest.approx(expected, rel=1e-12)


@pytest.mark.long
def test_a_residual_dipole_turns_the_satellite():
    flown = replace(trials(2, 5), dipole_am2=np.array([[3e-3, -2e-3, 4e-3], [-2e-3, 3e-3, 1e-3]]))
    without = Trials(flown.q, flown.torque_nm, 0.0 * flown.dipole_am2)
    member = np.array([WEIGHTS])
    ours, calm = (
        orbit_rms_deg(BODY, PD_GAINS, member, each, MOST_AM2, orbits=2) for each in (flown, without)
    )
    assert np.abs(ours / calm - 1.0).max() > 0.05


def test_trials_are_those_of_their_seed():
    again, other = trials(3, 8), trials(3, 9)
    assert np.array_equal(trials(3, 8).q, again.q)
    assert not np.array_equal(again.torque_nm, other.torque_nm)
    angles = np.degrees(2.0 * np.arccos(again.q[:, 0]))
    assert (angles >= training.LEAST_DEG).all()
    assert (angles <= training.MOST_DEG).all()


def test_the_cost_is_the_mean_logarithm():
    assert cost(np.array([[[1.0, np.e], [np.e, np.e**2]]])) == pytest.approx([1.0])


def test_the_search_keeps_to_its_bounds_and_begins_at_constant_gains(monkeypatch):
    """Level and slopes of s at the middle of what a unit sees; the lag between its shortest and longest."""
    tried = []

    def flights(body, gains, weights, flown, most_am2):
        tried.append(weights)
        return 1.0 + np.abs(weights).sum(axis=1)[:, None, None]

    monkeypatch.setattr(training, "orbit_rms_deg", flights)
    monkeypatch.setattr(training, "LAGS_ORBITS", (0.02, 0.5))
    train(BODY, PD_GAINS, trials(1, 1), MOST_AM2, 3, 2)
    weights, bounds = (
        np.concatenate(tried),
        [training.LEVEL, training.SLOPE, training.SLOPE],
    )
    assert weights[0] == pytest.approx([0.0] * 6 + [np.sqrt(np.prod(training.LAGS_ORBITS))])
    for unit in (weights[:, :3].copy(), weights[:, 3:6].copy()):
        unit[:, 0] += training.MIDDLE * (unit[:, 1] + unit[:, 2])
        most, least = unit.max(axis=0) / bounds, unit.min(axis=0) / bounds
        assert ((most > 0.8) & (most <= 1.0 + 1e-9)).all()
        assert ((least < -0.8) & (least >= -1.0 - 1e-9)).all()
    lags = weights[:, 6]
    assert training.LAGS_ORBITS[0] <= lags.min() < 1.5 * training.LAGS_ORBITS[0]
    assert training.LAGS_ORBITS[1] / 1.5 < lags.max() <= training.LAGS_ORBITS[1]


@pytest.mark.long
@pytest.mark.slow
def test_training_is_never_worse_than_constant_gains_and_reports(monkeypatch):
    monkeypatch.setattr(training, "POPULATION", 2)
    flown, told = trials(2, 1), []
    found, lowest = train(
        BODY, PD_GAINS, flown, MOST_AM2, 3, 2, report=lambda *told_now: told.append(told_now)
    )
    constant = np.array([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, found[6]]])
    assert lowest <= cost(orbit_rms_deg(BODY, PD_GAINS, constant, flown, MOST_AM2))[0] + 1e-9
    assert lowest == pytest.approx(cost(orbit_rms_deg(BODY, PD_GAINS, found[None], flown, MOST_AM2))[0])
    assert [generation for generation, _ in told] == list(range(1, len(told) + 1))
    assert told[-1][1] == pytest.approx(lowest)
