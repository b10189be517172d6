"""What the latest pulses did to the rate, told by what the filter did not expect to measure afterwards.

The filter reckons with the torque impulse of a pulse. If pulse j had (1 + e_j) times that effect (e = -1:
none, e = -2: the other way), the error state is off by the sum of e_j u_j; at the end of the pulse u_j is the
change that it should have made. The filter carries the u_j along (F its transition, K its gain, H its
sensitivity, y its innovation and S the covariance of y):

    predict  u_j <- F u_j                  update  t_j = H u_j,    u_j <- u_j - K t_j

The mean of the innovation is then the sum of e_j t_j, not zero. Least squares for e, all pulses at once,

    A_ij = sum of t_i^T S^-1 t_j,    a_j = sum of t_j^T S^-1 y,    (A + 1) e = a,

are exact: no guess has to be flown, and no pulse is blamed for what an earlier one has left. The 1 says that
before anything is measured e_j is 0 with a standard deviation of 1. The estimate lacks the sum of e_j u_j.
What is left, the sum of y^T S^-1 y less a^T e, is about the number of the numbers measured if pulses are all
that went wrong; where it is more a sensor may be wrong, and no pulse is judged.

Source: Friedland 1969, Treatment of bias in recursive filtering (IEEE Trans. Automatic Control 14), e being
the bias. Willsky and Jones 1976 tell the size of jumps by the same sums.
"""

from typing import NamedTuple

import numpy as np

from fsw.core import mekf
from fsw.core.mekf import Estimate, Trace
from fsw.core.mekf_config import Matrix, MekfConfig
from fsw.core.vector import Vec3, scale

PULSES = 3
"""Of each coil its latest pulses are solved for, so many."""
MODEL_ERROR = 0.05
"""Relative uncertainty of a pulse's effect that no measurement takes away."""
CERTAIN = 4.0
"""Standard deviations of a pulse's deviation from which on the estimate is set right by it."""
UNEXPLAINED = 1.25
"""Of the squares of the innovations, for each number measured: what may be left, or no pulse is judged."""
CLEAR = 0.25
"""Standard deviation of what a coil does from which on one fault can be told from another."""


class Accused(NamedTuple):
    """A coil that certainly does less than it should, and what part of it."""

    coil: int
    part: float


def begin(known: Estimate, coil: int, kick_radps: Vec3, pulse_s: float) -> Estimate:
    """The estimate that carries also a pulse that ends now, and the oldest of its coil no longer.

    Args:
        known: the estimate.
        coil: whose the pulse is.
        kick_radps: change of rate that the filter reckoned with, body axes.
        pulse_s: its length.
    """
    trace = known.trace or Trace((), np.zeros((len(known.covariance), 1)), np.zeros((1, 1)), 0)
    left = trace.sums.copy()
    left[-1, -1] = _explained(trace)  # what is not is counted from here on
    trace = trace._replace(sums=left, measured=0)
    own = _pulses_of(coil, trace)
    if len(own) == PULSES:
        trace = _forgotten(trace, own[-1])
    count = len(trace.sums)
    effect, sums = np.zeros((len(known.covariance), 1 + count)), np.zeros((1 + count, 1 + count))
    effect[:6, 0] = (*scale(0.5 * pulse_s, kick_radps), *kick_radps)
    effect[:, 1:], sums[1:, 1:] = trace.effect, trace.sums
    return known._replace(trace=Trace((coil, *trace.causes), effect, sums, 0))


def _pulses_of(coil: int, trace: Trace) -> list[int]:
    return [index for index, cause in enumerate(trace.causes) if cause == coil]


def _explained(trace: Trace) -> float:
    """The part a^T e of the squares of the innovations."""
    evidence = trace.sums[:-1, -1]
    return float(evidence @ np.linalg.solve(trace.sums[:-1, :-1] + np.eye(len(evidence)), evidence))


def _forgotten(trace: Trace, pulse: int) -> Trace:
    """Without one of the pulses, its deviation being integrated out."""
    causes, effect, sums, measured = trace
    row = sums[pulse]
    sums = sums - np.outer(row, row) / (row[pulse] + 1.0)
    kept = [index for index in range(len(sums)) if index != pulse]
    return Trace(causes[:pulse] + causes[pulse + 1 :], effect[:, kept], sums[kept][:, kept], measured)


def judge(
    known: Estimate, weak_part: float, name_sigmas: float, tuning: MekfConfig
) -> tuple[Estimate, Accused | None]:
    """Solve for what the pulses did.

    Args:
        known: the estimate.
        weak_part: of the nominal effect; less is a fault.
        name_sigmas: certainty with which a coil is accused.
        tuning: of the filter.

    Returns:
        The estimate, set right where a pulse was certainly not what it was taken for, and the coil that is
        certainly faulty.
    """
    trace = known.trace
    if trace is None:
        return known, None
    if not (np.isfinite(trace.sums).all() and np.isfinite(trace.effect).all()):
        return known._replace(trace=None), None
    try:
        return _solved(known, trace, weak_part, name_sigmas, tuning)
    except np.linalg.LinAlgError:  # as of sums that are damaged
        return known._replace(trace=None), None


def _solved(
    known: Estimate, trace: Trace, weak_part: float, name_sigmas: float, tuning: MekfConfig
) -> tuple[Estimate, Accused | None]:
    covariance: Matrix = np.asarray(np.linalg.inv(trace.sums[:-1, :-1] + np.eye(len(trace.causes))), float)
    deviation = covariance @ trace.sums[:-1, -1]
    if trace.sums[-1, -1] - deviation @ trace.sums[:-1, -1] > UNEXPLAINED * trace.measured:
        return known, None
    accused = _accused(trace, deviation, covariance, weak_part, name_sigmas)
    effect = trace.effect[:, :-1]
    certain = deviation**2 > CERTAIN**2 * (covariance.diagonal() + MODEL_ERROR**2)
    if (certain & effect.any(axis=0)).any():
        known = mekf.corrected(known, effect @ deviation, effect @ covariance @ effect.T, tuning)
        known = known._replace(trace=trace._replace(effect=np.zeros_like(trace.effect)))
    return known, accused


def _accused(
    trace: Trace, deviation: Matrix, covariance: Matrix, weak_part: float, name_sigmas: float
) -> Accused | None:
    """The coil that by its latest pulse, or its latest few together, certainly does too little."""
    for coil in sorted({trace.causes[pulse] for pulse in np.flatnonzero(deviation < weak_part - 1.0)}):
        own = _pulses_of(coil, trace)
        for count in range(1, len(own) + 1):
            latest = own[:count]
            noise = covariance[np.ix_(latest, latest)] + MODEL_ERROR**2 * np.eye(count)
            weights = np.linalg.inv(noise).sum(axis=0)
            weight = float(weights.sum())
            if not weight > CLEAR**-2:
                continue
            part = 1.0 + float(weights @ deviation[latest]) / weight
            if part + name_sigmas * weight**-0.5 < weak_part:
                return Accused(coil, part)
    return None
