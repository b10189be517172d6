"""Claims on the laws of a satellite with a wheel of constant speed (section 2.2), flown rigidly."""

from math import cos, degrees, radians, sin

import numpy as np

from fsw.input.schema import Nested
from sim.campaign.claim import Study
from sim.tuning.flown import RigidFlight
from sim.validate.review.rigid_trial import NEAR, RigidTrial, Trial, TrialFigure, gains, over

NORMAL = (0.0, -sin(radians(98.6)), cos(radians(98.6)))
"""Of the orbit, eci."""
PITCH_RAD = 0.5
WHEEL: Nested = {"body": {"inertia_kgm2": [1.9, 1.95, 2.0], "wheel_nms": [0.0, 0.0, 0.05]}}


def trials() -> list[Trial]:
    """Dual spin, and field tracking with the wheel and without."""
    stiff = {"pitch_rad": PITCH_RAD, "stiffness": 2.0}
    return [
        Trial(
            "review.wheel.dual_spin",
            "section 2.2 [18, 40]",
            (RigidTrial("dual_spin", over(WHEEL, NEAR, gains("dual_spin", 1e7, stiff, 4000.0)), 4.0),),
            (
                TrialFigure(
                    "tilt",
                    "The momentum from the orbit normal after 4 orbits, from 11 deg",
                    "deg",
                    lambda flights: float(flights[0].momentum_to_deg(NORMAL)[-1]),
                    high=1.2,
                ),
                TrialFigure(
                    "pitch",
                    "The body from its pitch of 0.5 rad then",
                    "deg",
                    lambda flights: abs(_pitch_deg(flights[0]) - degrees(PITCH_RAD)),
                    high=1.0,
                ),
            ),
        ),
        Trial(
            "review.wheel.tracking",
            "section 2.2 [42]",
            (
                RigidTrial(
                    "field_tracking", over(WHEEL, NEAR, gains("field_tracking", 1e7, k_a=2000.0)), 4.0
                ),
                RigidTrial("field_tracking", over(NEAR, gains("field_tracking", 6.27e6, k_a=1614.0)), 4.0),
            ),
            (
                TrialFigure(
                    "wheel",
                    "Attitude error by field tracking with a wheel after 4 orbits, from 20 deg",
                    "deg",
                    lambda flights: float(flights[0].pointing_deg[-1]),
                    high=0.5,
                ),
                TrialFigure(
                    "bare",
                    "The same without a wheel, by gains that suit the PD law: it is driven away",
                    "deg",
                    lambda flights: float(flights[1].pointing_deg[flights[1].orbit(-1)].min()),
                    low=20.0,
                ),
            ),
        ),
    ]


def studies() -> list[Study]:
    """All of this module."""
    return [trial.study() for trial in trials()]


def _pitch_deg(flight: RigidFlight) -> float:
    """Turn about axis 3, body from orbit."""
    q0, _, _, q3 = flight.q_body_from_orbit[-1]
    return degrees(2.0 * np.arctan2(q3, q0))
