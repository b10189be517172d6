"""Claims: prediction, adaptation and the papers of PoSAT-1 (sections 3.3, 3.4)."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, radians
from typing import Any

import numpy as np

from fsw.core.laws.lqr import LqrGains, orbit_problem, schedule
from fsw.core.laws.mpc_box import programme
from fsw.core.laws.plan.box import box_minimum
from fsw.core.laws.plan.riccati import Array
from fsw.core.laws.plan.tumbling import Tumbling, costs, descend
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.explicit_mpc import pieces
from sim.design.theory.bodies import BODIES
from sim.validate.review import field_prediction, time_optimal_slew

BODY = BODIES[2]
REVIEW = "Ovchinnikov, Roldugin 2019, section 3.3"
MOST_AM2, STATES, ANGLE_RAD, HORIZONS = 0.02, 200, 0.3, (1, 3)
TUMBLING_DEGPS, HORIZON_S, STEPS = 5.0, 60.0, 12


def studies() -> list[Study]:
    """All of this section."""
    return [limits(), explicit(), stopping(), *field_prediction.studies(), *time_optimal_slew.studies()]


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
