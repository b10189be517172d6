"""Claims: the slew of least time beside a law's, and where it ends when flown open loop (section 3.2)."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, radians, sin
from typing import Any

import numpy as np

from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.theory.bodies import diagonal
from sim.design.time_optimal_slew import Slew, best, flown
from sim.validate.review.fifty_kg import BODY, DIRECTION, PD, flight
from sim.validate.review.law_flight import fly

REVIEW = "Ovchinnikov, Roldugin 2019, section 3.2"
ANGLE_DEG = 60.0
MOST_AM2, NEAR_DEG = 2.0, 1.0
OFF = (1.05, 0.95, 1.05)
"""The true moments over those of the plan."""


def studies() -> list[Study]:
    """All of this module."""
    claims = (
        Claim(
            "review.predictive.slew.time",
            f"Time of the PD law from {ANGLE_DEG:g} deg to within {NEAR_DEG:g} deg for good, over the least",
            f"{REVIEW} [107]",
            "1",
            low=10.0,
        ),
        Claim(
            "review.predictive.slew.copy",
            "Error at the end of the slew of least time flown open loop with moments 5 % off",
            f"{REVIEW} [107]: the course is to be followed",
            "deg",
            low=1.0,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        (seconds, copied), by_law = found
        return [claims[0].judge(by_law / seconds, f"{seconds:.0f} s"), claims[1].judge(copied)]

    return [Study("review.predictive.slew", (least_time, law_time), conclude)]


def slew() -> Slew:
    """The slew, from rest in the orbital frame."""
    half, size = 0.5 * radians(ANGLE_DEG), float(np.linalg.norm(DIRECTION))
    a, b, c = (sin(half) * part / size for part in DIRECTION)
    return Slew(BODY, (cos(half), a, b, c), (0.0, 0.0, 0.0), MOST_AM2)


def least_time() -> tuple[float, float]:
    """Its least time, s, and the error at its end with other moments, deg."""
    case = slew()
    found = best(case, 700.0)
    moments = [BODY.inertia_kgm2[axis][axis] * OFF[axis] for axis in range(3)]
    other = replace(BODY, inertia_kgm2=diagonal((moments[0], moments[1], moments[2])))
    return found.seconds, flown(replace(case, body=other), found).error_deg


def law_time() -> float:
    """Until the PD law stays near, s."""
    run = fly(flight("pd", ANGLE_DEG, orbits=6.0, most_am2=MOST_AM2, **PD))
    return float(run.t_s[run.angle_deg > NEAR_DEG].max())
