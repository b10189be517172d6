"""Claims: prediction with less knowledge of the field, and prediction for a tumbling body (section 3.3)."""

from collections.abc import Sequence
from functools import partial
from math import radians
from typing import Any

import numpy as np

from fsw.core.laws.nmpc import NmpcGains, NmpcReferenceGains
from fsw.input.schema import Nested
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.theory.bodies import BODIES
from sim.tuning.flown import RigidFlight
from sim.validate.review.figures import judged
from sim.validate.review.law_flight import LawFlight, fly
from sim.validate.review.rigid_trial import NEAR, RigidTrial, Trial, TrialFigure, over

BODY = BODIES[2]
REVIEW = "Ovchinnikov, Roldugin 2019, section 3.3"
TRUE_FIELD: Nested = {"field": {"model": "igrf14"}, "disturbance": {"torque_nm": [1e-7, 1e-7, 1e-7]}}
SOON, LATE = 0.04, 0.125
"""Horizons, orbits."""
RATE_RADPS = (radians(2.5), radians(-3.5), radians(2.55))
SECONDS = 120.0
DAMPING_GAIN = 1e10
"""Of the damping law: its coils are at their limits."""


def studies() -> list[Study]:
    """All of this module."""
    return [fitted().study(), held().study(), tumbling()]


def fitted() -> Trial:
    """The plan along a fit of the true field beside that along the field, and beside the direct dipole's."""
    return Trial(
        "review.predictive.fitted",
        "section 3.3 [12, 49]",
        tuple(RigidTrial(law, over(NEAR, TRUE_FIELD), 3.0, 20.0) for law in ("mpc_fitted", "mpc", "lqr")),
        (
            TrialFigure(
                "model",
                "RMS in the third orbit, the true field fitted by five functions over the field itself",
                "1",
                lambda flights: _rms_deg(flights[0]) / _rms_deg(flights[1]),
                high=1.3,
            ),
            TrialFigure(
                "dipole",
                "The same over that of the regulator, which takes the field for the direct dipole's",
                "1",
                lambda flights: _rms_deg(flights[0]) / _rms_deg(flights[2]),
                high=0.8,
            ),
        ),
    )


def held() -> Trial:
    """The field held over a short and a long horizon."""
    return Trial(
        "review.predictive.held",
        "section 3.3 [109]",
        tuple(RigidTrial("mpc_held", over(NEAR, _horizon(orbits)), 3.0, 20.0) for orbits in (SOON, LATE)),
        (
            TrialFigure(
                "short",
                f"The field held over {SOON:g} orbit: error in the third orbit from 20 deg",
                "deg RMS",
                lambda flights: _rms_deg(flights[0]),
                high=0.6,
            ),
            TrialFigure(
                "long",
                f"The field held over {LATE:g} orbit",
                "deg RMS",
                lambda flights: _rms_deg(flights[1]),
                low=10.0,
            ),
        ),
    )


def tumbling() -> Study:
    """What prediction takes of the energy of a tumble in two minutes."""
    claims = (
        Claim(
            "review.predictive.tumbling.rule",
            "Energy taken from 5 deg/s in 2 min, searches ended by the rule over those to the end",
            f"{REVIEW} [111]",
            "1",
            low=0.95,
        ),
        Claim(
            "review.predictive.tumbling.reference",
            "The same near the damping law's course, over what that law takes with its coils at their limits",
            f"{REVIEW} [112]",
            "1",
            low=0.9,
        ),
    )
    flights = (
        partial(energy_taken, "nmpc_damping", NmpcGains()),
        partial(energy_taken, "nmpc_damping", NmpcGains(gamma=-1.0)),
        partial(energy_taken, "nmpc_reference", NmpcReferenceGains()),
        partial(energy_taken, "rate_damping"),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        by_rule, to_the_end, by_reference, law = found
        return judged(claims, (by_rule / to_the_end, by_reference / law))

    return Study("review.predictive.tumbling", flights, conclude)


def energy_taken(law: str, gains: object = None, seconds: float = SECONDS) -> float:
    """The share of the energy of rotation that is gone."""
    flown = fly(
        LawFlight(
            law,
            BODY.inertia_kgm2,
            k_w=DAMPING_GAIN,
            gains=gains,
            rotation_rad=(0.2, -0.3, 0.4),
            omega_body_radps=RATE_RADPS,
            orbits=seconds * BODY.rate_radps / (2.0 * np.pi),
            step_s=2.5,
            most_am2=2.0,
        )
    )
    omega = flown.omega_body_radps[[0, -1]]
    first, last = np.einsum("ti,ij,tj->t", omega, np.array(BODY.inertia_kgm2), omega)
    return float(1.0 - last / first)


def _horizon(orbits: float) -> Nested:
    return {"control": {"gains": {"mpc_held": {"horizon_orbits": orbits}}}}


def _rms_deg(flight: RigidFlight) -> float:
    """Over the last orbit."""
    return float(np.sqrt(np.mean(flight.pointing_deg[flight.orbit(-1)] ** 2)))
