"""Each coil by its torque: what pulses and currents did, as the filter sees it, against what they should."""

from fsw.core.actuation.actuator import CoilView
from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.coils import effects, explanations, stray
from fsw.core.fdir.coils.explanations import Solution
from fsw.core.fdir.coils.health import (
    NONE_OLDER,
    CoilHealth,
    CoilHealthConfig,
    flows_somewhere,
    stray_am2,
    unattributed_torque,
    with_fault,
    with_item,
)
from fsw.core.fdir.faults import CoilFault, coil_fault


def judge_effect(
    health: CoilHealth,
    view: CoilView,
    b_eci_t: Vec3,
    state: EstimatorState,
    tick: int,
    believed_below: float,
    unexplained: bool,
    config: CoilHealthConfig,
) -> tuple[CoilHealth, EstimatorState]:
    """Compare what the filter had to correct with what pulses, and a stray current, should have done.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        b_eci_t: field as modelled.
        state: of the estimator, after the samples of this tick.
        tick: this one.
        believed_below: so small a part of its effect is believed to be a coil's own fault.
        unexplained: there is doubt about both sensors.
        config: limits.

    Returns:
        The health, and the estimator, corrected where a coil certainly did something else than assumed.
    """
    estimate, age = state.estimate, tick - view.fired_tick
    ended = age == config.pulses.pulse_ticks and view.driven_level != 0
    flows = flows_somewhere(health)
    hurry = age % EARLY_TICKS == 0 and (unexplained or state.rejected_in_a_row > 0 or flows)
    due = ended or hurry or age == config.pulses.backoff_ticks
    if estimate is None or not (due or flows):
        return health, state
    if flows:
        kicks_radps = stray.kicks_radps(stray_am2(health, config), estimate, b_eci_t, config.mekf)
        begins = health.strange_ticks == 1
        estimate = stray.trace(estimate, health.conducts, kicks_radps, config.mekf.tick_s, begins)
    if due:
        health, estimate = _isolate(
            health, estimate, view.fired.coil if ended else None, believed_below, config
        )
    if ended and (view.driven_coil, view.driven_level) == view.fired:
        estimate = effects.trace_pulse(estimate, view.fired, b_eci_t, config.pulses, config.mekf)
    return health, state._replace(estimate=estimate)


EARLY_TICKS = 5
"""So often while in doubt; else when the next pulse is due: a correction ends what a pulse can still show."""


def _isolate(
    health: CoilHealth, estimate: Estimate, ended: int | None, believed_below: float, config: CoilHealthConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated that did something else than assumed, if any, and the estimate corrected.

    A pulse of the coil ``ended`` takes the place of its oldest one, whose evidence is kept.
    """
    gain_nats, earlier = explanations.by_gain(estimate, config.mekf, config.weak), health.older
    estimate, solution = effects.solve(estimate, config.mekf)
    if solution is None:
        return (health if estimate.trace else health._replace(older=NONE_OLDER)), estimate
    weak = explanations.weak_by_pulses(solution, earlier, config.weak)
    weak = weak or explanations.weak_by_gain(estimate, gain_nats, config.weak)
    if ended is not None:
        oldest = explanations.of_oldest(solution, ended, config.weak)
        older = earlier[ended].with_pulses(oldest).bounded(config.weak)
        health = health._replace(older=with_item(earlier, ended, older))
    if weak is not None and weak[1] < believed_below and _others_are_sound(health, weak[0], gain_nats):
        health = with_fault(health, weak[0], coil_fault(weak[1], config.weak.weak_part), config)
    return (
        _attribute(health, estimate, solution, config) if unattributed_torque(health) else (health, estimate)
    )


def _attribute(
    health: CoilHealth, estimate: Estimate, solution: Solution, config: CoilHealthConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated in which a stray current certainly flows, or with what is known of it."""
    coil = stray.conducting(solution)
    if coil is not None:
        return with_fault(health, coil, CoilFault.STUCK, config), stray.settle(estimate, coil, config.mekf)
    followed = stray.follow(estimate, solution, config.mekf)
    if followed is None:
        return health, estimate
    estimate, conducts = followed
    return health._replace(conducts=conducts), estimate


def _others_are_sound(health: CoilHealth, coil: int, gain_nats: list[float]) -> bool:
    """Whether another is left, and none seems weak too: a wrong inertia makes all of them seem so."""
    left = [other for other, fault in enumerate(health.faults) if other != coil and not fault]
    return bool(left) and all(gain_nats[other] <= 0.0 for other in left)
