"""How long a dipole of the PD law may be held: Floquet theory of the sampled loop.

The dipole is computed at the beginning of each of n equal intervals of the orbit and held over it. With
p = m / B0 in the linear motion x = (w, theta) of ``theory.linear``, and B the field in units of B0,

    x' = F x - (J^-1 [B x] p, 0),  p' = 0,     p = -[B x](K_w w + K_a theta) at each beginning,

so that one interval maps x to (P_xx + P_xp H) x, and the orbit is the product of n such maps. Gains
k_w e and k_a e^2 with a small e withstand a long interval; e is the parameter of Celani's averaging.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Celani 2016 (JGCD 39, 5): a dipole that is constant
over an interval of several steps, and gains chosen for it.
"""

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import NEUTRAL, degree_of_stability, product, transitions
from sim.design.theory.linear import Gains, dipole_field, feedback_scales, free_motion, skew
from sim.value_types import Array

MOST_HOLDS, LEAST_HOLDS = 40, 3
"""Intervals an orbit between which the longest stable one is sought."""
STEPS_AN_ORBIT = 48
"""Least steps of the integration over an orbit."""


def weaker(gains: Gains, e: float) -> Gains:
    """Gains e k_w and e^2 k_a."""
    return Gains(e * gains.k_w, e**2 * gains.k_a)


def held_degree(body: Body, gains: Gains, holds: int) -> float:
    """The degree of stability, per radian of u, with ``holds`` intervals an orbit."""
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
