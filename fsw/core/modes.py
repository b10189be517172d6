"""The mode table: transitions with source, target, condition and dwell time.

Transitions of the current mode are checked in order; the first whose condition has held without a break for
its dwell time is taken. Hysteresis lies in the conditions: the limits to leave a mode are wider than those
to enter it.
"""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Final, final

from fsw.core.algebra.vector import norm
from fsw.core.estimation.attitude import Attitude
from fsw.wire.messages import Mode


class ModeCondition(IntEnum):
    """The conditions of the table, by their place among those of a tick."""

    TRIPPED = 0
    CLEAR = 1
    LOST_ATTITUDE = 2
    BLIND = 3
    SLOW = 4
    FAST = 5
    NEAR = 6
    FAR = 7


Conditions = tuple[bool, ...]
"""Which hold in a tick, by ``ModeCondition``."""


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition: taken when ``condition`` has held for the dwell of that name."""

    source: Mode
    target: Mode
    condition: ModeCondition
    dwell: str


TABLE: Final[tuple[Transition, ...]] = (
    Transition(Mode.SAFE, Mode.DETUMBLE, ModeCondition.CLEAR, "recover_s"),
    Transition(Mode.DETUMBLE, Mode.SAFE, ModeCondition.TRIPPED, "none_s"),
    Transition(Mode.DETUMBLE, Mode.SAFE, ModeCondition.BLIND, "lose_s"),
    Transition(Mode.DETUMBLE, Mode.ACQUIRE, ModeCondition.SLOW, "settle_s"),
    Transition(Mode.ACQUIRE, Mode.SAFE, ModeCondition.TRIPPED, "none_s"),
    Transition(Mode.ACQUIRE, Mode.DETUMBLE, ModeCondition.FAST, "settle_s"),
    Transition(Mode.ACQUIRE, Mode.DETUMBLE, ModeCondition.LOST_ATTITUDE, "lose_s"),
    Transition(Mode.ACQUIRE, Mode.POINT, ModeCondition.NEAR, "hold_s"),
    Transition(Mode.POINT, Mode.SAFE, ModeCondition.TRIPPED, "none_s"),
    Transition(Mode.POINT, Mode.DETUMBLE, ModeCondition.FAST, "settle_s"),
    Transition(Mode.POINT, Mode.DETUMBLE, ModeCondition.LOST_ATTITUDE, "lose_s"),
    Transition(Mode.POINT, Mode.ACQUIRE, ModeCondition.FAR, "hold_s"),
)

_ROWS_FROM: Final = {mode: [(i, row) for i, row in enumerate(TABLE) if row.source is mode] for mode in Mode}


@dataclass(frozen=True, slots=True)
class ModeConfig:
    """Thresholds, and dwell ticks by row of ``TABLE``.

    ``near_cosine`` and ``far_cosine`` are cosines of the angle from the nominal attitude; with ``axis_only``
    it is that of body axis 1 alone from the local vertical.
    """

    dwell_ticks: tuple[int, ...]
    slow_radps: float
    fast_radps: float
    near_cosine: float
    far_cosine: float
    axis_only: bool
    trips_to_stay_safe: int


@final
@dataclass(slots=True)
class ModeState:
    """The mode, since when, and since when each row's condition has held (-1: it does not).

    ``held``: the ground has commanded SAFE, and no transition leaves it.
    """

    mode: Mode = Mode.SAFE
    since_tick: int = 0
    held_since: list[int] = field(default_factory=lambda: [-1] * len(TABLE))
    trips: int = 0
    held: bool = False


def judge_conditions(
    attitude: Attitude,
    spin_radps: float,
    tripped: bool,
    can_act: bool,
    state: ModeState,
    config: ModeConfig,
) -> Conditions:
    """The conditions of the table at this tick, of the attitude that the laws count by.

    Rates are relative to the spin of the setpoint.

    ``can_act``: the magnetometer is not isolated, or the law needs no field; otherwise, and without an
    attitude, no law can act.
    """
    q0, q1, q2, q3 = attitude.q_body_from_orbit
    cosine = q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3 if config.axis_only else 2.0 * q0 * q0 - 1.0
    w1, w2, w3 = attitude.omega_body_orbit_radps
    rate = norm((w1 - spin_radps, w2, w3))
    usable = attitude.usable
    blind = not (usable or can_act)
    return (
        tripped,
        not (tripped or blind or state.held) and state.trips < config.trips_to_stay_safe,
        not usable,
        blind,
        usable and rate < config.slow_radps,
        usable and rate > config.fast_radps,
        usable and cosine > config.near_cosine,
        usable and cosine < config.far_cosine,
    )


def advance(state: ModeState, conditions: Conditions, tick: int, config: ModeConfig) -> None:
    """Take at most one transition in this tick; the dwell times restart in a new mode."""
    if conditions[ModeCondition.TRIPPED] and state.mode is not Mode.SAFE:
        state.trips += 1
    for index, row in _ROWS_FROM[state.mode]:
        if not conditions[row.condition]:
            state.held_since[index] = -1
            continue
        if state.held_since[index] < 0:
            state.held_since[index] = tick
        if tick - state.held_since[index] >= config.dwell_ticks[index]:
            enter(state, row.target, tick)
            return


def enter(state: ModeState, mode: Mode, tick: int) -> None:
    """Begin a mode: no condition has held in it yet, and a SAFE is not held."""
    state.mode, state.since_tick = mode, tick
    state.held_since = [-1] * len(TABLE)
    state.held = False


def request_mode(state: ModeState, mode: Mode, tick: int) -> None:
    """Begin the mode that the ground commands, if it is another; a commanded SAFE is held."""
    if mode is not state.mode:
        enter(state, mode, tick)
    state.held = mode is Mode.SAFE
