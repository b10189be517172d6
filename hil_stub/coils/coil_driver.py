"""The coil driver board: frames in, frames and a drive out, guarded by its own interlock."""

from enum import IntEnum
from typing import Final, final

from fsw.wire.frame import Frame, raw
from fsw.wire.messages import (
    CoilBoot,
    CoilFire,
    CoilHeartbeat,
    CoilRefusedReason,
    CoilStatus,
    intact,
)
from fsw.wire.value import Value
from hil_stub.coils.events import CoilEventCode, Events
from hil_stub.coils.guard import Guard
from hil_stub.coils.interlock import UNITS_PER_TICK, CoilLimits
from hil_stub.coils.read_back import ReadBack
from hil_stub.coils.refusals import MAX_REFUSALS, Refusals
from hil_stub.node import Node

__all__ = ["MAX_REFUSALS", "OFF", "BoardState", "CoilDriver", "CoilLimits", "Drive", "Pin"]

NAMED_BYTES: Final = 3
"""Bytes that a ``COIL_FIRE`` must have for its ``coil`` and ``seq`` to be read."""


class BoardState(IntEnum):
    """``state`` of ``COIL_HEARTBEAT``."""

    READY = 0
    ON = 1
    LOCKED_OUT = 2
    FAULT = 3


@final
class Drive(Value):
    """What is driven over a tick: ``level`` on ``coil``, from the tick's start for ``fraction`` of it."""

    FIELDS = ("coil", "level", "fraction")
    __slots__ = FIELDS

    def __init__(self, coil: int, level: int, fraction: float) -> None:
        self.coil = coil
        self.level = level
        self.fraction = fraction


OFF: Final = Drive(0, 0, 0.0)


@final
class Pin(Value):
    """The output that is on at this instant: ``level`` on ``coil``.

    ``until_ms``: when the board's own clock ends it, whatever is received by then; None: the board
    has no clock. A board arms a timer with it when the pulse begins, and needs nothing more to end it.
    """

    FIELDS = ("coil", "level", "until_ms")
    __slots__ = FIELDS

    def __init__(self, coil: int, level: int, until_ms: int | None) -> None:
        self.coil = coil
        self.level = level
        self.until_ms = until_ms


class CoilDriver:
    """A board that drives at most one coil at a time, and only as the interlock allows.

    In each tick: ``begin_tick``, then ``receive`` for each frame of the bus, then ``drive``. A request that
    comes after ``drive``, or before the first tick, answers no tick and is refused as one of a wrong tick.

    A board with a clock of its own gets the time with each of these, and by ``pass_time`` when no frame
    comes: then a pulse ends when the first of clock and ticks says so, a back-off when the last does.

    With a read-back the current is checked against what is driven. The first check after boot is the
    self-test: with all coils off no current flows. As long as one does, every request is refused.

    Args:
        limits: what the interlock enforces.
        read_back: nominal currents; None: the current is reported, and not judged.
    """

    def __init__(self, limits: CoilLimits, read_back: ReadBack | None = None) -> None:
        self._limits = limits
        self._read_back = read_back
        self._node = Node(CoilBoot, CoilHeartbeat, limits.tick_hz, limits.table_crc)
        self._guard = Guard(limits)
        self._answered: int | None = None  # the tick that requests may answer now
        self._refusals = Refusals()
        self._events = Events()
        self._statuses = 0
        self._silenced = False
        # coil and level that have been driven without a change (level 0: off), and for how many ticks
        self._held = (0, 0)
        self._held_ticks = 0
        self._tested = False
        self._finding: CoilEventCode | None = None
        self.rejects = 0
        """Frames that failed the gate since boot."""

    def begin_tick(self, tick: int, current_a: float, clock_ms: int | None = None) -> list[Frame]:
        """Enter ``tick``: the frames to send in it.

        At the first tick ``COIL_BOOT``; always one ``COIL_STATUS``; one ``COIL_REFUSED`` for each request
        refused since the last tick, at most 64; one ``COIL_EVENT`` for each new fault; every 60 s after boot
        ``COIL_HEARTBEAT``.

        A tick that does not advance is ignored: nothing happens and nothing is sent. Over skipped ticks a
        pulse ends by its own time and the lockout runs on.

        Args:
            tick: number of the tick that begins.
            current_a: read-back of the coil current at this tick [A].
            clock_ms: the board's own clock, if it has one [ms].
        """
        self._guard.pass_time(clock_ms)
        elapsed = self._node.advance(tick)
        if elapsed is None:
            return []
        self._guard.elapse(elapsed)
        self._answered = tick
        frames = self._node.boot()
        frames.append(self._status(tick, current_a))
        frames += self._refusals.take()
        frames += self._found(tick, elapsed, current_a)
        frames += self._node.heartbeat(self._board_state(), self.rejects)
        return frames

    def pass_time(self, clock_ms: int | None) -> None:
        """No frame has come, and the board's own clock reads ``clock_ms``; None: it has none."""
        self._guard.pass_time(clock_ms)

    def sync(self) -> None:
        """The ``SYNC`` of this tick: its status, sent in advance, holds now."""
        self._guard.sync()

    def silence(self, clock_ms: int | None = None) -> None:
        """The dead-man: no ``SYNC`` for too long. All off, and a full back-off that begins now.

        Called repeatedly while ``SYNC`` stays away. ``COIL_EVENT`` reports it in the next tick.
        """
        self._guard.pass_time(clock_ms)
        self._guard.silence()
        self._silenced = True

    def receive(self, frame: Frame, clock_ms: int | None = None) -> None:
        """Take a frame of the bus, whole or not at all; only ``COIL_FIRE`` matters.

        A frame that fails the gate (unknown id, flags, length, CRC) is counted in ``rejects``. If its id is
        that of ``COIL_FIRE`` and it is long enough to name a coil and a sequence number, it is also refused
        as malformed, with that coil and number.
        """
        self._guard.pass_time(clock_ms)
        if not intact(frame):
            self.rejects += 1
            if frame.can_id == CoilFire.ID and len(frame.data) >= NAMED_BYTES:
                self._refuse(CoilFire.decode(frame.data[: CoilFire.LENGTH]), CoilRefusedReason.MALFORMED)
            return
        if frame.can_id != CoilFire.ID:
            return
        fire = CoilFire.decode(frame.data)
        if self._shorted:
            self._refuse(fire, CoilRefusedReason.COIL_ON)
            return
        if self._answered is None:
            self._refuse(fire, CoilRefusedReason.WRONG_TICK)
            return
        reason = self._guard.ask(fire, self._answered)
        if reason is not None:
            self._refuse(fire, reason)
        else:  # a pulse may end before the next tick, in which all coils are off again
            self._held, self._held_ticks = (fire.coil, fire.level), 0

    def drive(self) -> Drive:
        """What is driven over the tick that has begun; ends the time for requests that answer it."""
        self._answered = None
        guard = self._guard
        return Drive(guard.coil, guard.level, guard.fraction) if guard.on else OFF

    @property
    def pin(self) -> Pin | None:
        """The coil that is on at the latest time given to the board; None: all coils are off."""
        guard = self._guard
        return Pin(guard.coil, guard.level, guard.ends_ms) if guard.drives else None

    @property
    def _shorted(self) -> bool:
        """A current flows that the board does not drive: a coil is on, whatever the interlock says."""
        return self._finding is CoilEventCode.CURRENT_WHILE_OFF

    def _found(self, tick: int, elapsed: int, current_a: float) -> list[Frame]:
        """The events of this tick."""
        frames = []
        if self._silenced:
            self._silenced = False
            frames.append(self._events.frame(CoilEventCode.DEAD_MAN, tick))
        guard, read_back = self._guard, self._read_back
        driven = (guard.coil, guard.level) if guard.on else (0, 0)
        if driven == self._held:
            self._held_ticks += elapsed
        else:  # a pulse ends, and may end within a tick
            self._held, self._held_ticks = driven, 0
        if read_back is None or self._held_ticks * UNITS_PER_TICK < self._limits.units(read_back.settle_ms):
            return frames
        level = guard.level if guard.on else 0
        before, self._finding = self._finding, read_back.judge(level, current_a)
        if self._finding is not None and self._finding is not before:
            code = self._finding if self._tested else CoilEventCode.SELF_TEST_FAILED
            frames.append(self._events.frame(code, tick, _milliamperes(current_a)))
        self._tested = True
        return frames

    def _status(self, tick: int, current_a: float) -> Frame:
        guard = self._guard
        coil = guard.coil if guard.level else tick % 3
        status = CoilStatus(
            level=guard.level,
            coil=coil,
            remaining_ms=guard.remaining_ms(),
            current_ma=_milliamperes(current_a),
            lockout_ms=guard.lockout_ms(coil),
            seq=guard.seq or 0,
            counter=self._statuses,
        )
        self._statuses += 1
        return status.encode()

    def _board_state(self) -> BoardState:
        if self._shorted:
            return BoardState.FAULT
        if self._guard.on:
            return BoardState.ON
        return BoardState.LOCKED_OUT if self._guard.locked_out else BoardState.READY

    def _refuse(self, fire: CoilFire, reason: CoilRefusedReason) -> None:
        self._refusals.add(fire.coil, fire.seq, reason, self._node.tick)


def _milliamperes(current_a: float) -> int:
    """Whole mA within 32 bits; what is not a number is the lowest. A narrower signal saturates by itself."""
    return raw(current_a, 0.001, -(2**31), 2**31 - 1)
