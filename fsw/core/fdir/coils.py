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
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, cross, scale, transform
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir import coil_effects, explanations
from fsw.core.fdir.evidence import weigh
from fsw.core.fdir.faults import CoilFault, coil_fault
from fsw.core.gate.readings import Readings
from fsw.wire.messages import CoilStatus


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak_part`` of the nominal current or torque is the most that is weak; evidence of ``threshold``, nats,
    isolates a coil; a stray current means a stuck coil after ``stuck_ticks``.
    """

    current_ma: Vec3
    weak_part: float
    threshold: float
    stuck_ma: float
    stuck_ticks: int
    pulses: PulseConfig
    mekf: MekfConfig


class CoilHealth(NamedTuple):
    """By coil: its fault (0: none) and what its currents, and pulses traced no longer, show against it, nats.

    ``strange_ticks``: ticks in a row with a level or a current without a request, ``stray_ma``: a current
    without a level; ``stuck``: there is such a level, or such a current for too long.
    """

    faults: tuple[int, int, int] = (0, 0, 0)
    nats: Vec3 = ZERO
    pulse_nats: Vec3 = ZERO
    strange_ticks: int = 0
    stray_ma: int = 0
    stuck: bool = False

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*self.faults, self.strange_ticks, self.stray_ma, self.stuck)

    def floats(self) -> tuple[float, ...]:
        """The evidence."""
        return (*self.nats, *self.pulse_nats)


def driven_am2(health: CoilHealth, view: CoilView, config: CoilHealthConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, a stray current included if a coil is isolated for it.

    Args:
        health: of this tick.
        view: after what was received in this tick.
        config: limits.
    """
    if not health.stray_ma or CoilFault.STUCK not in health.faults:
        return view.driven_am2
    return scale(_stray_am2(health, config), AXES[health.faults.index(CoilFault.STUCK)])


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
        health = health._replace(strange_ticks=0, stray_ma=0, stuck=False)
    fired = view.fired
    ended = tick == view.fired_tick + config.pulses.pulse_ticks
    if not ended or not status.level or (status.coil, status.level) != fired:
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    part = status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma)
    kind = coil_fault(part, config.weak_part)
    by = config.threshold / NAME_PULSES
    nats = weigh(health.nats[fired.coil], by if kind else -config.threshold, config.threshold)
    health = health._replace(nats=_with(health.nats, fired.coil, nats))
    return _with_fault(health, fired.coil, kind) if nats >= config.threshold else health


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
    stray = _flows_somewhere(health)
    hurry = age % EARLY_TICKS == 0 and (unexplained or state.rejected_in_a_row > 0 or stray)
    due = ended or hurry or age == config.pulses.backoff_ticks
    if estimate is None or not (due or stray):
        return health, state
    if stray:
        kicks_radps = _stray_kicks(health, rotate(estimate.q_body_from_eci, b_eci_t), config)
        begins = health.strange_ticks == 1
        estimate = coil_effects.trace_stray(estimate, kicks_radps, config.pulses.tick_s, begins)
    if due:
        health, estimate = _isolate(health, estimate, view.fired.coil if ended else None, sure, config)
    if ended and (view.driven_coil, view.driven_level) == view.fired:
        b_body_t = rotate(estimate.q_body_from_eci, b_eci_t)
        kick_radps = transform(
            config.mekf.rotor.inertia_inverse, pulses.impulse(view.fired, b_body_t, config.pulses)
        )
        estimate = coil_effects.trace_pulse(estimate, view.fired.coil, kick_radps, config.pulses.pulse_s)
    return health, state._replace(estimate=estimate)


EARLY_TICKS = 5
"""So often while in doubt; else when the next pulse is due: a correction ends what a pulse can still show."""


def _stray_kicks(health: CoilHealth, b_body_t: Vec3, config: CoilHealthConfig) -> Mat3:
    """What the stray current would do to the rate in a tick, by coil, rad/s."""
    m_am2 = _stray_am2(health, config)
    first, second, third = (
        transform(
            config.mekf.rotor.inertia_inverse, scale(config.pulses.tick_s * m_am2, cross(axis, b_body_t))
        )
        for axis in AXES
    )
    return first, second, third


def _isolate(
    health: CoilHealth, estimate: Estimate, ended: int | None, sure: bool, config: CoilHealthConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated that did something else than assumed, if any, and the estimate corrected.

    A pulse of the coil ``ended`` takes the place of its oldest one, whose evidence is kept.
    """
    weak = explanations.weak_by_gain(estimate, config.mekf, config.weak_part, config.threshold)
    estimate, solution = coil_effects.solve(estimate, config.mekf)
    if solution is not None:
        earlier = health.pulse_nats
        weak = explanations.weak_by_pulses(solution, earlier, config.weak_part, config.threshold) or weak
        if ended is not None and sure:
            oldest = explanations.of_oldest(solution, ended, config.weak_part, config.threshold)
            nats = weigh(earlier[ended], oldest, config.threshold)
            health = health._replace(pulse_nats=_with(earlier, ended, nats))
    if weak is not None and sure and _another_is_sound(health, weak[0]):
        health = _with_fault(health, weak[0], coil_fault(weak[1], config.weak_part))
    if solution is None or not unattributed_torque(health):
        return health, estimate
    conducting = explanations.conducting(solution)
    if conducting is None:
        return health, estimate
    health = _with_fault(health, conducting, CoilFault.STUCK)
    return health, coil_effects.settle_stray(estimate, conducting, config.mekf)


def _another_is_sound(health: CoilHealth, coil: int) -> bool:
    """Whether a coil is left: that all three fail is less likely than that the filter is wrong."""
    return any(not fault for other, fault in enumerate(health.faults) if other != coil)


def _with_fault(health: CoilHealth, coil: int, kind: int) -> CoilHealth:
    """A coil keeps its first fault until the ground clears it, unless it is found stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return health
    return health._replace(faults=_with(health.faults, coil, kind))


T = TypeVar("T", int, float)


def _with(three: tuple[T, T, T], index: int, value: T) -> tuple[T, T, T]:
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
