"""What the coils did to the rate, from the filter's innovations afterwards.

The filter assumes the torque impulse of a pulse. If pulse j had (1 + e_j) times that effect (e = -1:
none, e = -2: the other way), the error state is off by the sum of e_j u_j; at the end of the pulse u_j is the
change that it should have made. The filter propagates the u_j (F its transition, K its gain, H its
sensitivity, y its innovation and S the covariance of y):

    predict  u_j <- F u_j                  update  t_j = H u_j,    u_j <- u_j - K t_j

The mean of the innovation is then the sum of e_j t_j, not zero. Least squares for e, all at once,

    A_ij = sum of t_i^T S^-1 t_j,    a_j = sum of t_j^T S^-1 y,    (A + 1) e = a,

are exact: no hypothesis has to be tried, and no pulse is blamed for what an earlier one has left. The 1 means
that before any measurement e_j is 0 with a standard deviation of 1. The estimate lacks the sum of e_j u_j.
What is left, the sum of y^T S^-1 y less a^T e, is about the number of scalars measured if nothing but the
coils was wrong; where it is more, a sensor may be faulty, and no coil is judged.

Source: Friedland 1969, Treatment of bias in recursive filtering (IEEE Trans. Automatic Control 14), e being
the bias. Willsky and Jones 1976 estimate the size of jumps by the same sums.
"""

from math import hypot, sqrt
from typing import Final

import numpy as np

from fsw.core.actuation.pulses import PulseConfig, impulse
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, norm, scale, transform
from fsw.core.estimation import mekf
from fsw.core.estimation.kalman import Cause, Matrix, Trace, unexplained
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.coils.explanations import PULSES, STRAY, Solution, indices_of, most_by_chance
from fsw.core.fdir.coils.weak_test import MODEL_ERROR
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.laws.plan.pulse_model import Pulse

UNEXPLAINED: Final = 1.25
"""Largest unexplained NIS per scalar measured; beyond it no coil is judged."""


def trace_pulse(
    estimate: Estimate,
    pulse: Pulse,
    b_eci_t: Vec3,
    gravity_ps2: float,
    pulses: PulseConfig,
    tuning: MekfConfig,
) -> None:
    """Trace one more pulse, which ends now, in place of the oldest of its coil if there are ``PULSES``.

    The trace begins anew if the innovations since the last pulse were certainly not due to a coil: whatever
    misled the filter has then misled it about those pulses too. The effect of this one is uncertain by
    ``MODEL_ERROR``, and by the fraction of it that the disturbance torque, and gravity on an inertia beyond
    the table's bounds, would do by the next pulse: if those are not what the filter takes them to be, the
    pulse seems to have done it.

    Args:
        estimate: of this tick.
        pulse: requested and driven.
        b_eci_t: the field in it.
        gravity_ps2: 3 mu/r^3.
        pulses: configuration of pulses.
        tuning: of the filter.
    """
    trace, coil = _of_coils_alone(estimate.trace) or empty_trace(estimate), pulse.coil
    own = indices_of(coil, trace.numbers)
    if len(own) == PULSES:
        trace = drop_cause(trace, own[-1])
    impulse_nms = impulse(pulse, rotate(estimate.q_body_from_eci, b_eci_t), pulses)
    kick_radps = transform(tuning.rotor.inertia_inverse, impulse_nms)
    effect = np.array((*scale(0.5 * pulses.pulse_s, kick_radps), *kick_radps))
    torque_nm = norm(estimate.parameters.torque_body_nm)
    torque_nm += gravity_ps2 * sqrt(0.5) * _inertia_beyond_kgm2(estimate, tuning)
    drift_nms = pulses.backoff_ticks * pulses.tick_s * torque_nm
    cause = Cause(
        coil,
        assumed=1.0 + estimate.parameters.coil_error[4 * coil],
        uncertain=hypot(MODEL_ERROR, drift_nms / (max(drift_nms, norm(impulse_nms)) or 1.0)),
    )
    estimate.trace = add_causes(trace, (cause,), effect[:, np.newaxis])


def _inertia_beyond_kgm2(estimate: Estimate, tuning: MekfConfig) -> float:
    """How far the estimated inertia is beyond its bounds: the norm of D, the tensor of what exceeds them.

    Gravity on it, 3 mu/r^3 e1 x D e1, is at most 3 mu/r^3 |D| / sqrt 2.
    """
    place = tuning.layout.inertia
    if place is None:
        return 0.0
    within = np.sqrt(3.0 * tuning.initial_covariance.diagonal()[place]).tolist()
    errors = estimate.parameters.inertia_error_kgm2
    xx, yy, zz, xy, xz, yz = [max(0.0, abs(e) - most) for e, most in zip(errors, within, strict=True)]
    return hypot(xx, yy, zz, xy, xy, xz, xz, yz, yz)


def _of_coils_alone(trace: Trace | None) -> Trace | None:
    """The trace, unless it leaves more of what was measured unexplained than chance would."""
    if trace is None or not trace.measured:
        return trace
    most = max(UNEXPLAINED * trace.measured, most_by_chance(trace.measured))
    return trace if unexplained(trace.sums) <= most else None


def empty_trace(estimate: Estimate) -> Trace:
    """A trace of nothing yet."""
    return Trace((), np.zeros((len(estimate.covariance), 1)), np.zeros((1, 1)), 0)


def add_causes(trace: Trace, causes: tuple[Cause, ...], effects: Matrix) -> Trace:
    """The trace with more causes, by columns of effects on attitude and rate; the unexplained counts anew."""
    new, size = len(causes), len(causes) + len(trace.sums)
    effect, sums = np.zeros((len(trace.effect), size)), np.zeros((size, size))
    effect[:6, :new] = effects
    effect[:, new:], sums[new:, new:] = trace.effect, trace.sums
    sums[-1, -1] -= unexplained(trace.sums)
    return Trace((*causes, *trace.causes), effect, sums, 0)


def drop_cause(trace: Trace, index: int) -> Trace:
    """The trace without one of its causes, whose deviation is marginalised out."""
    row = trace.sums[index]
    sums = trace.sums - np.outer(row, row) / (row[index] + 1.0)
    return select(trace, [place for place in range(len(trace.causes)) if place != index], sums)


def select(trace: Trace, kept: list[int], sums: Matrix) -> Trace:
    """The trace with only some of its causes, and with these sums."""
    places = [*kept, -1]
    causes = tuple(trace.causes[place] for place in kept)
    return Trace(causes, trace.effect[:, places], sums[places][:, places], trace.measured)


def solve(estimate: Estimate, tuning: MekfConfig, wheel_nms: Vec3 = ZERO) -> Solution | None:
    """Solve for what the causes did, and correct the estimate where a deviation is certain.

    Args:
        estimate: of this tick.
        tuning: of the filter.
        wheel_nms: momentum of a driven wheel, body axes.

    Returns:
        The solution, if the causes explain what was measured. Pulses that no coil fault explains are no
        longer traced: what they show is not a coil's, and it would remain when the one that contradicts the
        others is gone. The trace begins anew if noise may leave as much after that many pulses; otherwise
        there is none: what was known before is suspect too.
    """
    trace = estimate.trace
    if trace is None:
        return None
    if not (np.isfinite(trace.sums).all() and np.isfinite(trace.effect).all()):
        estimate.trace = None
        return None
    try:
        return _solve(estimate, trace, tuning, wheel_nms)
    except np.linalg.LinAlgError:  # from damaged sums
        estimate.trace = None
        return None


def _solve(estimate: Estimate, trace: Trace, tuning: MekfConfig, wheel_nms: Vec3) -> Solution | None:
    covariance: Matrix = np.asarray(np.linalg.inv(trace.sums[:-1, :-1] + np.eye(len(trace.causes))), float)
    covariance = 0.5 * (covariance + covariance.T)
    np.linalg.cholesky(covariance)  # raises if it is not positive, before an inverse of a part of it does
    deviation = covariance @ trace.sums[:-1, -1]
    if unexplained(trace.sums) > UNEXPLAINED * trace.measured:
        return None
    assumed, uncertain = (
        np.array([cause.assumed for cause in trace.causes]),
        np.array([cause.uncertain for cause in trace.causes]),
    )
    solution = Solution(trace.numbers, assumed + deviation, deviation, covariance, uncertain)
    pulses = [index for index, number in enumerate(trace.numbers) if number < STRAY]
    if not solution.explanations[0].fits:
        by_chance = solution.explanations[0].distance <= most_by_chance(len(pulses))
        estimate.trace = empty_trace(estimate) if by_chance else None
        return None
    effect, deviation, covariance = trace.effect[:, pulses], deviation[pulses], covariance[pulses][:, pulses]
    certain = deviation**2 > SIGMAS**2 * solution.noise(pulses).diagonal()
    if (certain & effect.any(axis=0)).any():
        mekf.correct(estimate, effect @ deviation, effect @ covariance @ effect.T, tuning, wheel_nms)
        left = trace.effect.copy()
        left[:, pulses] = 0.0
        trace.effect = left
    return solution
