"""The coil driver board: frames in, frames and a drive out, guarded by its own interlock."""

from enum import IntEnum
from typing import NamedTuple

from fsw.wire.frame import Frame, raw
from fsw.wire.messages import (
    CoilBoot,
    CoilFire,
    CoilHeartbeat,
    CoilRefusedReason,
    CoilStatus,
    intact,
)
from hil_stub.interlock import UNITS_PER_TICK, CoilLimits, Interlock, Request, ask, boot, elapse
from hil_stub.node import Node
from hil_stub.refusals import MAX_REFUSALS, Refusals

__all__ = ["MAX_REFUSALS", "OFF", "BoardState", "CoilDriver", "CoilLimits", "Drive"]

NAMED_BYTES = 3
"""Bytes that a ``COIL_FIRE`` must have for its ``coil`` and ``seq`` to be read."""


class BoardState(IntEnum):
    """``state`` of ``COIL_HEARTBEAT``."""

    READY = 0
    ON = 1
    LOCKED_OUT = 2


class Drive(NamedTuple):
    """What is driven over a tick: ``level`` on ``coil``, from the tick's start for ``fraction`` of it."""

    coil: int
    level: int
    fraction: float


OFF = Drive(0, 0, 0.0)


class CoilDriver:
    """A board that drives at most one coil at a time, and only as the interlock allows.

    In each tick: ``begin_tick``, then ``receive`` for each frame of the bus, then ``drive``. A request that
    comes after ``drive``, or before the first tick, answers no tick and is refused as one of a wrong tick.

    Args:
        limits: what the interlock enforces.
    """

    def __init__(self, limits: CoilLimits) -> None:
        self._limits = limits
        self._node = Node(CoilBoot, CoilHeartbeat, limits.tick_hz, limits.table_crc)
        self._state: Interlock = boot(limits)
        self._answered: int | None = None  # the tick that requests may answer now
        self._refusals = Refusals()
        self._statuses = 0
        self.rejects = 0
        """Frames that failed the gate since boot."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """Enter ``tick`` and say what is to be said in it.

        At the first tick ``COIL_BOOT``; always one ``COIL_STATUS``; one ``COIL_REFUSED`` for each request
        refused since the last tick, at most 64; every 60 s after boot ``COIL_HEARTBEAT``.

        A tick that does not rise is ignored: nothing happens and nothing is sent. Over skipped ticks a pulse
        ends by its own time and the lockout runs on.

        Args:
            tick: number of the tick that begins.
            current_a: read-back of the coil current at this tick [A].
        """
        elapsed = self._node.advance(tick)
        if elapsed is None:
            return []
        self._state = elapse(self._state, elapsed)
        self._answered = tick
        frames = self._node.boot()
        frames.append(self._status(tick, current_a))
        frames += self._refusals.take()
        frames += self._node.heartbeat(self._board_state(), self.rejects)
        return frames

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus, whole or not at all; only ``COIL_FIRE`` matters.

        A frame that fails the gate (unknown id, flags, length, CRC) is counted in ``rejects``. If its id is
        that of ``COIL_FIRE`` and it is long enough to name a coil and a sequence number, it is also refused
        as malformed, under the names that it bears.
        """
        if not intact(frame):
            self.rejects += 1
            if frame.can_id == CoilFire.ID and len(frame.data) >= NAMED_BYTES:
                self._refuse(CoilFire.decode(frame.data[: CoilFire.LENGTH]), CoilRefusedReason.MALFORMED)
            return
        if frame.can_id != CoilFire.ID:
            return
        fire = CoilFire.decode(frame.data)
        if self._answered is None:
            self._refuse(fire, CoilRefusedReason.WRONG_TICK)
            return
        request = Request(fire.coil, fire.level, fire.duration_ms, fire.seq, fire.tick)
        self._state, reason = ask(self._state, request, self._answered, self._limits)
        if reason is not None:
            self._refuse(fire, reason)

    def drive(self) -> Drive:
        """What is driven over the tick that has begun; ends the time for requests that answer it."""
        self._answered = None
        state = self._state
        if state.remaining == 0:
            return OFF
        return Drive(state.coil, state.level, min(state.remaining, UNITS_PER_TICK) / UNITS_PER_TICK)

    def _status(self, tick: int, current_a: float) -> Frame:
        state = self._state
        coil = state.coil if state.level else tick % 3
        status = CoilStatus(
            level=state.level,
            coil=coil,
            remaining_ms=self._limits.milliseconds(state.remaining),
            current_ma=raw(current_a, 0.001, -2048, 2047),
            lockout_ms=self._limits.milliseconds(state.lockout[coil], 10),
            seq=state.seq or 0,
            counter=self._statuses,
        )
        self._statuses += 1
        return status.encode()

    def _board_state(self) -> BoardState:
        if self._state.remaining:
            return BoardState.ON
        return BoardState.LOCKED_OUT if any(self._state.lockout) else BoardState.READY

    def _refuse(self, fire: CoilFire, reason: CoilRefusedReason) -> None:
        self._refusals.add(fire.coil, fire.seq, reason, self._node.tick)
