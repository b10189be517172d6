"""The test that decides whether a coil is weak or sound, and what its pulses weigh in it.

A weak coil has the same fraction of its effect at every pulse. So its pulses count by the fraction on which
they agree, not each by its own: pulses that contradict each other prove little.
"""

from dataclasses import dataclass
from math import sqrt
from typing import Final, final

from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.evidence import SIGMAS

MODEL_ERROR: Final = 0.05
"""Relative uncertainty of a coil's effect that no measurement reduces."""
MOST: Final = 0.6
"""Fraction of the threshold that a pulse weighs at most: one isolates no coil, two that agree do."""
REVERSED: Final = -1.0
"""Least fraction of its effect that a coil can have."""


@final
@dataclass(frozen=True, slots=True)
class WeakTest:
    """The test that decides whether a coil is weak or sound.

    ``weak_part`` of the nominal current or effect is the most that is weak, ``sound_part`` the least that the
    bound of the coils' gains allows; evidence of ``threshold``, nats, isolates a coil.
    """

    weak_part: float
    sound_part: float
    threshold: float

    def nats(self, part: float, variance: float) -> float:
        """What a measured part weighs against the coil: the likeliest weak against the likeliest sound one.

        (sound - part)^2 / 2 sigma^2 below what is sound, less (part - weak)^2 / 2 sigma^2 above what is weak,
        or the like below ``REVERSED``.
        """
        lacks, exceeds = max(0.0, self.sound_part - part), max(0.0, part - self.weak_part, REVERSED - part)
        return (lacks**2 - exceeds**2) / (2.0 * variance)


def weak_test(weak_part: float, threshold: float, mekf: MekfConfig) -> WeakTest:
    """The test by the filter's prior of the gains: a sound coil is within ``SIGMAS`` of nominal.

    Args:
        weak_part: the most that is weak.
        threshold: of the evidence.
        mekf: the filter.
    """
    place = mekf.layout.coils
    variance = 0.0 if place is None else float(mekf.initial_covariance[place, place].diagonal()[::4].max())
    deviation = SIGMAS * sqrt(variance + MODEL_ERROR**2)
    return WeakTest(weak_part, max(weak_part, 1.0 - deviation), threshold)


@final
@dataclass(frozen=True, slots=True)
class PartSum:
    """Pulses of a coil: how many, and the sums of w, w p and w p^2, w being the weight of a part p."""

    pulses: int = 0
    weight: float = 0.0
    weighted: float = 0.0
    squares: float = 0.0

    def nats(self, test: WeakTest) -> float:
        """What they weigh against the coil by their mean part.

        Less half of the excess of their chi square about it over their number.
        """
        if not self.weight > 0.0:
            return 0.0
        mean = self.weighted / self.weight
        nats = test.nats(mean, 1.0 / self.weight)
        scatter = max(0.0, self.squares - mean * self.weighted - self.pulses)
        return max(0.0, nats - 0.5 * scatter) if nats > 0.0 else nats

    def add(self, more: "PartSum") -> "PartSum":
        """The sum with more pulses."""
        return PartSum(
            self.pulses + more.pulses,
            self.weight + more.weight,
            self.weighted + more.weighted,
            self.squares + more.squares,
        )

    def scale(self, part: float) -> "PartSum":
        """As if there had been only this fraction of them."""
        return PartSum(
            round(part * self.pulses), part * self.weight, part * self.weighted, part * self.squares
        )


NO_PULSES = PartSum()


def weigh_pulse(part: float, variance: float, test: WeakTest) -> PartSum:
    """Weigh a pulse by its variance; but no pulse weighs more than ``MOST`` by itself."""
    nats, most = abs(test.nats(part, variance)), MOST * test.threshold
    weight = (most / nats if nats > most else 1.0) / variance
    return PartSum(1, weight, weight * part, weight * part**2)


@final
@dataclass(frozen=True, slots=True)
class Older:
    """What is left of pulses no longer traced: what they show, and ``kept`` from an earlier fault."""

    parts: PartSum = NO_PULSES
    kept: float = 0.0

    def nats(self, test: WeakTest) -> float:
        """What all of it weighs against the coil."""
        return self.kept + self.parts.nats(test)

    def add(self, more: PartSum) -> "Older":
        """What is left with more pulses."""
        return Older(self.parts.add(more), self.kept)

    def bound(self, test: WeakTest) -> "Older":
        """Nothing, once nothing speaks against the coil; at most the threshold, so that good pulses count."""
        nats = self.nats(test)
        if nats <= 0.0:
            return NOTHING_OLDER
        part = min(1.0, test.threshold / nats)
        return Older(self.parts.scale(part), part * self.kept) if part < 1.0 else self


NOTHING_OLDER = Older()
