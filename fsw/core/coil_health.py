"""Which coil is faulty, told by its current and by what its pulses do to the rate.

At the end of a pulse the current that is read back is held against that of the level. All coils share the
supply: a current that nobody asked for is a coil's only if it has not ceased since the coil's pulse. What
pulses did to the rate ``coil_rate`` solves for.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from fsw.core import coil_rate, pulses
from fsw.core.actuation import CoilView
from fsw.core.estimator import EstimatorState
from fsw.core.mekf_config import MekfConfig
from fsw.core.pulses import PulseConfig
from fsw.core.quaternion import rotate
from fsw.core.readings import Readings
from fsw.core.vector import Mat3, Vec3, transform


class CoilFault(IntEnum):
    """What is wrong with a coil, as named on the bus."""

    OPEN = 1
    WEAK = 2
    REVERSED = 3
    STUCK = 4


HEALTHY = (0, 0, 0)


@dataclass(frozen=True, slots=True)
class CoilHealthConfig:
    """Current of each level and limits.

    ``weak_part`` and ``open_part`` of the nominal current or torque are the most that is weak and open;
    ``name_pulses`` in a row with a wrong current name a coil, ``name_sigmas`` is the certainty that the rate
    has to give; a current that nobody asked for is stuck after ``stuck_ticks``.
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

    ``strange_ticks``: ticks in a row with a level or current that nobody asked for, ``strange_coil``: whose,
    -1 where nothing tells; ``stuck``: the level is there, or the current for too long.
    """

    faults: tuple[int, int, int] = HEALTHY
    wrong: tuple[int, int, int] = HEALTHY
    strange_ticks: int = 0
    strange_coil: int = -1
    stuck: bool = False


def judge_current(
    health: CoilHealth,
    view: CoilView,
    readings: Readings,
    unasked: bool,
    tick: int,
    timing: PulseConfig,
    config: CoilHealthConfig,
) -> CoilHealth:
    """Hold what the coil driver says against what was asked of it.

    Args:
        health: of the tick before.
        view: after what was heard in this tick.
        readings: what was heard.
        unasked: the driver tells of a level that was not asked for.
        tick: this one.
        timing: of the pulses.
        config: limits.
    """
    status = readings.coil
    if status is None:
        return health
    if unasked or (status.level == 0 and abs(status.current_ma) > config.stuck_ma):
        return _strange(health, status.coil if unasked else _just_ended(view, tick, timing), unasked, config)
    if health.strange_ticks:
        health = health._replace(strange_ticks=0, strange_coil=-1, stuck=False)
    fired = view.fired
    if tick != view.fired_tick + timing.pulse_ticks or (status.coil, status.level) != fired:
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    kind = _kind(status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma), config)
    wrong = health.wrong[fired.coil] + 1 if kind else 0
    if wrong == health.wrong[fired.coil]:
        return health
    health = health._replace(wrong=_with(health.wrong, fired.coil, wrong))
    return _named(health, fired.coil, kind) if wrong >= config.name_pulses else health


def _just_ended(view: CoilView, tick: int, timing: PulseConfig) -> int:
    """The coil whose pulse has ended so lately that its current may not have ceased since; -1: none."""
    since = tick - view.fired_tick - timing.pulse_ticks
    return view.fired.coil if view.fired.level and since <= CEASED_TICKS else -1


CEASED_TICKS = 2
"""After a pulse, by then a status has told of no current; one of two may be lost."""


def _strange(health: CoilHealth, coil: int, unasked: bool, config: CoilHealthConfig) -> CoilHealth:
    """Something flows unasked: stuck when for longer than a pulse that an earlier boot may have begun."""
    ticks = health.strange_ticks + 1
    lasts = ticks >= config.stuck_ticks
    whose = coil if unasked or ticks == 1 else health.strange_coil
    health = health._replace(strange_ticks=ticks, strange_coil=whose, stuck=unasked or lasts)
    named = ticks == config.stuck_ticks and whose >= 0
    return _named(health, whose, CoilFault.STUCK) if named else health


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
    """Hold what the filter had to correct after pulses against what these should have done.

    Args:
        health: of the tick before.
        view: after what was heard in this tick.
        b_eci_t: field as modelled.
        state: of the estimator, after the samples of this tick.
        tick: this one.
        timing: of the pulses.
        config: limits.
        tuning: of the filter.

    Returns:
        The health, and the estimator, set right where a pulse was certainly not what it was taken for.
    """
    known, age = state.estimate, tick - view.fired_tick
    ended = age == timing.pulse_ticks and view.driven_level != 0
    due = age == timing.backoff_ticks or (state.rejected_in_a_row > 0 and age % REFUSED_TICKS == 0)
    if known is None or not (ended or due):
        return health, state
    known, accused = coil_rate.judge(known, config.weak_part, config.name_sigmas, tuning)
    if accused is not None:
        health = _named(health, accused.coil, _kind(accused.part, config))
    if ended and (view.driven_coil, view.driven_level) == view.fired:
        b_body_t = rotate(known.q_body_from_eci, b_eci_t)
        kick_radps = transform(config.inertia_inverse, pulses.impulse(view.fired, b_body_t, timing))
        known = coil_rate.begin(known, view.fired.coil, kick_radps, timing.pulse_s)
    return health, state._replace(estimate=known)


REFUSED_TICKS = 5
"""So often pulses are judged while the filter refuses measurements; else when the next one is due."""
REVERSED_PART = -0.5


def _kind(part: float, config: CoilHealthConfig) -> int:
    """The fault of a coil that does this part of what it should; 0 if none."""
    if not part < config.weak_part:
        return 0
    if part < REVERSED_PART:
        return CoilFault.REVERSED
    return CoilFault.OPEN if part < config.open_part else CoilFault.WEAK


def _named(health: CoilHealth, coil: int, kind: int) -> CoilHealth:
    """A coil's first fault is kept until the ground clears it, but for one that is stuck."""
    if health.faults[coil] and kind != CoilFault.STUCK:
        return health
    return health._replace(faults=_with(health.faults, coil, kind))


def _with(three: tuple[int, int, int], index: int, value: int) -> tuple[int, int, int]:
    a, b, c = three
    return ((value, b, c), (a, value, c), (a, b, value))[index]
