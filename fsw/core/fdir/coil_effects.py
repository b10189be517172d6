"""What the coils did to the rate, from what the filter did not expect to measure afterwards.

The filter assumes the torque impulse of a pulse. If pulse j had (1 + e_j) times that effect (e = -1:
none, e = -2: the other way), the error state is off by the sum of e_j u_j; at the end of the pulse u_j is the
change that it should have made. The filter propagates the u_j (F its transition, K its gain, H its
sensitivity, y its innovation and S the covariance of y):

    predict  u_j <- F u_j                  update  t_j = H u_j,    u_j <- u_j - K t_j

The mean of the innovation is then the sum of e_j t_j, not zero. Least squares for e, all at once,

    A_ij = sum of t_i^T S^-1 t_j,    a_j = sum of t_j^T S^-1 y,    (A + 1) e = a,

are exact: no guess has to be tried, and no pulse is charged with what an earlier one has left. The 1 means
that before any measurement e_j is 0 with a standard deviation of 1. The estimate lacks the sum of e_j u_j.
What is left, the sum of y^T S^-1 y less a^T e, is about the number of scalars measured if nothing but the
coils was wrong; where it is more a sensor may be faulty, and no coil is judged.

A stray current, one without a request, flows in one of the coils, and the supply, which they share, does not
show in which. For each of the three u_j grows, tick by tick, by what the current would do there: e_j is 1 for
the one in which it flows and 0 for the others.

Source: Friedland 1969, Treatment of bias in recursive filtering (IEEE Trans. Automatic Control 14), e being
the bias. Willsky and Jones 1976 estimate the size of jumps by the same sums.
"""

import numpy as np

from fsw.core.algebra.vector import Mat3, Vec3, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.kalman import Matrix, Trace, unexplained
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.explanations import (
    CERTAIN,
    MODEL_ERROR,
    PULSES,
    STRAY,
    Solution,
    indices_of,
    of_pulses,
)

UNEXPLAINED = 1.25
"""Squares of the innovations that may be left for each scalar measured; beyond, no coil is judged."""


def trace_pulse(estimate: Estimate, coil: int, kick_radps: Vec3, pulse_s: float) -> Estimate:
    """Trace one more pulse, which ends now, and the oldest of its coil no longer.

    Args:
        estimate: before.
        coil: whose the pulse is.
        kick_radps: change of rate that the filter assumed, body axes.
        pulse_s: its length.
    """
    trace = estimate.trace or _empty_trace(estimate)
    own = indices_of(coil, trace.causes)
    if len(own) == PULSES:
        trace = _without(trace, own[-1])
    effect = np.array((*scale(0.5 * pulse_s, kick_radps), *kick_radps))
    return estimate._replace(trace=_extended(trace, (coil,), effect[:, np.newaxis]))


def trace_stray(estimate: Estimate, kicks_radps: Mat3, tick_s: float, begins: bool) -> Estimate:
    """Trace a stray current in any of the coils over one more tick.

    Args:
        estimate: before.
        kicks_radps: by coil, the change of rate that the current would make in this tick, body axes.
        tick_s: length of a tick.
        begins: whether the current began in this tick; an earlier one is then forgotten.
    """
    trace = estimate.trace or _empty_trace(estimate)
    if begins or STRAY not in trace.causes:
        for cause in (STRAY, STRAY + 1, STRAY + 2):
            if cause in trace.causes:
                trace = _without(trace, trace.causes.index(cause))
        trace = _extended(trace, (STRAY, STRAY + 1, STRAY + 2), np.zeros((6, 3)))
    effect, first = trace.effect.copy(), trace.causes.index(STRAY)
    kicks = np.array(kicks_radps).T
    effect[0:3, first : first + 3] += 0.5 * tick_s * kicks
    effect[3:6, first : first + 3] += kicks
    return estimate._replace(trace=trace._replace(effect=effect))


def settle_stray(estimate: Estimate, coil: int, tuning: MekfConfig) -> Estimate:
    """Correct the estimate by a stray current that certainly flows in this coil, and trace it no longer.

    Args:
        estimate: before, with the trace of a stray current.
        coil: in which it flows.
        tuning: of the filter.

    Raises:
        ValueError: it has no such trace.
    """
    trace = estimate.trace
    if trace is None or STRAY not in trace.causes:
        raise ValueError("no stray current is traced")
    flows = trace.causes.index(STRAY + coil)
    lacks = trace.effect[:, flows]
    estimate = mekf.corrected(estimate, lacks, MODEL_ERROR**2 * np.outer(lacks, lacks), tuning)
    without = np.eye(len(trace.sums))
    without[flows, -1] = -1.0  # the innovations less what the current has done to them
    sums = without.T @ trace.sums @ without
    others = [index for index, cause in enumerate(trace.causes) if cause < STRAY]
    places = [*others, -1]
    causes = tuple(trace.causes[index] for index in others)
    return estimate._replace(
        trace=Trace(causes, trace.effect[:, places], sums[places][:, places], trace.measured)
    )


def _empty_trace(estimate: Estimate) -> Trace:
    return Trace((), np.zeros((len(estimate.covariance), 1)), np.zeros((1, 1)), 0)


def _extended(trace: Trace, causes: tuple[int, ...], effects: Matrix) -> Trace:
    """With more causes, by columns of effects on attitude and rate; what is unexplained counts from here."""
    new, size = len(causes), len(causes) + len(trace.sums)
    effect, sums = np.zeros((len(trace.effect), size)), np.zeros((size, size))
    effect[:6, :new] = effects
    effect[:, new:], sums[new:, new:] = trace.effect, trace.sums
    sums[-1, -1] -= unexplained(trace.sums)
    return Trace((*causes, *trace.causes), effect, sums, 0)


def _without(trace: Trace, index: int) -> Trace:
    """Without one of the causes, its deviation being integrated out."""
    causes, effect, sums, measured = trace
    row = sums[index]
    sums = sums - np.outer(row, row) / (row[index] + 1.0)
    others = [place for place in range(len(sums)) if place != index]
    return Trace(causes[:index] + causes[index + 1 :], effect[:, others], sums[others][:, others], measured)


def solve(estimate: Estimate, tuning: MekfConfig) -> tuple[Estimate, Solution | None]:
    """Solve for what the causes did.

    Args:
        estimate: before.
        tuning: of the filter.

    Returns:
        The estimate, corrected where a deviation is certain, and the solution, if the causes explain what was
        measured.
    """
    trace = estimate.trace
    if trace is None:
        return estimate, None
    if not (np.isfinite(trace.sums).all() and np.isfinite(trace.effect).all()):
        return estimate._replace(trace=None), None
    try:
        return _solve(estimate, trace, tuning)
    except np.linalg.LinAlgError:  # as of sums that are damaged
        return estimate._replace(trace=None), None


def _solve(estimate: Estimate, trace: Trace, tuning: MekfConfig) -> tuple[Estimate, Solution | None]:
    covariance: Matrix = np.asarray(np.linalg.inv(trace.sums[:-1, :-1] + np.eye(len(trace.causes))), float)
    covariance = 0.5 * (covariance + covariance.T)
    np.linalg.cholesky(covariance)  # raises if it is not positive, lest an inverse of a part of it does later
    deviation = covariance @ trace.sums[:-1, -1]
    if unexplained(trace.sums) > UNEXPLAINED * trace.measured:
        return estimate, None
    solution = Solution(trace.causes, deviation, covariance)
    if not of_pulses(solution)[0].fits:
        return estimate, None
    effect = trace.effect[:, :-1]
    certain = deviation**2 > CERTAIN**2 * (covariance.diagonal() + MODEL_ERROR**2)
    if (certain & effect.any(axis=0)).any():
        estimate = mekf.corrected(estimate, effect @ deviation, effect @ covariance @ effect.T, tuning)
        estimate = estimate._replace(trace=trace._replace(effect=np.zeros_like(trace.effect)))
    return estimate, solution
