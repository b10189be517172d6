"""A current without a request: in which coil it flows, by what it does to the rate.

The coils share one supply, which shows the current but not the coil. So for each of the three the effect u_j
that the current would have there is traced beside those of the pulses (``effects``): it grows tick by tick,
and the fraction p_j is 1 for the coil in which it flows and 0 for the others. The filter takes what is known
of the fractions into account at once, long before the coil is certain; the trace is of the rest.
"""

import numpy as np

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, cross, scale, transform
from fsw.core.estimation import mekf
from fsw.core.estimation.kalman import Cause, Matrix, Trace
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.coils import effects
from fsw.core.fdir.coils.explanations import STRAY, Solution
from fsw.core.fdir.coils.weak_test import MODEL_ERROR
from fsw.core.fdir.evidence import SIGMAS

CAUSES = (STRAY, STRAY + 1, STRAY + 2)


def kicks_radps(m_am2: float, axes: Mat3, estimate: Estimate, b_eci_t: Vec3, tuning: MekfConfig) -> Mat3:
    """What a current of this nominal dipole would do to the rate in a tick, by coil, body axes.

    Args:
        m_am2: nominal dipole, in the sense of the coil's output.
        axes: by coil, the dipole per nominal one, body axes.
        estimate: of this tick.
        b_eci_t: field, inertial axes.
        tuning: of the filter.
    """
    b_body_t = rotate(estimate.q_body_from_eci, b_eci_t)
    first, second, third = (
        transform(tuning.rotor.inertia_inverse, scale(tuning.tick_s * m_am2, cross(axis, b_body_t)))
        for axis in axes
    )
    return first, second, third


def trace_current(estimate: Estimate, parts: Vec3, kicks_radps: Mat3, tick_s: float, begins: bool) -> None:
    """Trace a stray current in any of the coils over one more tick.

    Args:
        estimate: of this tick.
        parts: by coil, the fraction of the current that the filter took into account.
        kicks_radps: by coil, the change of rate that the current would make in this tick, body axes.
        tick_s: length of a tick.
        begins: whether the current began in this tick; an earlier one is then forgotten.
    """
    traced = estimate.trace or effects.empty_trace(estimate)
    if begins or STRAY not in traced.numbers:
        for number in CAUSES:
            if number in traced.numbers:
                traced = effects.drop_cause(traced, traced.numbers.index(number))
        causes = [Cause(number, part, MODEL_ERROR) for number, part in zip(CAUSES, parts, strict=True)]
        traced = effects.add_causes(traced, tuple(causes), np.zeros((6, 3)))
    effect, flows = traced.effect.copy(), _places(traced)
    kicks = np.array(kicks_radps).T
    effect[0:3, flows] += 0.5 * tick_s * kicks
    effect[3:6, flows] += kicks
    estimate.trace = Trace(traced.causes, effect, traced.sums, traced.measured)


def _places(traced: Trace) -> slice:
    first = traced.numbers.index(STRAY)
    return slice(first, first + 3)


def follow(estimate: Estimate, solution: Solution, tuning: MekfConfig, wheel_nms: Vec3 = ZERO) -> Vec3 | None:
    """Correct the estimate by what the current has certainly done, in whichever coils; its fraction in each.

    None while nothing is certain. The fractions stay as uncertain as before: the trace is of the rest.

    Args:
        estimate: of this tick.
        solution: of this tick.
        tuning: of the filter.
        wheel_nms: momentum of a driven wheel, body axes.
    """
    deviation, weights = _lacking(solution)
    if not deviation @ weights @ deviation > SIGMAS**2:
        return None
    _shift(estimate, deviation, np.zeros_like(estimate.covariance), tuning, wheel_nms)
    first = solution.causes.index(STRAY)
    one, two, three = solution.part[first : first + 3].tolist()
    return one, two, three


def settle(estimate: Estimate, coil: int, tuning: MekfConfig, wheel_nms: Vec3 = ZERO) -> None:
    """Correct the estimate for a stray current that certainly flows in this coil, and stop tracing it.

    Args:
        estimate: of this tick, with the trace of a stray current.
        coil: in which it flows.
        tuning: of the filter.
        wheel_nms: momentum of a driven wheel, body axes.

    Raises:
        ValueError: the estimate has no such trace.
    """
    traced = estimate.trace
    if traced is None or STRAY not in traced.numbers:
        raise ValueError("no stray current is traced")
    lacks = np.eye(3)[coil] - np.array([cause.assumed for cause in traced.causes[_places(traced)]])
    effect = traced.effect[:, _places(traced)][:, coil]
    _shift(estimate, lacks, MODEL_ERROR**2 * np.outer(effect, effect), tuning, wheel_nms)
    estimate.trace = _without_stray(estimate.trace or traced)


def _shift(
    estimate: Estimate, parts: Matrix, uncertainty: Matrix, tuning: MekfConfig, wheel_nms: Vec3
) -> None:
    """Correct the estimate by these further fractions of the current; the trace is of what then remains."""
    traced = estimate.trace or effects.empty_trace(estimate)
    flows = _places(traced)
    mekf.correct(estimate, traced.effect[:, flows] @ parts, uncertainty, tuning, wheel_nms)
    shift = np.eye(len(traced.sums))
    shift[flows, -1] = -parts  # the innovations less what these parts have done to them
    causes = list(traced.causes)
    causes[flows] = [
        Cause(cause.number, cause.assumed + part, cause.uncertain)
        for cause, part in zip(causes[flows], parts.tolist(), strict=True)
    ]
    sums = shift.T @ traced.sums @ shift
    estimate.trace = Trace(tuple(causes), traced.effect, sums, traced.measured)


def _without_stray(traced: Trace) -> Trace:
    others = [index for index, number in enumerate(traced.numbers) if number < STRAY]
    return effects.select(traced, others, traced.sums)


def conducting_coil(solution: Solution) -> int | None:
    """The coil in which a current flows without a request; None while it may be another, or none.

    The likeliest of the four explanations (p = 0, or 1 for one of the coils), if it fits and every other is
    less likely by ``SIGMAS``. No false alarm is at stake: a current certainly flows. The distance of each is
    the squared Mahalanobis distance from the solution, less the prior's share in it.
    """
    lacking, weights = _lacking(solution)
    if not len(lacking):
        return None
    first = solution.causes.index(STRAY)
    part = solution.part[first : first + 3]
    assumed = part - lacking
    distances = []
    for explanation in (*np.eye(3), np.zeros(3)):
        off, prior = explanation - part, explanation - assumed
        distances.append(float(off @ weights @ off - prior @ prior))
    least, second = sorted(distances)[:2]
    likeliest = distances.index(least)
    if likeliest == 3 or least > SIGMAS**2 or second - least < SIGMAS**2:
        return None
    return likeliest


def _lacking(solution: Solution) -> tuple[Matrix, Matrix]:
    """By coil, the fraction of the current that the filter lacks, and the weights; empty without one."""
    stray = [index for index, cause in enumerate(solution.causes) if cause >= STRAY]
    return solution.deviation[stray], np.asarray(np.linalg.inv(solution.noise(stray)), float)
