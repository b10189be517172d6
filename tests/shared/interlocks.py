"""The interlock as a function: what becomes of a state, which itself stays as it is."""

from dataclasses import fields, replace
from typing import NamedTuple

from fsw.wire.messages import CoilFire, CoilRefusedReason
from hil_stub.coils import interlock
from hil_stub.coils.interlock import CoilLimits, Interlock


class Numbers(NamedTuple):
    """What a state holds, in its order: for searches, which look up where they have been."""

    coil: int
    level: int
    remaining: int
    lockout: tuple[int, int, int]
    seq: int | None


def numbers_of(state: Interlock) -> Numbers:
    return Numbers(state.coil, state.level, state.remaining, state.lockout, state.seq)


def after_ticks(state: Interlock, ticks: int) -> Interlock:
    after = replace(state)
    interlock.elapse(after, ticks)
    return after


def after_silence(state: Interlock, limits: CoilLimits) -> Interlock:
    after = replace(state)
    interlock.silence(after, limits)
    return after


def after_request(
    state: Interlock, request: CoilFire, tick: int, limits: CoilLimits
) -> tuple[Interlock, CoilRefusedReason | None]:
    """The state after a request as the guard makes it, and why it was refused (None: accepted)."""
    after = replace(state)
    reason = interlock.judge(after, request, tick, limits)
    if reason is None:
        interlock.accept(after, request, limits)
    return after, reason


def become(state: Interlock, other: Interlock) -> None:
    """Give a state what another holds: to plant a bug in what a function does to it."""
    for field in fields(state):
        setattr(state, field.name, getattr(other, field.name))
