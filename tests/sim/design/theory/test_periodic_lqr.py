"""The periodic regulator against its Riccati equation, and what it does that the PD law does not."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.design.theory import periodic_lqr
from sim.design.theory.bodies import BODIES, UNSTABLE_BODIES, Body, diagonal
from sim.design.theory.floquet import degree_of_stability, monodromy, product, transitions
from sim.design.theory.linear import closed_loop, dipole_field, free_motion, skew
from sim.design.theory.periodic_lqr import (
    Augmented,
    NotConvergedError,
    PeriodicLaw,
    Weights,
    best_effort,
    design,
    lqr_gains,
)

MICROSAT = BODIES[2]
WEIGHTS = Weights(rate=0.7, attitude=1.3, integral=0.2, effort=0.5)


def actuation(u, body):
    rows = -np.linalg.solve(body.inertia_kgm2, skew(dipole_field(np.asarray(u), body)))
    return np.vstack([rows, np.zeros((3, 3))])


def degree(body, law):
    return float(degree_of_stability(monodromy(periodic_lqr.closed_loop(body, law))))


@pytest.mark.long
def test_the_gain_solves_the_riccati_equation(skewed):
    a, q = free_motion(skewed), np.diag([0.7] * 3 + [1.3] * 3)
    effort = 0.5 / (np.trace(skewed.inertia_kgm2) / 3.0) ** 2

    def backwards(u, flat):
        p, b = flat.reshape(6, 6), actuation(u, skewed)
        return -(a.T @ p + p @ a - p @ b @ b.T @ p / effort + q).ravel()

    turns = (12.0 * pi, 0.0)
    flown = solve_ivp(backwards, turns, np.zeros(36), method="DOP853", rtol=1e-9, atol=1e-11)
    p = flown.y[:, -1].reshape(6, 6)
    w0 = skewed.rate_radps
    expected = -actuation(0.0, skewed).T @ p / effort * w0**2 / skewed.field_t / np.repeat([w0, 1.0], 3)
    law = design(skewed, WEIGHTS)
    assert law.u_rad[0] == 0.0
    assert law.gain[0] == pytest.approx(expected, rel=1e-6, abs=1e-6 * law.gain[0].max())


def test_the_dipole_is_normal_to_the_field(skewed):
    law = design(skewed, WEIGHTS, Augmented.TORQUE)
    field = dipole_field(law.u_rad, skewed)
    along = np.einsum("kj,kjn->kn", field, law.gain)
    assert np.abs(along).max() < 1e-9 * np.abs(law.gain).max()


@pytest.mark.parametrize("augmented", Augmented)
def test_gains_have_the_shape_of_what_is_known(skewed, augmented):
    law = design(skewed, WEIGHTS, augmented, nodes=48)
    assert law.gain.shape == (48, 3, 6 if augmented is Augmented.NOTHING else 9)
    assert law.augmented is augmented
    assert degree(skewed, law) < -0.05


def test_more_nodes_are_the_same_law(skewed):
    coarse, fine = design(skewed, WEIGHTS, nodes=64), design(skewed, WEIGHTS, nodes=128)
    assert coarse.gain == pytest.approx(fine.gain[::2], rel=1e-7, abs=1e-7 * np.abs(fine.gain).max())
    assert degree(skewed, coarse) == pytest.approx(degree(skewed, fine), abs=1e-6)


def test_knowing_the_torque_changes_no_gain_of_the_state(skewed):
    plain, knowing = design(skewed, WEIGHTS), design(skewed, WEIGHTS, Augmented.TORQUE)
    assert knowing.gain[..., :6] == pytest.approx(plain.gain, rel=1e-8, abs=1e-8 * np.abs(plain.gain).max())


def mean_attitude(body, law, torque_nm, knows):
    """Size of the mean of theta over the periodic motion in which a constant torque ends."""
    states, w0 = periodic_lqr.closed_loop(body, law), body.rate_radps
    push = np.concatenate([np.linalg.solve(body.inertia_kgm2, torque_nm) / w0**2, np.zeros(3)])

    def forced(u):
        whole = np.zeros((len(u), 7, 7))
        whole[:, :6, :6], whole[:, :6, 6] = states(u), push
        for k, one in enumerate(u) if knows else ():
            dipole = [
                np.interp(one, law.u_rad, law.gain[:, j, 6:] @ torque_nm, period=2.0 * pi) for j in range(3)
            ]
            whole[k, :6, 6] += actuation(one, body) @ dipole * body.field_t / w0**2
        return whole

    steps = transitions(forced, 64)
    whole = product(steps)
    state = np.append(np.linalg.solve(np.eye(6) - whole[:6, :6], whole[:6, 6]), 1.0)
    states = [state := step @ state for step in steps]
    return np.linalg.norm(np.mean(states, axis=0)[3:6])


def test_a_known_torque_turns_the_body_less():
    law, torque_nm = (
        design(MICROSAT, Weights(effort=0.1), Augmented.TORQUE),
        1e-7 * np.array([1.0, -0.8, 0.6]),
    )
    unknown = mean_attitude(MICROSAT, law, torque_nm, knows=False)
    assert unknown > 0.01
    assert mean_attitude(MICROSAT, law, torque_nm, knows=True) < 0.5 * unknown


@pytest.mark.parametrize("nodes", [8, 9])
def test_between_its_nodes_a_gain_is_drawn_through_them(skewed, nodes):
    """Whatever it is there."""
    u = 2.0 * pi * np.arange(nodes) / nodes
    gain = np.random.default_rng(4).standard_normal((nodes, 3, 6))
    w0 = skewed.rate_radps
    given = skewed.field_t / w0**2 * gain @ np.diag(np.repeat([w0, 1.0], 3))
    expected = [free_motion(skewed) + actuation(at, skewed) @ k for at, k in zip(u, given, strict=True)]
    loop = periodic_lqr.closed_loop(skewed, PeriodicLaw(u, gain, Augmented.NOTHING))
    assert loop(u) == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9)


def test_it_stabilises_what_the_gravity_gradient_drives_away():
    assert all(degree(body, design(body)) < -0.4 for body in UNSTABLE_BODIES)


@pytest.mark.long
def test_the_best_effort_is_the_one_of_the_least_degree():
    weights, least = best_effort(MICROSAT)
    assert least == pytest.approx(degree(MICROSAT, design(MICROSAT, weights)), abs=1e-12)
    assert all(least < degree(MICROSAT, design(MICROSAT, Weights(effort=effort))) for effort in (100.0, 0.01))


def test_over_the_equator_one_axis_is_out_of_reach():
    stuck = Body("stuck", diagonal((1.95, 1.02, 1.85)), 800.0, 0.0)
    with pytest.raises(NotConvergedError):
        design(stuck)


# --- PD gains drawn from the regulator: nearest to it over the orbit, and stable

FIFTY = BODIES[2]


def test_no_other_gains_are_nearer():
    """Beside the least-squares solution of m = -b x (k_w Omega + 2 k_a theta), element by element."""
    law, found = design(FIFTY, Weights(effort=0.1)), lqr_gains(FIFTY, 0.1)
    cross = (FIFTY.field_t * skew(dipole_field(law.u_rad, FIFTY))).reshape(-1, 1)
    for part, gain in ((0, found.k_w), (3, 2.0 * found.k_a)):
        wanted = law.gain[..., part : part + 3].reshape(-1)
        assert np.linalg.lstsq(-cross, wanted, rcond=None)[0][0] == pytest.approx(gain, rel=1e-9)


@pytest.mark.parametrize("effort", [0.1, 1.0])
def test_they_stabilise_the_satellite(effort):
    degree = degree_of_stability(monodromy(closed_loop(FIFTY, lqr_gains(FIFTY, effort))))
    assert float(degree) < -0.15


def test_the_less_effort_counts_the_stronger_they_are():
    strong, weak = lqr_gains(FIFTY, 0.1), lqr_gains(FIFTY, 1.0)
    assert strong.k_w > weak.k_w
    assert strong.k_a > weak.k_a
