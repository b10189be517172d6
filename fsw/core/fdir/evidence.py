"""The one rule by which a unit is isolated, readmitted or suspected: a sequential test of evidence, in nats.

A sample that is as likely under a fault as without has no weight; otherwise it weighs its log-likelihood
ratio l, and the test of Wald and Page sums it up, E <- max(0, E + l), until E reaches A. A sound unit gets
there once in e^A independent samples on average, or less often. The mean time between false alarms is what
the table states, T, and the time over which errors of the samples are correlated is tau, so that

    A = ln(T / tau).

Samples closer than tau are not independent: a sample weighs no more than its share of one nat per tau against
a unit, whatever its likelihood. So no single sample isolates, nor do many in a short time.

Readmission is the same test of the opposite question. A faulty sensor looks right ``CHANCE`` of the time,
because its error happens to lie where it does not show, and a sound one all but ``MISS`` of it: samples that
fit weigh ln(1 / CHANCE) per tau, those that do not, ln(MISS / (1 - CHANCE)) per tau / 2, the sampling time of
the slowest sensor. So one that does not fit weighs all of it at 1 Hz, and its share of it where a tick h is
shorter. With the part m of its samples refused, a sensor then gains

    (1 - m) ln(1 / CHANCE) / tau + m ln(MISS / (1 - CHANCE)) 2 / tau

nats a second at any rate: a sound one, m = 1e-3, reaches A in 135 s, one beyond m = 0.02 loses. With
all of it at once the sum would be m ln(MISS / (1 - CHANCE)) / h: above 10 Hz what the gate refuses of noise
would undo what fits.

Source: Wald 1945; Page 1954, Continuous inspection schemes (Biometrika 41); Lorden 1971 for the e^A.
"""

from dataclasses import dataclass
from math import log
from typing import Final

from fsw.core.estimation.mekf import LAG_S

CORRELATION_S: Final = 2.0
"""Errors of samples closer than this are not independent: twice the sampling time of the slowest sensor."""
MISS: Final = 1e-3
"""Fraction of the samples of a sound sensor that the filter's gate refuses."""
CHANCE: Final = 0.8
"""Largest fraction of the time in which a faulty sensor looks right."""
BLIND_S: Final = 120.0
"""A prediction that nothing has confirmed for longer is not valid: pulses may have failed unseen."""
SIGMAS: Final = 4.0
"""Beyond this many standard deviations a number is neither noise nor within what the table allows."""
DAY_S: Final = 86400.0


@dataclass(frozen=True, slots=True)
class EvidenceWeights:
    """The threshold, and what a sample weighs in a tick, nats.

    ``against``: a bad sample against a unit, and a good one in its favour; ``fits`` and ``misfits``: a sample
    of an isolated unit; ``agrees``: a pair of samples of which only their angle can be compared.
    ``blind_ticks``: how long a prediction without samples stays valid; ``averaged``: samples in the mean of
    innovations; ``lasting``: variance of that mean, of field and of Sun, over what it is of white ones.
    """

    threshold: float
    against: float
    fits: float
    misfits: float
    agrees: float
    blind_ticks: int
    averaged: float
    lasting: tuple[float, float] = (1.0, 1.0)


def weights(
    false_alarm_days: float, tick_s: float, of_steps: tuple[float, float] = (0.0, 0.0)
) -> EvidenceWeights:
    """The weights that keep the budget.

    Args:
        false_alarm_days: mean time between false alarms of a unit.
        tick_s: length of a tick.
        of_steps: part of the variance of a sample, of field and of Sun, that is the error within a step of a
            quantised reading: it lasts while the reading stands still, and no mean is without it.
    """
    part, averaged = tick_s / CORRELATION_S, 2.0 * LAG_S / tick_s - 1.0
    fits, (of_field, of_sun) = -log(CHANCE), of_steps
    return EvidenceWeights(
        threshold=log(false_alarm_days * DAY_S / CORRELATION_S),
        against=part,
        fits=part * fits,
        misfits=2.0 * part * log(MISS / (1.0 - CHANCE)),
        agrees=part * fits / PAIR_NUMBERS,
        blind_ticks=round(BLIND_S / tick_s),
        averaged=averaged,
        lasting=(1.0 + averaged * of_field, 1.0 + averaged * of_sun),
    )


PAIR_NUMBERS: Final = 4
"""Numbers that a pair of directions consists of; their angle is one of them."""


def weigh(nats: float, by: float, threshold: float) -> float:
    """The evidence after a sample that weighs ``by``: never negative, nor beyond the threshold."""
    return min(max(0.0, nats + by), threshold)


INFLATION: Final = 4.0
"""Factor by which a covariance is wrong if it is: of the innovations under a fault that is too slow for the
filter's gate, of an estimate that is to be used, of a prediction by which a sample is to be judged."""


def misfit(nis: float, numbers: int) -> float:
    """What innovations weigh against every unit that contributes to them, at most one nat.

    The log-likelihood ratio of a covariance of ``INFLATION`` times the filter's and the filter's own.

    Args:
        nis: normalised innovation squared.
        numbers: how many numbers it is of; none weigh nothing.
    """
    weight = 0.5 * (1.0 - 1.0 / INFLATION) * nis - 0.5 * numbers * log(INFLATION)
    return max(-1.0, min(1.0, weight))


Means = tuple[float, float, float, float, float, float]
"""Of field and Sun, three numbers each."""


def mean_misfit(means: Means, weights: EvidenceWeights) -> float:
    """What the mean innovations of the sensor that is further off weigh against the estimate, nats.

    The log-likelihood ratio of a lasting deviation, and of a covariance ``INFLATION`` times the filter's:
    half of chi square, which is n / ``INFLATION`` m^2 for white innovations with mean m over n samples, and
    less by 1 + n p where the part p of their variance lasts.

    Args:
        means: of field and Sun, three numbers each, in standard deviations.
        weights: of the evidence.
    """
    b1, b2, b3, s1, s2, s3 = means
    of_field, of_sun = weights.lasting
    most = max((b1 * b1 + b2 * b2 + b3 * b3) / of_field, (s1 * s1 + s2 * s2 + s3 * s3) / of_sun)
    return 0.5 * weights.averaged * most / INFLATION
