"""The mode table: transitions with source, target, condition and dwell time.

Transitions of the current mode are checked in order; the first whose condition has held without a break for
its dwell time is taken. Hysteresis lies in the conditions: the limits to leave a mode are wider than those
to enter it.
"""

from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.algebra.vector import norm
from fsw.core.estimation.attitude import Attitude
from fsw.wire.messages import Mode


class ModeConditions(NamedTuple):
    """The conditions of the table, evaluated once a tick."""

    tripped: bool
    clear: bool
    lost_attitude: bool
    blind: bool
    slow: bool
    fast: bool
    near: bool
    far: bool


class Transition(NamedTuple):
    """A transition: taken when ``condition`` has held for the dwell of that name."""

    source: Mode
    target: Mode
    condition: str
    dwell: str


TABLE: tuple[Transition, ...] = (
    Transition(Mode.SAFE, Mode.DETUMBLE, "clear", "recover_s"),
    Transition(Mode.DETUMBLE, Mode.SAFE, "tripped", "none_s"),
    Transition(Mode.DETUMBLE, Mode.SAFE, "blind", "lose_s"),
    Transition(Mode.DETUMBLE, Mode.ACQUIRE, "slow", "settle_s"),
    Transition(Mode.ACQUIRE, Mode.SAFE, "tripped", "none_s"),
    Transition(Mode.ACQUIRE, Mode.DETUMBLE, "fast", "settle_s"),
    Transition(Mode.ACQUIRE, Mode.DETUMBLE, "lost_attitude", "lose_s"),
    Transition(Mode.ACQUIRE, Mode.POINT, "near", "hold_s"),
    Transition(Mode.POINT, Mode.SAFE, "tripped", "none_s"),
    Transition(Mode.POINT, Mode.DETUMBLE, "fast", "settle_s"),
    Transition(Mode.POINT, Mode.DETUMBLE, "lost_attitude", "lose_s"),
    Transition(Mode.POINT, Mode.ACQUIRE, "far", "hold_s"),
)

_ROWS_FROM = {mode: [(i, row) for i, row in enumerate(TABLE) if row.source is mode] for mode in Mode}


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


class ModeState(NamedTuple):
    """The mode, since when, and since when each row's condition has held (-1: it does not).

    ``held``: the ground has commanded SAFE, and no transition leaves it.
    """

    mode: Mode = Mode.SAFE
    since_tick: int = 0
    held_since: tuple[int, ...] = (-1,) * len(TABLE)
    trips: int = 0
    held: bool = False


def judge(
    attitude: Attitude,
    spin_radps: float,
    tripped: bool,
    can_act: bool,
    state: ModeState,
    config: ModeConfig,
) -> ModeConditions:
    """The conditions of the table at this tick; rates are relative to the spin of the setpoint.

    ``can_act``: the magnetometer is not isolated, or the law needs no field; otherwise, and without an
    attitude, no law can act.
    """
    q0, q1, q2, q3 = attitude.q_body_from_orbit
    cosine = q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3 if config.axis_only else 2.0 * q0 * q0 - 1.0
    w1, w2, w3 = attitude.omega_body_orbit_radps
    rate = norm((w1 - spin_radps, w2, w3))
    valid = attitude.valid
    blind = not (valid or can_act)
    return ModeConditions(
        tripped=tripped,
        clear=not (tripped or blind or state.held) and state.trips < config.trips_to_stay_safe,
        lost_attitude=not valid,
        blind=blind,
        slow=valid and rate < config.slow_radps,
        fast=valid and rate > config.fast_radps,
        near=valid and cosine > config.near_cosine,
        far=valid and cosine < config.far_cosine,
    )


def advance(state: ModeState, situation: ModeConditions, tick: int, config: ModeConfig) -> ModeState:
    """The mode after this tick. At most one transition a tick; the dwell times restart in a new mode."""
    held = [-1] * len(TABLE)
    trips = state.trips + (situation.tripped and state.mode is not Mode.SAFE)
    for index, row in _ROWS_FROM[state.mode]:
        if not getattr(situation, row.condition):
            continue
        held[index] = state.held_since[index]
        if held[index] < 0:
            held[index] = tick
        if tick - held[index] >= config.dwell_ticks[index]:
            return ModeState(row.target, tick, (-1,) * len(TABLE), trips)
    if trips == state.trips and held == list(state.held_since):
        return state
    return ModeState(state.mode, state.since_tick, tuple(held), trips, state.held)


def request_mode(state: ModeState, mode: Mode, tick: int) -> ModeState:
    """The mode that the ground commands; a commanded SAFE is held."""
    held = mode is Mode.SAFE
    if mode is state.mode:
        return state._replace(held=held)
    return ModeState(mode, tick, trips=state.trips, held=held)
