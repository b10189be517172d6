"""Claims: regulators that leave something out of the periodic one, or know more than it (section 3.2)."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import radians
from typing import Any

import numpy as np

from fsw.core.laws.lqr import LqrGains, schedule
from fsw.core.laws.lqr_averaged import AveragedGains, averaged_schedule
from fsw.core.laws.lqr_disturbed import DisturbedGains, disturbed_schedule
from fsw.core.laws.plan.riccati import Schedule
from fsw.input.schema import Nested
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.plant.rotation import ZERO, Mat3, Vec3, cross, transform
from sim.validate.review.fifty_kg import BODY
from sim.validate.review.figures import judged
from sim.validate.review.law_flight import Extra, LawFlight, LawHistory, fly
from sim.validate.review.rigid_trial import RigidTrial, Trial, TrialFigure

REVIEW = "Ovchinnikov, Roldugin 2019, section 3.2"
SUN: Vec3 = (0.6, 0.48, 0.64)
LEVER_NM: Vec3 = (1.38e-7, -0.92e-7, 1.15e-7)
"""The pressure of light times the lever of its centre."""
ERRORS = ((1.2, 0.85, 1.1), (0.8, 1.15, 0.95))
"""What the regulator takes the moments for, over what they are."""
FLIGHT = LawFlight(
    "lqr",
    BODY.inertia_kgm2,
    near=True,
    rotation_rad=(0.1, 0.2, 0.25),
    relative=True,
    orbits=3.0,
    step_s=20.0,
    most_am2=2.0,
)
FAR: Nested = {
    "initial": {"axis": [1.0, 2.0, 3.0], "angle_deg": 120.0, "rate_degps": [0.0, 0.0, 0.0]},
    "coils": {"max_dipole_am2": 2.0},
    "flight": {"modes": {"near_deg": 179.0, "far_deg": 180.0}},
}
"""The form of POINT is flown from the start."""


def studies() -> list[Study]:
    """All of this module."""
    return [averaged(), disturbed(), state_dependent()]


def averaged() -> Study:
    """The averaged regulator with wrong moments, without a disturbance and with one."""
    claims = (
        Claim(
            "review.optimal.averaged.inertia",
            "Averaged regulator, moments up to 20 % off: error in the third orbit from 19 deg, the worst",
            f"{REVIEW} [98]",
            "deg RMS",
            high=0.5,
        ),
        Claim(
            "review.optimal.averaged.torque",
            "The same under the pressure of light, up to 2e-7 N m, of which it does not know",
            f"{REVIEW} [98]",
            "deg RMS",
            high=10.0,
        ),
    )
    flights = tuple(partial(averaged_deg, error, lit) for lit in (False, True) for error in ERRORS)

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        return judged(claims, (float(np.max(found[:2])), float(np.max(found[2:]))))

    return Study("review.optimal.averaged", flights, conclude)


def averaged_deg(error: Vec3, lit: bool) -> float:
    """RMS over the last orbit."""
    table = averaged_schedule(_taken_for(error), ZERO, *_circle(), AveragedGains())
    return last_orbit_rms_deg(replace(FLIGHT, law="lqr_averaged", extra=light if lit else None), table)


def disturbed() -> Study:
    """The regulator that learns a periodic torque beside the one that does not."""
    claims = (
        Claim(
            "review.optimal.disturbed.rms",
            "Periodic torque learned, that of light up to 2e-7 N m: error in the fifth orbit",
            f"{REVIEW} [99]; section 2.2 [44]",
            "deg RMS",
            high=2.0,
        ),
        Claim(
            "review.optimal.disturbed.gain",
            "The same over that of the regulator which does not learn",
            f"{REVIEW} [99]; section 2.2 [44]",
            "1",
            high=0.4,
        ),
        Claim(
            "review.optimal.disturbed.twice",
            "A torque of 2e-7 N m that comes twice an orbit, learned: error over that of the regulator which "
            "does not learn",
            f"{REVIEW} [99]; section 2.2 [44]: disturbances at once and twice the orbital rate",
            "1",
            high=0.4,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        learned, plain, learned_twice, plain_twice = found
        return judged(claims, (learned, learned / plain, learned_twice / plain_twice))

    tasks = [
        partial(deg, torque) for torque in (light, twice_an_orbit) for deg in (learned_deg, unlearned_deg)
    ]
    return Study("review.optimal.disturbed", tuple(tasks), conclude)


def learned_deg(torque: Extra, learning: float = 1.0) -> float:
    """RMS over the last of five orbits under a torque that is learned."""
    gains = DisturbedGains(learning=learning)
    table = disturbed_schedule(BODY.inertia_kgm2, ZERO, *_circle(), gains)
    case = replace(FLIGHT, law="lqr_disturbed", gains=gains, orbits=5.0, extra=torque)
    return last_orbit_rms_deg(case, table)


def unlearned_deg(torque: Extra) -> float:
    """The same by ``lqr``."""
    table = schedule(BODY.inertia_kgm2, ZERO, *_circle(), LqrGains())
    return last_orbit_rms_deg(replace(FLIGHT, orbits=5.0, extra=torque), table)


def state_dependent() -> Study:
    """The regulator of the nonlinear motion beside that of the linear one, from far off."""
    return Trial(
        "review.optimal.sdre",
        "section 3.2 [101]",
        tuple(RigidTrial(law, FAR, 1.0, 20.0) for law in ("sdre", "lqr")),
        (
            TrialFigure(
                "cost",
                "Mean square of the error in the first orbit from 120 deg, nonlinear over linear regulator",
                "1",
                lambda flights: float(
                    np.mean(flights[0].pointing_deg ** 2) / np.mean(flights[1].pointing_deg ** 2)
                ),
                high=0.85,
            ),
        ),
    ).study()


def light(c_body_from_eci: Mat3, velocity_eci_mps: Vec3) -> Vec3:
    """The torque of light that comes from a fixed direction: in the orbital frame once an orbit."""
    return cross(transform(c_body_from_eci, SUN), LEVER_NM)


def twice_an_orbit(c_body_from_eci: Mat3, velocity_eci_mps: Vec3) -> Vec3:
    """A torque along a body axis that goes with the cosine of twice the argument of latitude.

    It has no part that is constant or comes once an orbit. The node is axis 1 of eci.
    """
    along = velocity_eci_mps[0] / float(np.linalg.norm(velocity_eci_mps))
    x, y, z = ((1.0 - 2.0 * along**2) * part for part in LEVER_NM)
    return (x, y, z)


def last_orbit_rms_deg(case: LawFlight, table: Schedule) -> float:
    """RMS over the last orbit of a law that flies by a schedule."""
    return rms_deg(fly(replace(case, schedules={case.law: table})))


def rms_deg(flown: LawHistory) -> float:
    """Of the error over the last orbit."""
    return float(np.sqrt(np.mean(flown.angle_deg[flown.orbits > flown.orbits[-1] - 1.0] ** 2)))


def _taken_for(error: Vec3) -> Mat3:
    r1, r2, r3 = (np.array(BODY.inertia_kgm2) * np.array(error)[:, None]).tolist()
    return ((r1[0], r1[1], r1[2]), (r2[0], r2[1], r2[2]), (r3[0], r3[1], r3[2]))


def _circle() -> tuple[float, float, float]:
    return BODY.rate_radps, radians(BODY.inclination_deg), BODY.field_t
