"""The best dipoles for a tumbling body over a short time ahead, by projected descent.

Rate omega and attitude C (body from eci) in the field B + B' t, no torque but the coils',

    J domega/dt = -omega x (J omega + h) + m x (C B),    dC/dt = -[omega x] C,

with the dipole held over each of n steps of T / n and within the limits. The cost is

    1/2 omega^T J omega at the end + sum of (1/n) (weight f + effort |m|^2),

f the energy 1/2 omega^T J omega at the end of each step, or |g|^2 of the damping law (``reference_dipole``).
The slope is by differences; all of these, and all lengths of a step down the slope, are computed at once.

Source: Ahmed, Kerrigan 2014; Boehm, Merk, Fichter, Allgoewer 2009, as in Ovchinnikov, Roldugin 2019,
section 3.3.
"""

from dataclasses import dataclass
from math import ceil, pi

import numpy as np

from fsw.core.laws.plan.riccati import Array

LARGEST_TURN_RAD = 0.4
"""Largest rotation in a step of integration."""
DIFFERENCE = 1e-4
"""Fraction of the largest dipole by which the slope is found."""
LENGTHS = 2.0 ** -np.arange(0.0, 12.0)
"""Lengths of a step down the slope: the first takes the steepest component from limit to limit."""


@dataclass(frozen=True, slots=True)
class Tumbling:
    """What is planned for.

    Attributes:
        inertia_kgm2: J, body axes.
        wheel_body_nms: h, body axes.
        omega_body_radps: rate now, body axes.
        c_body_from_eci: attitude now.
        b_eci_t: field now.
        b_rate_eci_tps: its change.
        horizon_s: T.
        steps: n.
        most_am2: limit of each coil.
        weight: of f.
        effort: of |m|^2, J / (A m^2)^2.
        steepness: K of the damping law, A m^2 s / T over ``most_am2``; None: f is the energy.
    """

    inertia_kgm2: Array
    wheel_body_nms: Array
    omega_body_radps: Array
    c_body_from_eci: Array
    b_eci_t: Array
    b_rate_eci_tps: Array
    horizon_s: float
    steps: int
    most_am2: float
    weight: float
    effort: float
    steepness: float | None


def reference_dipole(b_body_t: Array, omega_body_radps: Array, most_am2: float, steepness: float) -> Array:
    """The damping law within the limits, m = -g, g = (2 m_max / pi) arctan(K b x omega), (..., 3)."""
    m: Array = -2.0 * most_am2 / pi * np.arctan(steepness * _cross(b_body_t, omega_body_radps))
    return m


def _cross(a: Array, b: Array) -> Array:
    """The cross product over the last axis; faster than numpy's for few vectors."""
    a1, a2, a3 = a[..., 0], a[..., 1], a[..., 2]
    b1, b2, b3 = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1], axis=-1)


def costs(case: Tumbling, dipoles_am2: Array) -> Array:
    """The cost of each plan, shape (plans,), of dipoles (plans, n, 3), body axes."""
    return _run(case, dipoles_am2)[0]


def damping_course(case: Tumbling) -> Array:
    """The dipoles that the damping law gives along its own motion, (n, 3)."""
    course: Array = _run(case, None)[1][0]
    return course


def _run(case: Tumbling, dipoles_am2: Array | None) -> tuple[Array, Array]:
    """Costs and dipoles of plans; without dipoles, of the plan that the damping law makes."""
    plans = 1 if dipoles_am2 is None else len(dipoles_am2)
    inverse, step_s = np.linalg.inv(case.inertia_kgm2), case.horizon_s / case.steps
    omega = np.tile(case.omega_body_radps, (plans, 1))
    axes = np.tile(case.c_body_from_eci.T, (plans, 1, 1))  # rows: the axes of eci in the body
    size = float(np.sqrt(case.omega_body_radps @ case.omega_body_radps))
    parts = max(1, ceil(size * step_s / LARGEST_TURN_RAD))
    h, cost = step_s / parts, np.zeros(plans)
    given = np.empty((plans, case.steps, 3))

    def change(omega: Array, axes: Array, m: Array, t_s: float) -> tuple[Array, Array]:
        b = np.einsum("...ij,i->...j", axes, case.b_eci_t + t_s * case.b_rate_eci_tps)
        momentum = omega @ case.inertia_kgm2 + case.wheel_body_nms
        return (_cross(momentum, omega) + _cross(m, b)) @ inverse, _cross(axes, omega[:, None, :])

    for k in range(case.steps):
        if dipoles_am2 is None:
            b = axes[0].T @ (case.b_eci_t + k * step_s * case.b_rate_eci_tps)
            m = reference_dipole(b, omega, case.most_am2, case.steepness or 0.0)
        else:
            m = dipoles_am2[:, k]
        given[:, k] = m
        for part in range(parts):
            t = k * step_s + part * h
            w1, a1 = change(omega, axes, m, t)
            w2, a2 = change(omega + 0.5 * h * w1, axes + 0.5 * h * a1, m, t + 0.5 * h)
            w3, a3 = change(omega + 0.5 * h * w2, axes + 0.5 * h * a2, m, t + 0.5 * h)
            w4, a4 = change(omega + h * w3, axes + h * a3, m, t + h)
            omega = omega + h / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4)
            axes = axes + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        energy = 0.5 * np.einsum("pi,ij,pj->p", omega, case.inertia_kgm2, omega)
        running = energy
        if case.steepness is not None:
            b = np.einsum("pij,i->pj", axes, case.b_eci_t + (k + 1) * step_s * case.b_rate_eci_tps)
            g = reference_dipole(b, omega, case.most_am2, case.steepness)
            running = np.sum(g * g, axis=1)
        cost += (case.weight * running + case.effort * np.sum(m * m, axis=1)) / case.steps
    total: Array = cost + energy
    return total, given


def descend(case: Tumbling, start_am2: Array, enough: float, iterations: int) -> tuple[Array, float, int]:
    """A plan better than the first one: dipoles (n, 3), their cost, and how many steps were taken.

    Args:
        case: what is planned for.
        start_am2: the first plan, (n, 3).
        enough: a cost at which the search may stop; -inf: as far as it goes.
        iterations: largest number of steps.
    """
    plan, cost = start_am2, float(costs(case, start_am2[None])[0])
    count, by = 3 * case.steps, DIFFERENCE * case.most_am2
    for iteration in range(iterations):
        if cost <= enough:
            return plan, cost, iteration
        around = plan + by * np.eye(count).reshape(count, case.steps, 3)
        slope = ((costs(case, around) - cost) / by).reshape(case.steps, 3)
        steepest = float(np.abs(slope).max())
        if steepest == 0.0:
            return plan, cost, iteration
        longest = 2.0 * case.most_am2 / steepest
        tried = plan - LENGTHS[:, None, None] * longest * slope
        tried = np.clip(tried, -case.most_am2, case.most_am2)
        found = costs(case, tried)
        best = int(np.argmin(found))
        if not found[best] < cost:
            return plan, cost, iteration
        plan, cost = tried[best], float(found[best])
    return plan, cost, iterations
