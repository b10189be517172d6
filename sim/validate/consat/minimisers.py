"""The two ways to the dipole of the unrestricted law: the paper's genetic search beside the closed form."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from fsw.core.laws.plan.genetic import search
from fsw.core.laws.predictive import best_impulse, free_rate_change, missing_impulse
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.campaign.population import random_direction
from sim.campaign.study import spread_of
from sim.plant.environment.orbit import EARTH_RADIUS_M, MU_M3PS2
from sim.plant.rotation import matrix, normalise
from sim.validate.consat.posat1 import FULL_SCALE_AM2, SOURCE
from sim.validate.consat.prediction import rows, vec3
from sim.value_types import Array

STATES, TASKS = 400, 4
PULSE_S = 3.0
RADIUS_M = EARTH_RADIUS_M + 800e3
RATES_RADPS = (1e-4, 1e-3)
"""Least and most size of Omega while librating; its logarithm is uniform."""
FIELD_T = (2e-5, 5e-5)
INERTIA = np.diag([1.0, 139.0, 139.0])
PRODUCTS = np.array([[0.0, 0.6, -0.4], [0.6, 0.0, 7.0], [-0.4, 7.0, 0.0]])
"""The products of inertia that every second state has, kg m^2."""


def studies() -> list[Study]:
    """The genetic search against the closed form."""
    return [genetic()]


def genetic() -> Study:
    """How much of the energy that the best dipole takes away the search leaves, over many states."""
    statement = "Part of the energy taken away by the closed form that the genetic search leaves"
    claims = (
        Claim("genetic.median", f"{statement}, median", SOURCE, "1", high=1e-3),
        Claim("genetic.all", f"{statement}, all", SOURCE, "1", high=0.3),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        left = [part for parts in found for part in parts]
        values = (float(np.median(left)), float(np.max(left)))
        return [
            claim.judge(value, spread=spread_of(claim, left))
            for claim, value in zip(claims, values, strict=True)
        ]

    count = STATES // TASKS
    tasks = tuple(partial(parts_left, range(first, first + count)) for first in range(0, STATES, count))
    return Study("genetic", tasks, conclude)


def parts_left(seeds: range) -> list[float]:
    """(E_search - E_best) / (E_none - E_best) of each state, E the cost (5) at the predicted rate."""
    return [part_left(seed) for seed in seeds]


def part_left(seed: int) -> float:
    """Of one state: any attitude and directions, rates as when librating."""
    random = np.random.default_rng(seed)
    inertia = INERTIA + (seed % 2) * PRODUCTS
    inverse = np.linalg.inv(inertia)
    matrix_rows, b = rows(inertia), vec3(random.uniform(*FIELD_T) * random_direction(random))
    omega = vec3(np.exp(random.uniform(*np.log(RATES_RADPS))) * random_direction(random))
    q0, q1, q2, q3 = random.standard_normal(4).tolist()
    attitude = matrix(normalise((q0, q1, q2, q3)))
    change = free_rate_change(
        omega,
        attitude,
        float(np.sqrt(MU_M3PS2 / RADIUS_M**3)),
        RADIUS_M,
        matrix_rows,
        rows(inverse),
        (0.0, 0.0, 0.0),
    )
    missing = np.array(missing_impulse(omega, change, (0.0, 0.0, 0.0), PULSE_S, matrix_rows))

    def cost(impulse: Array) -> float:
        left = missing - impulse
        return float(left @ inverse @ left)

    m = search(vec3(missing), b, PULSE_S, FULL_SCALE_AM2, rows(inverse), seed)
    best = cost(np.array(best_impulse(vec3(missing), b, matrix_rows)))
    return (cost(PULSE_S * np.cross(m, b)) - best) / (cost(np.zeros(3)) - best)
