"""The continuous driver board: drives all three coils at once, for one tick at a time."""

from enum import IntEnum
from typing import Final, final

from fsw.wire.frame import Frame, raw
from fsw.wire.messages import (
    CoilBoot,
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilHeartbeat,
    CoilRefusedReason,
    CoilStatus,
    intact,
)
from fsw.wire.value import Value
from hil_stub.coils.refusals import Refusals
from hil_stub.node import Node

Vec3 = tuple[float, float, float]

_READABLE_BYTES: Final = {CoilFire.ID: 3, CoilDipole.ID: 1}
"""Requests, and the bytes that hold their coil and number."""


class DipoleBoardState(IntEnum):
    """``state`` of ``COIL_HEARTBEAT``."""

    READY = 0
    ON = 1


@final
class DipoleDrive(Value):
    """What is driven over a tick, from its start for ``fraction`` of it.

    ``dipole`` is that of each coil, as a fraction of the full scale, -1 to 1.
    """

    FIELDS = ("dipole", "fraction")
    __slots__ = FIELDS

    def __init__(self, dipole: Vec3, fraction: float) -> None:
        self.dipole = dipole
        self.fraction = fraction


_NONE: Vec3 = (0.0, 0.0, 0.0)


class DipoleDriver:
    """A board that drives the dipole of one ``COIL_DIPOLE``, in the tick of its reception and no longer.

    A request ends by itself: a tick without one is a tick without drive. With ``on_fraction``
    below 1 the coils are off at the end of every tick, so that no current flows when the sensors sample.
    ``COIL_FIRE`` is refused.

    In each tick: ``begin_tick``, then ``receive`` for each frame of the bus, then ``drive``. A request that
    comes after ``drive``, or before the first tick, answers no tick and is refused as one of a wrong tick.

    Args:
        tick_hz: ticks a second.
        on_fraction: fraction of a tick for which the coils are driven, above 0 and up to 1.
        table_crc: CRC-32 of the table that these values come from, reported in ``COIL_BOOT``.

    Raises:
        ValueError: tick_hz is not a positive integer, or on_fraction out of range.
    """

    def __init__(self, tick_hz: int, on_fraction: float = 0.8, table_crc: int = 0) -> None:
        if not 0.0 < on_fraction <= 1.0:
            raise ValueError(f"on_fraction must be above 0 and not above 1, not {on_fraction!r}")
        self._node = Node(CoilBoot, CoilHeartbeat, tick_hz, table_crc)
        self._on_fraction = on_fraction
        self._open = False  # whether a request may be taken
        self._taken = False  # whether one has been taken in this tick
        self._dipole = _NONE
        self._refusals = Refusals()
        self._statuses = 0
        self.rejects = 0
        """Frames that failed the gate since boot."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """Enter ``tick``: the frames to send in it.

        At the first tick ``COIL_BOOT``; always one ``COIL_STATUS``, of coils that are off, and one
        ``COIL_DIPOLE_STATUS``; one ``COIL_REFUSED`` for each request refused since the last tick, at most 64;
        every 60 s after boot ``COIL_HEARTBEAT``. A tick that does not advance is ignored.

        Args:
            tick: number of the tick that begins.
            current_a: read-back of the coil current at this tick [A].
        """
        elapsed = self._node.advance(tick)
        if elapsed is None:
            return []
        driven = self._dipole if elapsed == 1 else _NONE
        self._dipole, self._taken, self._open = _NONE, False, True
        frames = self._node.boot()
        frames += self._status(tick, current_a, driven)
        frames += self._refusals.take()
        frames += self._node.heartbeat(
            DipoleBoardState.READY if driven == _NONE else DipoleBoardState.ON, self.rejects
        )
        return frames

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus, whole or not at all; the first ``COIL_DIPOLE`` of a tick is driven.

        A frame that fails the gate (unknown id, flags, length, CRC) is counted in ``rejects``. If its id is
        that of a request and it holds coil and number, it is also refused as malformed.
        """
        readable = len(frame.data) >= _READABLE_BYTES.get(frame.can_id, len(frame.data) + 1)
        if not intact(frame):
            self.rejects += 1
            if readable:
                self._refuse(frame, CoilRefusedReason.MALFORMED)
        elif frame.can_id == CoilFire.ID:
            self._refuse(frame, CoilRefusedReason.WRONG_BOARD)
        elif frame.can_id == CoilDipole.ID:
            self._take_request(frame)

    def drive(self) -> DipoleDrive:
        """What is driven over the tick that has begun; ends the time for requests that answer it."""
        self._open = False
        return DipoleDrive(self._dipole, self._on_fraction)

    def _take_request(self, frame: Frame) -> None:
        if not self._open:
            self._refuse(frame, CoilRefusedReason.WRONG_TICK)
        elif self._taken:
            self._refuse(frame, CoilRefusedReason.SECOND_DIPOLE)
        else:
            request = CoilDipole.decode(frame.data)
            self._dipole, self._taken = (request.m_x, request.m_y, request.m_z), True

    def _status(self, tick: int, current_a: float, driven: Vec3) -> list[Frame]:
        off = CoilStatus(
            level=0,
            coil=tick % 3,
            remaining_ms=0,
            current_ma=raw(current_a, 0.001, -2048, 2047),
            lockout_ms=0,
            seq=0,
            counter=self._statuses,
        )
        x, y, z = driven
        on = CoilDipoleStatus(x, y, z, counter=self._statuses)
        self._statuses += 1
        return [off.encode(), on.encode()]

    def _refuse(self, frame: Frame, reason: CoilRefusedReason) -> None:
        coil, seq = 0, 0
        if frame.can_id == CoilFire.ID:
            fire = CoilFire.decode(frame.data[: CoilFire.LENGTH])
            coil, seq = fire.coil, fire.seq
        else:
            seq = CoilDipole.decode(frame.data[: CoilDipole.LENGTH]).counter
        self._refusals.add(coil, seq, reason, self._node.tick)
