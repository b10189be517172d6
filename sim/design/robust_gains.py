"""Gains that hold for every inertia within bounds.

Averaging shows that gains e k_w and e^2 k_a stabilise inertial pointing for any inertia if e is small enough.
How small it must be is found here: the largest e with which the loop of ``feedback.inertial`` is stable for
the least and the greatest value of each moment, in all combinations that a rigid body can have.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Celani 2015 (Acta Astronautica 107).
"""

from dataclasses import replace
from itertools import product

import numpy as np

from sim.design.held_dipole import weaker
from sim.design.inertial_gains import inertial_degree
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.linear import Gains

SHARES = np.geomspace(2.0, 0.02, 60)
"""Values of e that are tried, largest first."""


def corners(body: Body, error: float) -> list[Body]:
    """The body with each moment smaller or greater by ``error`` of itself, where a body can have them."""
    j = np.diag(np.asarray(body.inertia_kgm2))
    found = []
    for signs in product((-1.0, 1.0), repeat=3):
        a, b, c = (j * (1.0 + error * np.array(signs))).tolist()
        if 2.0 * max(a, b, c) <= a + b + c:
            found.append(replace(body, inertia_kgm2=diagonal((a, b, c))))
    return found


def worst_degree(body: Body, gains: Gains, error: float) -> float:
    """The greatest degree of stability of all corners, per radian of u."""
    return max(inertial_degree(corner, gains) for corner in corners(body, error))


def robust_share(body: Body, gains: Gains, error: float) -> float | None:
    """The largest e with which all corners are stable; None where none of those tried is."""
    return next((float(e) for e in SHARES if worst_degree(body, weaker(gains, float(e)), error) < 0.0), None)
