"""What explains the deviations of pulses: which coil is weak, or conducts by itself, or that it is no coil.

Every explanation is weighed by its likelihood, and accepted only if what it leaves is noise and if each other
one is less likely by the threshold of the evidence.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig

MODEL_ERROR = 0.05
"""Relative uncertainty of a coil's effect that no measurement takes away."""
CERTAIN = 4.0
"""A deviation of so many standard deviations is none of noise."""
PULSES = 3
"""Of each coil its latest pulses are solved for, so many."""
STRAY = 3
"""STRAY + j is the number, as a cause, of a stray current in coil j; j itself that of a pulse."""


class Solution(NamedTuple):
    """What each cause did: its deviation e from what was assumed, and their covariance (k, k)."""

    causes: tuple[int, ...]
    deviation: Matrix
    covariance: Matrix


def indices_of(cause: int, causes: tuple[int, ...]) -> list[int]:
    """Where this cause stands, the latest first."""
    return [index for index, other in enumerate(causes) if other == cause]


class Explanation(NamedTuple):
    """What may be wrong: a coil whose latest pulses all had the same part of their effect.

    ``coil`` is -1 where nothing is; ``pulses`` is their number, and ``distance`` the square of what is left,
    by the covariance: minus twice the log-likelihood.
    """

    coil: int
    pulses: int
    part: float
    distance: float

    @property
    def fits(self) -> bool:
        """Whether what is left is noise."""
        return self.distance <= CERTAIN**2


def of_pulses(solution: Solution) -> list[Explanation]:
    """What may be wrong with the pulses, the likeliest first.

    A coil that is faulty is so from some pulse on, and each of its later pulses has the same part of its
    effect; those of the others are sound.
    """
    pulses = [index for index, cause in enumerate(solution.causes) if cause < STRAY]
    deviation = solution.deviation[pulses]
    weights = np.linalg.inv(
        solution.covariance[np.ix_(pulses, pulses)] + MODEL_ERROR**2 * np.eye(len(pulses))
    )
    nothing = float(deviation @ weights @ deviation)
    found = [Explanation(-1, 0, 1.0, nothing)]
    causes = tuple(solution.causes[index] for index in pulses)
    for coil in sorted(set(causes)):
        latest = np.zeros(len(pulses))
        for count, index in enumerate(indices_of(coil, causes), start=1):
            latest[index] = 1.0
            weight, explained = float(latest @ weights @ latest), float(latest @ weights @ deviation)
            part, distance = 1.0 + explained / weight, nothing - explained**2 / weight
            found.append(Explanation(coil, count, part, distance))
    return sorted(found, key=lambda explanation: explanation.distance)


def against(solution: Solution, weak_part: float, threshold: float) -> list[float]:
    """What each cause by itself weighs against its coil, nats, at most half of the threshold.

    The log-likelihood ratio of the part that was measured and of the least that is sound,
    (weak_part - part)^2 / 2 sigma^2, negative where the part is more.
    """
    lacks = weak_part - 1.0 - solution.deviation
    nats = 0.5 * np.sign(lacks) * lacks**2 / (solution.covariance.diagonal() + MODEL_ERROR**2)
    return [max(-0.5 * threshold, min(0.5 * threshold, float(one))) for one in nats]


def of_oldest(solution: Solution, coil: int, weak_part: float, threshold: float) -> float:
    """What the oldest pulse of a coil weighs against it, if another takes its place; else nothing."""
    own = indices_of(coil, solution.causes)
    return against(solution, weak_part, threshold)[own[-1]] if len(own) == PULSES else 0.0


def weak_by_pulses(
    solution: Solution, earlier: Vec3, weak_part: float, threshold: float
) -> tuple[int, float] | None:
    """The coil, and its part, that certainly does less than ``weak_part``; None while it may be another.

    Args:
        solution: of the latest pulses.
        earlier: by coil, what those before weigh against it, nats.
        weak_part: the most that is weak.
        threshold: of the evidence; it has to exceed that of every other coil by as much.
    """
    likely = [one for one in of_pulses(solution) if one.fits and one.part < weak_part]
    each = against(solution, weak_part, threshold)
    for one in likely:
        own = indices_of(one.coil, solution.causes)
        nats = sum(each[index] for index in own[: one.pulses])
        if one.pulses == len(own):
            nats += earlier[one.coil]
        rivals = [other.distance for other in likely if other.coil != one.coil]
        if nats >= threshold and min(rivals, default=inf) - one.distance >= 2.0 * threshold:
            return one.coil, one.part
    return None


def weak_by_gain(
    estimate: Estimate, tuning: MekfConfig, weak_part: float, threshold: float
) -> tuple[int, float] | None:
    """The coil, and its part, whose gain as the filter estimates it is certainly below ``weak_part``.

    A coil that is weak from the start, or grows weak slowly, hides in the estimated errors of the coils.
    """
    place = tuning.layout.coils
    if place is None:
        return None
    variances = estimate.covariance.diagonal()[place]
    for coil in range(3):
        part = 1.0 + estimate.parameters.coil_error[4 * coil]
        if part < weak_part and (weak_part - part) ** 2 > 2.0 * threshold * variances[4 * coil]:
            return coil, part
    return None


def conducting(solution: Solution) -> int | None:
    """The coil in which a current flows without a request; None while it may be another, or none.

    Of the four explanations (e = 0, or 1 for one of the coils) the likeliest, if each other is less likely by
    ``CERTAIN``, and it fits. No false alarm is at stake: it is certain that a current flows. The distance of
    each is the square of its deviation from the solution, by the covariance, less the prior's share in it.
    """
    stray = [index for index, cause in enumerate(solution.causes) if cause >= STRAY]
    if not stray:
        return None
    noise = solution.covariance[np.ix_(stray, stray)] + MODEL_ERROR**2 * np.eye(len(stray))
    weights = np.linalg.inv(noise)
    distances = []
    for explanation in (*np.eye(len(stray)), np.zeros(len(stray))):
        off = explanation - solution.deviation[stray]
        distances.append(float(off @ weights @ off - explanation @ explanation))
    first, second = sorted(distances)[:2]
    likeliest = distances.index(first)
    if likeliest == len(stray) or first > CERTAIN**2 or second - first < CERTAIN**2:
        return None
    return solution.causes[stray[likeliest]] - STRAY
