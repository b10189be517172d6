"""The largest attitude gain before the controlled attitude loses its stability, and how it does.

A projected torque is not the one demanded, and a strong one can turn the body the wrong way: as k_a grows at
constant k_w, a characteristic multiplier of the linear motion leaves the unit circle and the equilibrium
bifurcates,

    at +1 (fold): other equilibria meet it;  at -1 (flip): a motion with a period of two orbits does;
    as a pair (torus): a motion with a second period beside the orbit's does.

Beyond that gain the nominal attitude is unstable. The damping part alone has no such limit.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Della Rossa, Bergamasco, Lovera 2012.
"""

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import NEUTRAL, degree_of_stability, monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop
from sim.value_types import Array

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
