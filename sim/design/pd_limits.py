"""How far the PD law reaches: its largest attitude gain, the longest interval for which its dipole is held.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Della Rossa, Bergamasco, Lovera 2012 and Celani 2016.
"""

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import (
    NEUTRAL,
    degree_of_stability,
    monodromy,
    multipliers,
    product,
    transitions,
)
from sim.design.theory.linear import Gains, closed_loop, dipole_field, feedback_scales, free_motion, skew
from sim.value_types import Array

# --- The largest attitude gain before the attitude loses its stability, and how it does

MOST_FACTOR = 100.0
"""Factor up to which the gain is raised."""
SCAN, HALVINGS = 60, 30
"""Factors tried up to there, and bisections between the last stable and the first unstable one."""
REAL = 1e-6
"""Imaginary part under which a multiplier is real."""


class Leaving(StrEnum):
    """How a multiplier leaves the unit circle."""

    FOLD = "fold"
    FLIP = "flip"
    TORUS = "torus"


class Bifurcation(NamedTuple):
    """The k_a, N m / T^2, at which stability ends, and how."""

    k_a: float
    leaving: Leaving


def bifurcation(body: Body, gains: Gains) -> Bifurcation | None:
    """The first k_a above that of stable ``gains`` at which stability ends; None up to ``MOST_FACTOR`` of it.

    A projected torque is not the one demanded, and a strong one can turn the body the wrong way: as k_a grows
    at constant k_w, a characteristic multiplier of the linear motion leaves the unit circle and the
    equilibrium bifurcates,

        at +1 (fold): other equilibria meet it;  at -1 (flip): a motion with a period of two orbits does;
        as a pair (torus): a motion with a second period beside the orbit's does.

    Beyond that gain the nominal attitude is unstable. The damping part alone has no such limit.

    Source: Ovchinnikov, Roldugin 2019, section 3.1, after Della Rossa, Bergamasco, Lovera 2012.

    Raises:
        ValueError: the gains are not stable.
    """
    factors = np.geomspace(1.0, MOST_FACTOR, SCAN)
    degrees = _degrees(body, gains, factors)
    lost = np.flatnonzero(degrees > NEUTRAL)
    if degrees[0] > -NEUTRAL:
        raise ValueError("the gains must be stable")
    if len(lost) == 0:
        return None
    low, high = float(factors[lost[0] - 1]), float(factors[lost[0]])
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        stable = float(_degrees(body, gains, np.array([middle]))[0]) < 0.0
        low, high = (middle, high) if stable else (low, middle)
    k_a = high * float(np.asarray(gains.k_a))
    first = complex(multipliers(monodromy(closed_loop(body, Gains(gains.k_w, k_a))))[0])
    if abs(first.imag) > REAL:
        return Bifurcation(k_a, Leaving.TORUS)
    return Bifurcation(k_a, Leaving.FOLD if first.real > 0.0 else Leaving.FLIP)


def _degrees(body: Body, gains: Gains, factors: Array) -> Array:
    tried = Gains(gains.k_w + 0.0 * factors, factors * gains.k_a)
    return degree_of_stability(monodromy(closed_loop(body, tried)))


# --- How long a dipole may be held: Floquet theory of the sampled loop

MOST_HOLDS, LEAST_HOLDS = 40, 3
"""Intervals an orbit between which the longest stable one is sought."""
STEPS_AN_ORBIT = 48
"""Least steps of the integration over an orbit."""


def weaker(gains: Gains, e: float) -> Gains:
    """Gains e k_w and e^2 k_a."""
    return Gains(e * gains.k_w, e**2 * gains.k_a)


def held_degree(body: Body, gains: Gains, holds: int) -> float:
    """The degree of stability, per radian of u, with ``holds`` intervals an orbit.

    The dipole is computed at the beginning of each of n equal intervals of the orbit and held over it. With p
    = m / B0 in the linear motion x = (w, theta) of ``theory.linear``, and B the field in units of B0,

        x' = F x - (J^-1 [B x] p, 0),  p' = 0,     p = -[B x](K_w w + K_a theta) at each beginning,

    so that one interval maps x to (P_xx + P_xp H) x, and the orbit is the product of n such maps. Gains k_w e
    and k_a e^2 with a small e withstand a long interval; e is the parameter of Celani's averaging.

    Source: Ovchinnikov, Roldugin 2019, section 3.1, after Celani 2016 (JGCD 39, 5): a dipole that is constant
    over an interval of several steps, and gains chosen for it.
    """
    inverse, free = np.linalg.inv(np.asarray(body.inertia_kgm2)), free_motion(body)

    def matrix(u: Array) -> Array:
        whole = np.zeros((*u.shape, 9, 9))
        whole[..., :6, :6] = free
        whole[..., :3, 6:] = -inverse @ skew(dipole_field(u, body))
        return whole

    parts = -(-STEPS_AN_ORBIT // holds)
    steps = transitions(matrix, holds * parts).reshape(holds, parts, 9, 9)
    over = product(steps)
    k_w, k_a = feedback_scales(body, gains).tolist()
    cross = -skew(dipole_field(2.0 * np.pi * np.arange(holds) / holds, body))
    feedback = np.concatenate([k_w * cross, k_a * cross], axis=-1)
    return float(degree_of_stability(product(over[:, :6, :6] + over[:, :6, 6:] @ feedback)))


def longest_hold_s(body: Body, gains: Gains) -> float:
    """The longest interval up to which all are stable, s; 0.0 where none is."""
    orbit_s, longest = 2.0 * np.pi / body.rate_radps, 0.0
    for holds in range(MOST_HOLDS, LEAST_HOLDS - 1, -1):
        if held_degree(body, gains, holds) > -NEUTRAL:
            return longest
        longest = orbit_s / holds
    return longest
