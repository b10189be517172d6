"""What explains the deviations of pulses: a weak coil, all coils alike, or no coil.

Every explanation is weighed by its likelihood, and accepted only if what it leaves is noise and every other
one is less likely by the threshold of the evidence.
"""

from math import inf, sqrt
from typing import Final, final

import numpy as np

from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.coils.weak_test import (
    NO_PULSES,
    NOTHING_OLDER,
    REVERSED,
    Older,
    PartSum,
    WeakTest,
    weigh_pulse,
)
from fsw.core.fdir.evidence import SIGMAS

PULSES: Final = 3
"""How many of each coil's latest pulses are solved for."""
NONE: Final = -1
ALL: Final = -2
"""In place of a coil: no coil is faulty, or all are equally weak."""
LEAST_MEASURED: Final = 1e-3
"""Part of a pulse's variance that measurements have taken away; with less they say nothing of it."""
STRAY: Final = 3
"""STRAY + j is the number, as a cause, of a stray current in coil j; j itself that of a pulse."""


@final
class Solution:
    """What each cause did.

    ``part``: its fraction of the nominal effect, ``deviation``: that less what the filter assumed, (k), and
    their covariance, (k, k); ``uncertain``: standard deviations of the parts beyond it, (k).
    ``explanations``: what may be wrong with the pulses, the likeliest first.
    """

    __slots__ = ("causes", "covariance", "deviation", "explanations", "part", "uncertain")

    def __init__(
        self,
        causes: tuple[int, ...],
        part: Matrix,
        deviation: Matrix,
        covariance: Matrix,
        uncertain: Matrix,
    ) -> None:
        self.causes = causes
        self.part = part
        self.deviation = deviation
        self.covariance = covariance
        self.uncertain = uncertain
        self.explanations = explain_pulses(self)

    def noise(self, indices: list[int]) -> Matrix:
        """Covariance of some causes: that of the solution, plus what is uncertain in any case."""
        covariance: Matrix = self.covariance[indices][:, indices]
        return covariance + np.diag(self.uncertain[indices] ** 2)


def indices_of(cause: int, causes: tuple[int, ...]) -> list[int]:
    """Where this cause stands, the latest first."""
    return [index for index, other in enumerate(causes) if other == cause]


@final
class Explanation:
    """What may be wrong: a coil whose latest pulses all had the same fraction of their effect.

    ``coil`` is ``NONE`` where nothing is wrong, and ``ALL`` where every pulse of any coil had that fraction,
    as with a different inertia; ``pulses`` is their number, and ``distance`` the squared Mahalanobis norm of
    what is left: minus twice the log-likelihood.
    """

    __slots__ = ("coil", "distance", "part", "pulses")

    def __init__(self, coil: int, pulses: int, part: float, distance: float) -> None:
        self.coil = coil
        self.pulses = pulses
        self.part = part
        self.distance = distance

    @property
    def fits(self) -> bool:
        """Whether what is left is noise."""
        return self.distance <= SIGMAS**2


def most_by_chance(numbers: int) -> float:
    """The chi square of this many numbers that noise exceeds as rarely as one exceeds ``SIGMAS``.

    The quantile of chi square, k (1 - 2 / 9 k + z sqrt(2 / 9 k))^3 (Wilson, Hilferty 1931).
    """
    width = 2.0 / (9.0 * numbers)
    return float(numbers * (1.0 - width + SIGMAS * sqrt(width)) ** 3)


def explain_pulses(solution: Solution) -> list[Explanation]:
    """Find what may be wrong with the pulses, the likeliest first.

    A faulty coil is so from some pulse on, and each of its later pulses has the same fraction of its effect;
    those of the others are sound. It may have failed during the pulse before: that one may then have any
    fraction. No coil is looked at where one fraction of all pulses fits: ``weak_by_pulses`` finds none then.
    """
    pulses = [index for index, cause in enumerate(solution.causes) if cause < STRAY]
    if not pulses:
        return [Explanation(NONE, 0, 1.0, 0.0)]
    whole = _Among(solution, pulses)
    alike = whole.explain(ALL, pulses)
    found = [whole.explain(NONE, []), alike]
    if alike.fits:
        return sorted(found, key=lambda explanation: explanation.distance)
    for coil in sorted({solution.causes[index] for index in pulses}):
        own = indices_of(coil, solution.causes)
        for count in range(1, len(own) + 1):
            found.append(whole.explain(coil, own[:count]))
            if count < len(own):
                others = _Among(solution, [index for index in pulses if index != own[count]])
                found.append(others.explain(coil, own[:count]))
    return sorted(found, key=lambda explanation: explanation.distance)


@final
class _Among:
    """The pulses that are to be explained, and their weights."""

    __slots__ = ("pulses", "solution", "weights")

    def __init__(self, solution: Solution, pulses: list[int]) -> None:
        self.solution = solution
        self.pulses = pulses
        self.weights: Matrix = np.asarray(np.linalg.inv(solution.noise(pulses)), float)

    def explain(self, coil: int, alike: list[int]) -> Explanation:
        """Explain them if those ``alike`` did one fraction of their effect and the others as assumed."""
        part, deviation = self.solution.part, self.solution.deviation
        off = np.array([part[index] if index in alike else deviation[index] for index in self.pulses])
        weighted = self.weights @ off
        left = float(off @ weighted)
        if not alike:
            return Explanation(coil, 0, 1.0, left)
        among = np.array([float(index in alike) for index in self.pulses])
        weight, explained = float(among @ self.weights @ among), float(among @ weighted)
        part_of_all = max(REVERSED, explained / weight)
        distance = left - 2.0 * part_of_all * explained + part_of_all**2 * weight
        return Explanation(coil, len(alike), part_of_all, distance)


def sum_pulses(solution: Solution, indices: list[int], test: WeakTest) -> PartSum:
    """Sum up what some pulses of a coil show of it, each by itself.

    By its measurements alone: the deviation d and variance c that were solved for hold the prior of each
    pulse, 0 with variance 1, which says nothing of the coil and would count as often as there are pulses.
    Without it, 1/v = 1/c - 1 and d v / c, so that d / (1 - c) has the variance c / (1 - c).
    """
    found = NO_PULSES
    variances = solution.covariance.diagonal()
    for index in indices:
        variance = float(variances[index])
        measured = 1.0 - variance
        if measured < LEAST_MEASURED:
            continue
        deviation = float(solution.deviation[index])
        part = float(solution.part[index]) - deviation + deviation / measured
        variance = variance / measured + float(solution.uncertain[index]) ** 2
        found = found.add(weigh_pulse(part, variance, test))
    return found


def oldest_pulse(solution: Solution, coil: int, test: WeakTest) -> PartSum:
    """What the oldest pulse of a coil shows, if another takes its place; otherwise nothing."""
    own = indices_of(coil, solution.causes)
    return sum_pulses(solution, own[-1:] if len(own) == PULSES else [], test)


def weak_by_pulses(
    solution: Solution, earlier: tuple[Older, Older, Older], test: WeakTest, believed_part: float
) -> tuple[int, float] | None:
    """The coil that is certainly weak, not sound, and its fraction; None while it may be another.

    Args:
        solution: of the latest pulses.
        earlier: by coil, what those before show.
        test: the evidence has to exceed its threshold, and that of every other coil by as much.
        believed_part: the most that counts as its fault. Earlier pulses that show more than this do not count
            against it: they are those of a sound coil on a heavier satellite.
    """
    believed = WeakTest(min(believed_part, test.weak_part), test.sound_part, test.threshold)
    found = solution.explanations
    alike = min([one.distance for one in found if one.coil == ALL], default=inf)
    likely = [one for one in found if one.fits and one.part < test.weak_part and one.coil != ALL]
    for one in likely:
        own = indices_of(one.coil, solution.causes)
        older = earlier[one.coil] if one.pulses == len(own) else NOTHING_OLDER
        if older.parts.nats(believed) < 0.0:
            older = Older(kept=older.kept)
        nats = older.add(sum_pulses(solution, own[: one.pulses], test)).nats(test)
        rivals = [other.distance for other in likely if other.coil != one.coil]
        alone = min(rivals, default=inf) - one.distance >= 2.0 * test.threshold
        if nats >= test.threshold and alone and alike - one.distance > SIGMAS**2:
            return one.coil, one.part
    return None


def weak_by_gain(estimate: Estimate, each: list[float], test: WeakTest) -> tuple[int, float] | None:
    """The coil whose gain, as the filter estimates it, is certainly that of a weak one, and its fraction.

    A coil that is weak from the start, or grows weak slowly, hides in the estimated errors of the coils.
    ``each``: by coil, what its gain weighs against it, nats.
    """
    for coil, nats in enumerate(each):
        part = 1.0 + estimate.parameters.coil_error[4 * coil]
        if part < test.weak_part and nats >= test.threshold:
            return coil, part
    return None


def weigh_gains(estimate: Estimate, tuning: MekfConfig, test: WeakTest) -> list[float]:
    """By coil what its gain, as the filter estimates it, weighs against it, nats; 0 where it is exact."""
    place = tuning.layout.coils
    if place is None:
        return [0.0, 0.0, 0.0]
    errors, variances = estimate.parameters.coil_error, estimate.covariance.diagonal()[place].tolist()
    nats = [0.0, 0.0, 0.0]
    for coil in range(3):
        if variances[4 * coil] > 0.0:
            nats[coil] = test.nats(1.0 + errors[4 * coil], variances[4 * coil])
    return nats
