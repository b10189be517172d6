"""Claims: prediction and adaptation, with less knowledge too, and the slew of least time (3.2, 3.3)."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import cos, inf, radians, sin
from typing import Any

import numpy as np

from fsw.core.laws.lqr import LqrGains, orbit_problem, schedule
from fsw.core.laws.mpc_box import programme
from fsw.core.laws.nmpc import NmpcGains, NmpcReferenceGains
from fsw.core.laws.plan.box import box_minimum
from fsw.core.laws.plan.riccati import Array
from fsw.core.laws.plan.tumbling import Tumbling, costs, descend
from fsw.input.schema import Nested
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.explicit_mpc import pieces
from sim.design.theory.bodies import BODIES, diagonal
from sim.design.time_optimal_slew import Slew, best, flown
from sim.validate.review.fifty_kg import DIRECTION, PD, flight
from sim.validate.review.figures import judged
from sim.validate.review.law_flight import LawFlight, fly
from sim.validate.review.rigid_trial import NEAR, RigidTrial, Trial, TrialFigure, final_rms_deg, over

BODY = BODIES[2]
REVIEW = "Ovchinnikov, Roldugin 2019, section 3.3"
MOST_AM2, STATES, ANGLE_RAD, HORIZONS = 0.02, 200, 0.3, (1, 3)
TUMBLING_DEGPS, HORIZON_S, STEPS = 5.0, 60.0, 12


def studies() -> list[Study]:
    """All of this section."""
    return [limits(), explicit(), stopping(), *field_studies(), *slew_studies()]


def limits() -> Study:
    """The programme within the limits beside the plan cut to them."""
    claim = Claim(
        "review.predictive.box",
        "Cost beyond the least without limits, programme over its plan cut to them, mean",
        f"{REVIEW} [110]: the limits are part of the problem",
        "1",
        high=0.2,
    )
    return Study(claim.id, (cost_ratio,), lambda found: [claim.judge(found[0])])


def cost_ratio() -> float:
    """Over half an orbit, of the states for which a limit is met."""
    h, g = _programme(24)
    left = []
    for x in _states():
        slope = g @ x
        free = np.linalg.solve(h, -slope)
        if np.abs(free).max() > MOST_AM2:
            plans = (box_minimum(h, slope, MOST_AM2), np.clip(free, -MOST_AM2, MOST_AM2))
            left.append([float((m - free) @ h @ (m - free)) for m in plans])
    ours, cut = np.mean(left, axis=0)
    return float(ours / cut)


def explicit() -> Study:
    """How many pieces the explicit form has."""
    claim = Claim(
        "review.predictive.explicit",
        f"Pieces of the explicit law that {STATES} states meet, {HORIZONS[1]} steps over {HORIZONS[0]}",
        f"{REVIEW} [110]",
        "1",
        low=2.0,
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        short, long = found[0]
        return [claim.judge(long / short, f"{short} and {long} pieces")]

    return Study(claim.id, (piece_counts,), conclude)


def piece_counts() -> tuple[int, int]:
    """For the short and the long horizon, of one field."""
    short, long = (len(pieces(*_programme(steps), _states(), MOST_AM2)) for steps in HORIZONS)
    return short, long


def stopping() -> Study:
    """The rule that ends a search."""
    claim = Claim(
        "review.predictive.stopping",
        "Steps of a search at 5 deg/s that ends at nine tenths of the fall, over those of one to the end",
        f"{REVIEW} [111]",
        "1",
        high=0.5,
    )
    return Study(claim.id, (search_ratio,), lambda found: [claim.judge(*found[0])])


def search_ratio() -> tuple[float, str]:
    """The ratio, and both counts."""
    case = Tumbling(
        inertia_kgm2=np.array(BODY.inertia_kgm2),
        wheel_body_nms=np.zeros(3),
        omega_body_radps=radians(TUMBLING_DEGPS) * np.array([0.5, -0.7, 0.51]),
        c_body_from_eci=np.eye(3),
        b_eci_t=np.array([1.5e-5, -1e-5, 2e-5]),
        b_rate_eci_tps=np.zeros(3),
        horizon_s=HORIZON_S,
        steps=STEPS,
        most_am2=2.0,
        weight=1.0,
        effort=1e-9,
        steepness=None,
    )
    start = np.zeros((STEPS, 3))
    _, least, whole = descend(case, start, -inf, 40)
    before = float(costs(replace(case), start[None])[0])
    _, _, few = descend(case, start, before - 0.9 * (before - least), 40)
    return few / whole, f"{few} and {whole} steps"


def _programme(steps: int) -> tuple[Array, Array]:
    """H and G for the 50 kg satellite, no torque, from the ascending node on."""
    orbit = (
        BODY.inertia_kgm2,
        (0.0, 0.0, 0.0),
        BODY.rate_radps,
        radians(BODY.inclination_deg),
        BODY.field_t,
    )
    table, unit = schedule(*orbit, LqrGains(effort=0.05)), np.vstack([np.eye(6), np.zeros((3, 6))])
    field = orbit_problem(*orbit, LqrGains())[1][:steps]
    both = [programme(table, field, np.eye(3), unit[:, k], steps) for k in range(6)]
    return both[0][0], np.array([g for _, g in both]).T


def _states() -> Array:
    drawn: Array = np.random.default_rng(8).uniform(-1.0, 1.0, (STATES, 6))
    states: Array = drawn * np.repeat([ANGLE_RAD * BODY.rate_radps, ANGLE_RAD], 3)
    return states


# --- Prediction with less knowledge of the field, and for a tumbling body (section 3.3)

TRUE_FIELD: Nested = {"field": {"model": "igrf14"}, "disturbance": {"torque_nm": [1e-7, 1e-7, 1e-7]}}
SOON, LATE = 0.04, 0.125
"""Horizons, orbits."""
RATE_RADPS = (radians(2.5), radians(-3.5), radians(2.55))
SECONDS = 120.0
DAMPING_GAIN = 1e10
"""Of the damping law: its coils are at their limits."""


def field_studies() -> list[Study]:
    """All of this section."""
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
                lambda flights: final_rms_deg(flights[0]) / final_rms_deg(flights[1]),
                high=1.3,
            ),
            TrialFigure(
                "dipole",
                "The same over that of the regulator, which takes the field for the direct dipole's",
                "1",
                lambda flights: final_rms_deg(flights[0]) / final_rms_deg(flights[2]),
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
                lambda flights: final_rms_deg(flights[0]),
                high=0.6,
            ),
            TrialFigure(
                "long",
                f"The field held over {LATE:g} orbit",
                "deg RMS",
                lambda flights: final_rms_deg(flights[1]),
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


# --- The slew of least time beside a law's, and where it ends when flown open loop (section 3.2)

SLEW_SOURCE = "Ovchinnikov, Roldugin 2019, section 3.2"
ANGLE_DEG = 60.0
SLEW_AM2, NEAR_DEG = 2.0, 1.0
OFF = (1.05, 0.95, 1.05)
"""The true moments over those of the plan."""


def slew_studies() -> list[Study]:
    """All of this section."""
    claims = (
        Claim(
            "review.predictive.slew.time",
            f"Time of the PD law from {ANGLE_DEG:g} deg to within {NEAR_DEG:g} deg for good, over the least",
            f"{SLEW_SOURCE} [107]",
            "1",
            low=10.0,
        ),
        Claim(
            "review.predictive.slew.copy",
            "Error at the end of the slew of least time flown open loop with moments 5 % off",
            f"{SLEW_SOURCE} [107]: the course is to be followed",
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
    return Slew(BODY, (cos(half), a, b, c), (0.0, 0.0, 0.0), SLEW_AM2)


def least_time() -> tuple[float, float]:
    """Its least time, s, and the error at its end with other moments, deg."""
    case = slew()
    found = best(case, 700.0)
    moments = [BODY.inertia_kgm2[axis][axis] * OFF[axis] for axis in range(3)]
    other = replace(BODY, inertia_kgm2=diagonal((moments[0], moments[1], moments[2])))
    return found.seconds, flown(replace(case, body=other), found).error_deg


def law_time() -> float:
    """Until the PD law stays near, s."""
    run = fly(flight("pd", ANGLE_DEG, orbits=6.0, most_am2=SLEW_AM2, **PD))
    return float(run.t_s[run.angle_deg > NEAR_DEG].max())
