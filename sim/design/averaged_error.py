"""Feedback of an error averaged over orbits, its gains by an evolutionary search.

Body axes u_i are to lie along orbital axes r_i, i = 1 and 3:

    e = 2 sum of w_i (C r_i) x u_i,    w_1 + w_3 = 1,    da/dt = (e - a) / T,
    m = -b x (k_w Omega + k_a a),

C body from orbit, T some orbits, so that a holds what is left of the error on the mean: along the field
nothing can be done now, but the field turns within T. The rate is not averaged: -k_w b x Omega is B-dot for
the field that is expected. Near the goal e = 2 (E - w_1 e1 e1^T - w_3 e3 e3^T) theta. The steps are those of
``fsw/core/laws/plan/riccati.py``; the degree of stability is ln |largest multiplier| / 2 pi, per orbital rad.

Source: Colagrossi, Lavagna 2018; Avanzini, de Angelis, Giulietti 2013 (the rate), as in Ovchinnikov, Roldugin
2019, section 3.2, which has no equation; the average is a filter of first order here, the search scipy's.
"""

from math import exp, log, pi
from typing import NamedTuple

import numpy as np
from scipy.optimize import Bounds, differential_evolution

from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.riccati import Array, Problem, pushes_of, skews
from sim.design.theory.bodies import Body

LOWEST, HIGHEST = -3.0, 1.5
"""Decimal logarithms of the gains that are searched, in units of w0 J / B0^2 and w0^2 J / B0^2."""
GENERATIONS, SEED = 40, 5


class AveragedError(NamedTuple):
    """A law: k_w, N m s / T^2, k_a, N m / T^2, w_1, and T in orbits (0: the error itself)."""

    k_w: float
    k_a: float
    share: float
    orbits: float


class AveragedBest(NamedTuple):
    """The law of the best degree of stability, 1/rad."""

    law: AveragedError
    degree: float


def error_matrix(share: float) -> Array:
    """Of theta in e near the goal, shape (3, 3)."""
    return 2.0 * np.diag([1.0 - share, 1.0, share])


def degree(body: Body, law: AveragedError) -> float:
    """Of stability, 1/rad; negative: the body comes to its attitude."""
    problem, b_orbit_t = _steps(body)
    period_s = 2.0 * pi / body.rate_radps
    over = 1.0 - exp(-problem.step_s / (law.orbits * period_s)) if law.orbits else 1.0
    error, whole = error_matrix(law.share), np.eye(9)
    feed = np.hstack([law.k_w * np.eye(3), np.zeros((3, 3)), law.k_a * np.eye(3)])
    size = np.repeat([body.rate_radps, 1.0, 1.0], 3)
    for push, across in zip(pushes_of(problem, b_orbit_t), skews(b_orbit_t), strict=True):
        fresh = np.eye(9)
        fresh[6:, 6:] *= 1.0 - over
        fresh[6:, 3:6] = over * error
        moved = np.eye(9)
        moved[:6, :6] = problem.free[:, :6]
        moved[:6] -= push @ across @ feed
        whole = moved @ fresh @ whole
    scaled = whole * size / size[:, None]
    return log(float(np.abs(np.linalg.eigvals(scaled)).max())) / (2.0 * pi)


def search(body: Body, orbits: float) -> AveragedBest:
    """The gains and the share with the best degree for an average over so many orbits."""
    moment = float(np.trace(np.array(body.inertia_kgm2))) / 3.0
    unit = body.rate_radps * moment / body.field_t**2

    def law(x: Array) -> AveragedError:
        k_w, k_a, share = x.tolist()
        return AveragedError(10.0**k_w * unit, 10.0**k_a * unit * body.rate_radps, share, orbits)

    def cost(x: Array) -> float:
        return degree(body, law(x))

    limits = Bounds(np.array([LOWEST, LOWEST, 0.1]), np.array([HIGHEST, HIGHEST, 0.9]))
    found = differential_evolution(cost, limits, maxiter=GENERATIONS, popsize=8, rng=SEED, polish=False)
    return AveragedBest(law(found.x), float(found.fun))


def _steps(body: Body) -> tuple[Problem, Array]:
    return orbit_problem(
        body.inertia_kgm2,
        body.wheel_nms,
        body.rate_radps,
        float(np.radians(body.inclination_deg)),
        body.field_t,
        LqrGains(),
    )
