"""Each coil by its torque: what pulses and currents did, as the filter sees it, against what they should."""

from typing import Final, final

from fsw.core.actuation.actuator import CoilView
from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.coils import effects, explanations, stray
from fsw.core.fdir.coils.explanations import Solution
from fsw.core.fdir.coils.health import (
    NONE_OLDER,
    CoilHealth,
    CoilHealthConfig,
    has_unassigned_current,
    has_unassigned_torque,
    isolate_coil,
    stray_am2,
    with_item,
)
from fsw.core.fdir.coils.weak_test import Older
from fsw.core.fdir.faults import CoilFault, coil_fault
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference


@final
class BelievedParts:
    """How small the fraction of its effect has to be to count as a coil's own fault.

    ``by_pulses``: for the fraction that its latest pulses show, each by itself; ``by_gain``: for the one that
    the filter has estimated from all of them, together with whatever else they may show.
    """

    __slots__ = ("by_gain", "by_pulses")

    def __init__(self, by_pulses: float, by_gain: float) -> None:
        self.by_pulses = by_pulses
        self.by_gain = by_gain


def judge_effect(
    health: CoilHealth,
    view: CoilView,
    reference: Reference,
    state: EstimatorState,
    tick: int,
    believed: BelievedParts,
    unexplained: bool,
    config: CoilHealthConfig,
    wheel_nms: Vec3 = ZERO,
) -> None:
    """Compare what the filter had to correct with what pulses, and a stray current, should have done.

    The estimate is corrected where a coil certainly did other than assumed.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        reference: of the orbit, in this tick.
        state: of the estimator, after the samples of this tick.
        tick: this one.
        believed: the fractions of its effect below which the fault counts as a coil's own.
        unexplained: whether both sensors are in doubt.
        config: limits.
        wheel_nms: momentum of a driven wheel, body axes.
    """
    estimate, age, b_eci_t = state.estimate, tick - view.fired_tick, reference.b_eci_t
    as_asked = view.driven_level != 0 and view.as_fired
    ended = as_asked and age == config.pulses.pulse_ticks
    flows = has_unassigned_current(health)
    hurry = age % EARLY_TICKS == 0 and (unexplained or state.rejected_in_a_row > 0 or flows)
    due = ended or hurry or age == config.pulses.backoff_ticks
    if estimate is None or not (due or flows):
        return
    if flows:
        m_am2 = stray_am2(health, config)
        kicks_radps = stray.kicks_radps(m_am2, config.stray_axes, estimate, b_eci_t, config.mekf)
        begins = health.unrequested_ticks == 1
        stray.trace_current(estimate, health.stray_parts, kicks_radps, config.mekf.tick_s, begins)
    if due:
        _isolate(health, estimate, view.fired.coil if ended else None, believed, config, wheel_nms)
    if ended:
        gravity_ps2 = 3.0 * MU_M3PS2 / reference.radius_m**3
        effects.trace_pulse(estimate, view.fired, b_eci_t, gravity_ps2, config.pulses, config.mekf)


EARLY_TICKS: Final = 5
"""Interval while in doubt; otherwise when the next pulse is due: a correction ends what a pulse can show."""


def _isolate(
    health: CoilHealth,
    estimate: Estimate,
    ended: int | None,
    believed: BelievedParts,
    config: CoilHealthConfig,
    wheel_nms: Vec3,
) -> None:
    """Isolate the coil that did something other than assumed, if any, and correct the estimate.

    A pulse of the coil ``ended`` takes the place of its oldest one, whose evidence is kept.
    """
    weak = config.weak
    gain_nats, earlier = explanations.weigh_gains(estimate, config.mekf, weak), health.older
    trace = estimate.trace
    if trace is None:  # as after a retest, whose evidence waits for the first pulse
        first, second, third = earlier
        health.older = (Older(kept=first.kept), Older(kept=second.kept), Older(kept=third.kept))
        return
    solution = effects.solve(estimate, config.mekf, wheel_nms)
    if solution is None:
        if estimate.trace is None:
            health.older = NONE_OLDER
        return
    if ended is not None:
        oldest = explanations.oldest_pulse(solution, ended, weak)
        health.older = with_item(earlier, ended, earlier[ended].add(oldest).bound(weak))
    by_pulses = explanations.weak_by_pulses(solution, earlier, weak, believed.by_pulses)
    by_gain = explanations.weak_by_gain(estimate, gain_nats, weak)
    for found, most in ((by_pulses, believed.by_pulses), (by_gain, believed.by_gain)):
        if found is not None and found[1] < most and _are_others_sound(health, found[0], gain_nats):
            isolate_coil(health, found[0], coil_fault(found[1], weak.weak_part), config)
            break
    if has_unassigned_torque(health):
        _assign_torque(health, estimate, solution, config, wheel_nms)


def _assign_torque(
    health: CoilHealth,
    estimate: Estimate,
    solution: Solution,
    config: CoilHealthConfig,
    wheel_nms: Vec3,
) -> None:
    """Isolate the coil in which a stray current certainly flows, or take into account what is known of it."""
    coil = stray.conducting_coil(solution)
    if coil is not None:
        isolate_coil(health, coil, CoilFault.STUCK, config)
        stray.settle(estimate, coil, config.mekf, wheel_nms)
        return
    parts = stray.follow(estimate, solution, config.mekf, wheel_nms)
    if parts is not None:
        health.stray_parts = parts


def _are_others_sound(health: CoilHealth, coil: int, gain_nats: list[float]) -> bool:
    """Whether another coil is left, and none seems weak too: a wrong inertia makes all of them seem so."""
    left = [other for other, fault in enumerate(health.faults) if other != coil and not fault]
    return bool(left) and all(gain_nats[other] <= 0.0 for other in left)
