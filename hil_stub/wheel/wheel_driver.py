"""The board of a reaction wheel: frames in, frames and a motor torque out, guarded by its own rules."""

from enum import IntEnum
from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    Severity,
    WheelBoot,
    WheelEvent,
    WheelHeartbeat,
    WheelStatus,
    WheelStatusResult,
    WheelTorque,
    intact,
)
from hil_stub.node import Node
from hil_stub.wheel.wheel_guard import Asked, WheelLimits, judge, measured


class WheelEventCode(IntEnum):
    """``event`` of ``WHEEL_EVENT``."""

    OVER_SPEED = 1
    NO_SPEED = 2
    DEAD_MAN = 3


class WheelBoardState(IntEnum):
    """``state`` of ``WHEEL_HEARTBEAT``."""

    READY = 0
    DRIVEN = 1
    FAULT = 2


SEVERITY: Final = {
    WheelEventCode.OVER_SPEED: Severity.WARNING,
    WheelEventCode.NO_SPEED: Severity.ERROR,
    WheelEventCode.DEAD_MAN: Severity.ERROR,
}


class WheelDriver:
    """A board that drives the torque of one ``WHEEL_TORQUE``, in the tick of its reception and no longer.

    A request ends by itself: a tick without one is a tick in which the wheel coasts. In each tick:
    ``begin_tick``, then ``receive`` for each frame of the bus, then ``drive``. A request that comes after
    ``drive``, or before the first tick, answers no tick and is refused as one of a wrong tick. With a clock
    of its own the board ends a torque after a tick by that clock too, even if no next tick comes.

    Args:
        limits: what it enforces.
        table_crc: CRC-32 of the table that these values come from, reported in ``WHEEL_BOOT``.
    """

    def __init__(self, limits: WheelLimits, table_crc: int = 0) -> None:
        self._limits = limits
        self._node = Node(WheelBoot, WheelHeartbeat, limits.tick_hz, table_crc)
        self._answered: int | None = None  # the tick that requests may answer now
        self._taken_nm: float | None = None  # what the motor was set to in this tick
        self._torque_nm = 0.0  # driven now
        self._ends_ms: int | None = None
        self._result = WheelStatusResult.NONE
        self._speed_radps: float | None = None
        self._finding: WheelEventCode | None = None
        self._silenced = False
        self._statuses = self._events = 0
        self.rejects = 0
        """Frames that failed the gate since boot."""

    def begin_tick(self, tick: int, speed_radps: float, clock_ms: int | None = None) -> list[Frame]:
        """Enter ``tick``: the frames to send in it.

        At the first tick ``WHEEL_BOOT``; always one ``WHEEL_STATUS``; one ``WHEEL_EVENT`` for each new fault;
        every 60 s after boot ``WHEEL_HEARTBEAT``. A tick that does not advance is ignored.

        Args:
            tick: number of the tick that begins.
            speed_radps: measured speed of the wheel against the body at this tick.
            clock_ms: the board's own clock, if it has one [ms].
        """
        elapsed = self._node.advance(tick)
        if elapsed is None:
            return []
        driven_nm = self._taken_nm if elapsed == 1 else None
        self._speed_radps = measured(speed_radps)
        status = WheelStatus(
            int(self._speed_radps is not None),
            self._result if elapsed < 2 else WheelStatusResult.NONE,
            self._speed_radps or 0.0,
            driven_nm or 0.0,
            counter=self._statuses,
        )
        self._statuses += 1
        self._answered, self._taken_nm, self._result = tick, None, WheelStatusResult.NONE
        self._coast()
        frames = [*self._node.boot(), status.encode(), *self._found(tick)]
        return frames + self._node.heartbeat(self._state(driven_nm), self.rejects)

    def receive(self, frame: Frame, clock_ms: int | None = None) -> None:
        """Take a frame of the bus, whole or not at all; the first sound ``WHEEL_TORQUE`` of a tick is driven.

        A frame that fails the gate (unknown id, flags, length, CRC) is counted in ``rejects``.
        """
        if not intact(frame):
            self.rejects += 1
            if frame.can_id == WheelTorque.ID:
                self._result = WheelStatusResult.MALFORMED
            return
        if frame.can_id != WheelTorque.ID:
            return
        request = WheelTorque.decode(frame.data)
        taken = self._taken_nm is not None
        asked = Asked(request.torque, request.tick, self._answered, taken, self._speed_radps)
        self._result = judge(asked, self._limits)
        if self._result is WheelStatusResult.DRIVEN:
            self._taken_nm = self._torque_nm = request.torque
            self._ends_ms = None if clock_ms is None else clock_ms + self._limits.hold_ms

    def drive(self) -> float:
        """The motor torque over the tick that has begun [N m]; ends the time for requests that answer it."""
        self._answered = None
        return self._torque_nm

    def pass_time(self, clock_ms: int | None) -> None:
        """The board's own clock reads ``clock_ms``; None: it has none. A torque that is over ends."""
        if clock_ms is not None and self._ends_ms is not None and clock_ms >= self._ends_ms:
            self._coast()

    def silence(self) -> None:
        """The dead-man: no ``SYNC`` for too long. The wheel coasts; reported in the next tick."""
        self._coast()
        self._answered, self._silenced = None, True

    def _coast(self) -> None:
        self._torque_nm, self._ends_ms = 0.0, None

    def _found(self, tick: int) -> list[Frame]:
        """The events of this tick: each fault once, when it is found."""
        found = [WheelEventCode.DEAD_MAN] if self._silenced else []
        self._silenced = False
        before, self._finding = self._finding, self._fault()
        if self._finding is not None and self._finding is not before:
            found.append(self._finding)
        frames = []
        for code in found:
            speed = round(self._speed_radps or 0.0)
            frames.append(WheelEvent(SEVERITY[code], code, tick, speed, counter=self._events).encode())
            self._events += 1
        return frames

    def _fault(self) -> WheelEventCode | None:
        if self._speed_radps is None:
            return WheelEventCode.NO_SPEED
        too_fast = abs(self._speed_radps) > self._limits.max_speed_radps
        return WheelEventCode.OVER_SPEED if too_fast else None

    def _state(self, driven_nm: float | None) -> WheelBoardState:
        if self._finding is WheelEventCode.NO_SPEED:
            return WheelBoardState.FAULT
        return WheelBoardState.DRIVEN if driven_nm else WheelBoardState.READY
