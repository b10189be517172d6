"""Which coil is faulty, by its current and by what its pulses do to the rate.

At the end of a pulse the current that is read back is held against that of the level. What pulses, and a
current without a request, did to the rate ``coil_effects`` solves for: the supply is that of all coils.
"""

from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import AXES, PulseConfig
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, scale, transform
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir import coil_effects, explanations, stray
from fsw.core.fdir.evidence import weigh
from fsw.core.fdir.explanations import Solution, WeakTest
from fsw.core.fdir.faults import CoilFault, coil_fault
from fsw.core.gate.readings import Readings
from fsw.wire.messages import CoilStatus


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak`` tells a weak coil from a sound one; a stray current means a stuck coil after ``stuck_ticks``.
    """

    current_ma: Vec3
    weak: WeakTest
    stuck_ma: float
    stuck_ticks: int
    pulses: PulseConfig
    mekf: MekfConfig


class CoilHealth(NamedTuple):
    """By coil: its fault (0: none) and what its currents, and pulses traced no longer, show against it, nats.

    ``strange_ticks``: ticks in a row with a level or a current without a request, ``stray_ma``: a current
    without a level; ``stuck``: there is such a level, or such a current for too long; ``conducts``: by coil,
    which part of such a current the filter takes into account.
    """

    faults: tuple[int, int, int] = (0, 0, 0)
    nats: Vec3 = ZERO
    pulse_nats: Vec3 = ZERO
    strange_ticks: int = 0
    stray_ma: int = 0
    stuck: bool = False
    conducts: Vec3 = ZERO

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*self.faults, self.strange_ticks, self.stray_ma, self.stuck)

    def floats(self) -> tuple[float, ...]:
        """The evidence, and the parts of a stray current."""
        return (*self.nats, *self.pulse_nats, *self.conducts)


def driven_am2(health: CoilHealth, view: CoilView, config: CoilHealthConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, with what is known of a stray current.

    Args:
        health: of this tick.
        view: after what was received in this tick.
        config: limits.
    """
    stuck = CoilFault.STUCK in health.faults
    conducts = AXES[health.faults.index(CoilFault.STUCK)] if stuck else health.conducts
    if not health.stray_ma or conducts == ZERO:
        return view.driven_am2
    return scale(_stray_am2(health, config), conducts)


def unattributed_torque(health: CoilHealth) -> bool:
    """Whether a stray current turns the satellite, and it is not isolated yet in which coil it flows."""
    return health.stuck and _flows_somewhere(health)


def _flows_somewhere(health: CoilHealth) -> bool:
    """Whether there is a stray current, and no coil is isolated for it."""
    return health.stray_ma != 0 and CoilFault.STUCK not in health.faults


def _stray_am2(health: CoilHealth, config: CoilHealthConfig) -> float:
    return health.stray_ma / config.current_ma[-1] * config.pulses.levels_am2[-1]


def judge_current(
    health: CoilHealth,
    view: CoilView,
    readings: Readings,
    unasked: bool,
    tick: int,
    config: CoilHealthConfig,
) -> CoilHealth:
    """Compare what the coil driver reports with what was asked of it.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        readings: what was received.
        unasked: the driver reports a level that was not requested.
        tick: this one.
        config: limits.
    """
    status = readings.coil
    if status is None:
        return health
    if unasked or (status.level == 0 and abs(status.current_ma) > config.stuck_ma):
        return _strange(health, status, unasked, config)
    if health.strange_ticks:
        health = health._replace(strange_ticks=0, stray_ma=0, stuck=False, conducts=ZERO)
    fired = view.fired
    ended = tick == view.fired_tick + config.pulses.pulse_ticks
    if not ended or not status.level or (status.coil, status.level) != fired:
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    part = status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma)
    kind, threshold = coil_fault(part, config.weak.weak_part), config.weak.threshold
    nats = weigh(health.nats[fired.coil], threshold / NAME_PULSES if kind else -threshold, threshold)
    health = health._replace(nats=_with(health.nats, fired.coil, nats))
    return _with_fault(health, fired.coil, kind) if nats >= threshold else health


NAME_PULSES = 2
"""A reading of the current cannot be doubted, but may be of another moment: so many isolate a coil."""


def _strange(health: CoilHealth, status: CoilStatus, unasked: bool, config: CoilHealthConfig) -> CoilHealth:
    """Something flows without a request: stuck if for longer than a pulse that began before a boot."""
    ticks = health.strange_ticks + 1
    lasts = ticks >= config.stuck_ticks
    stray_ma = 0 if status.level else status.current_ma
    health = health._replace(strange_ticks=ticks, stray_ma=stray_ma, stuck=unasked or lasts)
    return _with_fault(health, status.coil, CoilFault.STUCK) if unasked and lasts else health


def judge_effect(
    health: CoilHealth,
    view: CoilView,
    b_eci_t: Vec3,
    state: EstimatorState,
    tick: int,
    sure: bool,
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
        sure: nothing but a coil may be what the filter corrected.
        unexplained: there is doubt about both sensors.
        config: limits.

    Returns:
        The health, and the estimator, corrected where a coil certainly did something else than assumed.
    """
    estimate, age = state.estimate, tick - view.fired_tick
    ended = age == config.pulses.pulse_ticks and view.driven_level != 0
    flows = _flows_somewhere(health)
    hurry = age % EARLY_TICKS == 0 and (unexplained or state.rejected_in_a_row > 0 or flows)
    due = ended or hurry or age == config.pulses.backoff_ticks
    if estimate is None or not (due or flows):
        return health, state
    if flows:
        kicks_radps = stray.kicks_radps(_stray_am2(health, config), estimate, b_eci_t, config.mekf)
        begins = health.strange_ticks == 1
        estimate = stray.trace(estimate, health.conducts, kicks_radps, config.mekf.tick_s, begins)
    if due:
        health, estimate = _isolate(health, estimate, view.fired.coil if ended else None, sure, config)
    if ended and (view.driven_coil, view.driven_level) == view.fired:
        impulse_nms = pulses.impulse(view.fired, rotate(estimate.q_body_from_eci, b_eci_t), config.pulses)
        kick_radps = transform(config.mekf.rotor.inertia_inverse, impulse_nms)
        estimate = coil_effects.trace_pulse(estimate, view.fired.coil, kick_radps, config.pulses.pulse_s)
    return health, state._replace(estimate=estimate)


EARLY_TICKS = 5
"""So often while in doubt; else when the next pulse is due: a correction ends what a pulse can still show."""


def _isolate(
    health: CoilHealth, estimate: Estimate, ended: int | None, sure: bool, config: CoilHealthConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated that did something else than assumed, if any, and the estimate corrected.

    A pulse of the coil ``ended`` takes the place of its oldest one, whose evidence is kept.
    """
    gain_nats = explanations.by_gain(estimate, config.mekf, config.weak)
    weak = explanations.weak_by_gain(estimate, gain_nats, config.weak)
    estimate, solution = coil_effects.solve(estimate, config.mekf)
    if solution is not None:
        earlier = health.pulse_nats
        weak = explanations.weak_by_pulses(solution, earlier, config.weak) or weak
        if ended is not None:
            oldest = explanations.of_oldest(solution, ended, config.weak)
            nats = weigh(earlier[ended], oldest, config.weak.threshold)
            health = health._replace(pulse_nats=_with(earlier, ended, nats))
    if weak is not None and sure and _others_are_sound(health, weak[0], gain_nats):
        health = _with_fault(health, weak[0], coil_fault(weak[1], config.weak.weak_part))
    if solution is None or not unattributed_torque(health):
        return health, estimate
    return _attribute(health, estimate, solution, config)


def _attribute(
    health: CoilHealth, estimate: Estimate, solution: Solution, config: CoilHealthConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated in which a stray current certainly flows, or with what is known of it."""
    coil = stray.conducting(solution)
    if coil is not None:
        return _with_fault(health, coil, CoilFault.STUCK), stray.settle(estimate, coil, config.mekf)
    followed = stray.follow(estimate, solution, config.mekf)
    if followed is None:
        return health, estimate
    estimate, conducts = followed
    return health._replace(conducts=conducts), estimate


def _others_are_sound(health: CoilHealth, coil: int, gain_nats: list[float]) -> bool:
    """Whether another is left, and none seems weak too: a wrong inertia makes all of them seem so."""
    left = [other for other, fault in enumerate(health.faults) if other != coil and not fault]
    return bool(left) and all(gain_nats[other] <= 0.0 for other in left)


def _with_fault(health: CoilHealth, coil: int, kind: int) -> CoilHealth:
    """A coil keeps its first fault until the ground clears it, unless it is found stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return health
    return health._replace(faults=_with(health.faults, coil, kind))


T = TypeVar("T", int, float)


def _with(three: tuple[T, T, T], index: int, value: T) -> tuple[T, T, T]:
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
