"""Which coil the solution isolates: one whose pulses did too little, or one that conducts by itself."""

from typing import NamedTuple

import numpy as np

from fsw.core.fdir.coil_rate import CERTAIN, MODEL_ERROR, STRAY, Solution, indices_of

CLEAR = 0.25
"""Standard deviation of a coil's effect below which its faults can be distinguished."""


class WeakCoil(NamedTuple):
    """A coil that certainly does less than it should, and what part of it."""

    coil: int
    part: float


def too_little(solution: Solution, weak_part: float, name_sigmas: float) -> WeakCoil | None:
    """The coil that by its latest pulse, or its latest few together, certainly did too little.

    Args:
        solution: what the causes did.
        weak_part: of the nominal effect; less is a fault.
        name_sigmas: certainty with which a coil is isolated, standard deviations.
    """
    causes, deviation, covariance = solution
    weak = {causes[index] for index in np.flatnonzero(deviation < weak_part - 1.0)}
    for coil in sorted(weak & {0, 1, 2}):
        own = indices_of(coil, causes)
        for count in range(1, len(own) + 1):
            latest = own[:count]
            noise = covariance[np.ix_(latest, latest)] + MODEL_ERROR**2 * np.eye(count)
            weights = np.linalg.inv(noise).sum(axis=0)
            weight = float(weights.sum())
            if not weight > CLEAR**-2:
                continue
            part = 1.0 + float(weights @ deviation[latest]) / weight
            if part + name_sigmas * weight**-0.5 < weak_part:
                return WeakCoil(coil, part)
    return None


def conducting(solution: Solution) -> int | None:
    """The coil in which a current flows without a request; None while it may be another, or none.

    Of the four explanations (e = 0, or 1 for one of the coils) the likeliest, if it fits and each other is
    less likely by ``CERTAIN``. The distance of each is the square of its deviation from the solution, by the
    covariance, less the prior's share in it.
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
