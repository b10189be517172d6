"""Which coil is faulty, by its current and by what its pulses do to the rate.

At the end of a pulse the current that is read back is held against that of the level. What pulses did to the
rate ``coil_rate`` solves for; and what a stray current does, one without a request: the supply, which all
coils share, does not show in which it flows.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import AXES, PulseConfig
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Mat3, Vec3, cross, scale, transform
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir import coil_isolation, coil_rate
from fsw.core.gate.readings import Readings
from fsw.wire.messages import CoilStatus


class CoilFault(IntEnum):
    """Faults of a coil, as reported on the bus."""

    OPEN = 1
    WEAK = 2
    REVERSED = 3
    STUCK = 4


HEALTHY = (0, 0, 0)


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak_part`` and ``open_part`` of the nominal current or torque are the most that is weak and open;
    ``name_pulses`` in a row with a wrong current isolate a coil, ``name_sigmas`` is the certainty that the
    rate has to give; a stray current means a stuck coil after ``stuck_ticks``.
    """

    current_ma: Vec3
    weak_part: float
    open_part: float
    name_pulses: int
    name_sigmas: float
    stuck_ma: float
    stuck_ticks: int
    inertia_inverse: Mat3


class CoilHealth(NamedTuple):
    """By coil: its fault (0: none) and pulses in a row with a wrong current.

    ``strange_ticks``: ticks in a row with a level or a current without a request, ``stray_ma``: a current
    without a level; ``stuck``: there is such a level, or such a current for too long.
    """

    faults: tuple[int, int, int] = HEALTHY
    wrong: tuple[int, int, int] = HEALTHY
    strange_ticks: int = 0
    stray_ma: int = 0
    stuck: bool = False

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*self.faults, *self.wrong, self.strange_ticks, self.stray_ma, self.stuck)


def driven_am2(health: CoilHealth, view: CoilView, timing: PulseConfig, config: CoilHealthConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, a stray current included if a coil is isolated for it.

    Args:
        health: of this tick.
        view: after what was received in this tick.
        timing: of the pulses.
        config: limits.
    """
    if not health.stray_ma or CoilFault.STUCK not in health.faults:
        return view.driven_am2
    return scale(_stray_am2(health, timing, config), AXES[health.faults.index(CoilFault.STUCK)])


def unattributed_torque(health: CoilHealth) -> bool:
    """Whether a stray current turns the satellite, and it is not isolated yet in which coil it flows."""
    return health.stuck and _flows_somewhere(health)


def _flows_somewhere(health: CoilHealth) -> bool:
    """Whether there is a stray current, and no coil is isolated for it."""
    return health.stray_ma != 0 and CoilFault.STUCK not in health.faults


def _stray_am2(health: CoilHealth, timing: PulseConfig, config: CoilHealthConfig) -> float:
    return health.stray_ma / config.current_ma[-1] * timing.levels_am2[-1]


def judge_current(
    health: CoilHealth,
    view: CoilView,
    readings: Readings,
    unasked: bool,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
) -> CoilHealth:
    """Compare what the coil driver reports with what was asked of it.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        readings: what was received.
        unasked: the driver reports a level that was not requested.
        tick: this one.
        timing: of the pulses.
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
    ended = tick == view.fired_tick + timing.pulse_ticks
    if not ended or not status.level or (status.coil, status.level) != fired:
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    kind = _kind(status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma), config)
    wrong = health.wrong[fired.coil] + 1 if kind else 0
    if wrong == health.wrong[fired.coil]:
        return health
    health = health._replace(wrong=_with(health.wrong, fired.coil, wrong))
    return _with_fault(health, fired.coil, kind) if wrong >= config.name_pulses else health


def _strange(health: CoilHealth, status: CoilStatus, unasked: bool, config: CoilHealthConfig) -> CoilHealth:
    """Something flows without a request: stuck if for longer than a pulse that began before a boot."""
    ticks = health.strange_ticks + 1
    lasts = ticks >= config.stuck_ticks
    stray_ma = 0 if status.level else status.current_ma
    health = health._replace(strange_ticks=ticks, stray_ma=stray_ma, stuck=unasked or lasts)
    return _with_fault(health, status.coil, CoilFault.STUCK) if unasked and lasts else health


def judge_rate(
    health: CoilHealth,
    view: CoilView,
    b_eci_t: Vec3,
    state: EstimatorState,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
    tuning: MekfConfig,
) -> tuple[CoilHealth, EstimatorState]:
    """Compare what the filter had to correct with what pulses, and a stray current, should have done.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        b_eci_t: field as modelled.
        state: of the estimator, after the samples of this tick.
        tick: this one.
        timing: of the pulses.
        config: limits.
        tuning: of the filter.

    Returns:
        The health, and the estimator, corrected where a coil certainly did something else than assumed.
    """
    estimate, age = state.estimate, tick - view.fired_tick
    ended = age == timing.pulse_ticks and view.driven_level != 0
    stray = _flows_somewhere(health)
    early = age % EARLY_TICKS == 0 and (state.rejected_in_a_row > 0 or stray)
    due = ended or early or age == timing.backoff_ticks
    if estimate is None or not (due or stray):
        return health, state
    if stray:
        kicks_radps = _stray_kicks(health, rotate(estimate.q_body_from_eci, b_eci_t), timing, config)
        begins = health.strange_ticks == 1
        estimate = coil_rate.trace_stray(estimate, kicks_radps, timing.tick_s, begins)
    if due:
        health, estimate = _isolate(health, estimate, config, tuning)
    if ended and (view.driven_coil, view.driven_level) == view.fired:
        b_body_t = rotate(estimate.q_body_from_eci, b_eci_t)
        kick_radps = transform(config.inertia_inverse, pulses.impulse(view.fired, b_body_t, timing))
        estimate = coil_rate.trace_pulse(estimate, view.fired.coil, kick_radps, timing.pulse_s)
    return health, state._replace(estimate=estimate)


EARLY_TICKS = 5
"""So often coils are judged while the filter refuses measurements or a stray current flows; else when the
next pulse is due."""


def _stray_kicks(health: CoilHealth, b_body_t: Vec3, timing: PulseConfig, config: CoilHealthConfig) -> Mat3:
    """What the stray current would do to the rate in a tick, by coil, rad/s."""
    m_am2 = _stray_am2(health, timing, config)
    first, second, third = (
        transform(config.inertia_inverse, scale(timing.tick_s * m_am2, cross(axis, b_body_t)))
        for axis in AXES
    )
    return first, second, third


def _isolate(
    health: CoilHealth, estimate: Estimate, config: CoilHealthConfig, tuning: MekfConfig
) -> tuple[CoilHealth, Estimate]:
    """With the coil isolated that did something else than assumed, if any, and the estimate corrected."""
    estimate, solution = coil_rate.solve(estimate, tuning)
    if solution is None:
        return health, estimate
    weak = coil_isolation.too_little(solution, config.weak_part, config.name_sigmas)
    if weak is not None:
        health = _with_fault(health, weak.coil, _kind(weak.part, config))
    conducting = coil_isolation.conducting(solution) if unattributed_torque(health) else None
    if conducting is None:
        return health, estimate
    health = _with_fault(health, conducting, CoilFault.STUCK)
    return health, coil_rate.settle_stray(estimate, conducting, tuning)


REVERSED_PART = -0.5


def _kind(part: float, config: CoilHealthConfig) -> int:
    """The fault of a coil that does this part of what it should; 0 if none."""
    if not part < config.weak_part:
        return 0
    if part < REVERSED_PART:
        return CoilFault.REVERSED
    return CoilFault.OPEN if part < config.open_part else CoilFault.WEAK


def _with_fault(health: CoilHealth, coil: int, kind: int) -> CoilHealth:
    """A coil keeps its first fault until the ground clears it, unless it is found stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return health
    return health._replace(faults=_with(health.faults, coil, kind))


def _with(three: tuple[int, int, int], index: int, value: int) -> tuple[int, int, int]:
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
