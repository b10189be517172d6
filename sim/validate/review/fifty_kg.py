"""The 50 kg satellite of the claims, a sphere beside it, and flights of both from rest."""

from math import radians
from typing import Any

import numpy as np

from sim.design.theory.bodies import BODIES
from sim.validate.review.law_flight import LawFlight, fly

BODY = BODIES[2]
INERTIA = BODY.inertia_kgm2
SPHERE = ((1.6, 0.0, 0.0), (0.0, 1.6, 0.0), (0.0, 0.0, 1.6))
"""Of about the same mean moment."""
PD: dict[str, Any] = {"k_w": 6.2694e6, "k_a": 1614.9}
"""Its best gains of the PD law by Floquet theory."""
DIRECTION = (1.0, 2.0, 3.0)
"""Of the first turn, no body axis; of any length."""


def flight(law: str, angle_deg: float, **changed: object) -> LawFlight:
    """Five orbits by the form of POINT, begun at rest in the orbital frame, turned about ``DIRECTION``."""
    turn = radians(angle_deg) * np.array(DIRECTION) / np.linalg.norm(DIRECTION)
    x, y, z = turn.tolist()
    start: dict[str, Any] = {"rotation_rad": (x, y, z), "relative": True, "near": True}
    rest: dict[str, Any] = {"inertia_kgm2": INERTIA, "most_am2": 5.0, "orbits": 5.0, "step_s": 10.0}
    return LawFlight(law, **(start | rest | changed))


def last_orbit_deg(case: LawFlight) -> float:
    """The largest angle from the nominal attitude in the last orbit of a flight."""
    return fly(case).last_orbit_deg
