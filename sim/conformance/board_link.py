"""A link to one board: speaks to it as plant and flight software would, and records its replies."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    AnyMessage,
    CoilBoot,
    CoilHeartbeat,
    CoilRefused,
    CoilStatus,
    MagBoot,
    MagField,
    MagHeartbeat,
    PlantBoot,
    SunBoot,
    SunCells,
    SunHeartbeat,
    SunVector,
    Sync,
    TickDone,
    intact,
)
from sim.errors import HarnessError

LATE_PART = 0.1
"""Part of a tick by which this computer may be late; after a longer delay the ticks count on from there."""


class NonconformanceError(Exception):
    """The board does not do what the specification demands; the message is one sentence."""


class BoardKind(NamedTuple):
    """The messages of a kind of board; ``sample`` is the one that it sends exactly once a tick."""

    node: str
    boot: type[CoilBoot] | type[MagBoot] | type[SunBoot]
    sample: type[CoilStatus] | type[MagField] | type[SunVector] | type[SunCells]
    heartbeat: type[CoilHeartbeat] | type[MagHeartbeat] | type[SunHeartbeat]


BOARD_KINDS = {
    "coil": BoardKind("COIL", CoilBoot, CoilStatus, CoilHeartbeat),
    "magnetometer": BoardKind("MAG", MagBoot, MagField, MagHeartbeat),
    "sun": BoardKind("SUN", SunBoot, SunVector, SunHeartbeat),
    "cells": BoardKind("SUN", SunBoot, SunCells, SunHeartbeat),
}


@dataclass
class TickReply:
    """What the board sends in a tick.

    Args:
        tick: the tick.
        at_s: when the SYNC of the tick before was due.
        due: the board has to answer with exactly one sample.
        messages: all its intact messages.
        broken: frames under its identifiers that are not intact.
    """

    tick: int
    at_s: float
    due: bool
    messages: list[AnyMessage] = field(default_factory=list)
    broken: list[Frame] = field(default_factory=list)

    def only(self, kind: type[AnyMessage]) -> list[AnyMessage]:
        """The messages of a kind."""
        return [message for message in self.messages if isinstance(message, kind)]

    @property
    def status(self) -> CoilStatus:
        """The COIL_STATUS of the tick.

        Raises:
            NonconformanceError: there is none.
        """
        for message in self.messages:
            if isinstance(message, CoilStatus):
                return message
        raise NonconformanceError(f"no COIL_STATUS of tick {self.tick}")

    @property
    def refused(self) -> list[CoilRefused]:
        """The refusals in the tick."""
        return [message for message in self.messages if isinstance(message, CoilRefused)]


class BoardLink:
    """The bus with one board on it, driven tick by tick.

    Args:
        bus: with the board on it; nothing else may send SYNC there.
        kind: of the board.
        tick_hz: ticks a second.
        clock: seconds on a clock that never runs back, as ``bus.receive`` counts its timeouts.
        watch: called in each tick.
    """

    def __init__(
        self,
        bus: Bus,
        kind: BoardKind,
        tick_hz: int,
        clock: Callable[[], float] = time.monotonic,
        watch: Callable[[], None] = lambda: None,
    ) -> None:
        self._bus = bus
        self.kind = kind
        self.tick_hz = tick_hz
        self.period_s = 1.0 / tick_hz
        self.clock = clock
        self._watch = watch
        self._due_s = clock()
        self._epoch_unix_s = 1_700_000_000
        self._boots = 0
        self.tick = 0
        """The tick whose SYNC comes next; the board is in it."""
        self.put_off_s = 0.0
        """By how much ticks came later than the rate says, in sum."""
        self.replies: list[TickReply] = []
        """All replies so far."""

    def step(self, *frames: Frame, early_s: float | None = None, late_s: float = 0.0) -> TickReply:
        """Send SYNC of this tick, ``frames`` and TICK_DONE; return what the board sends until the next tick.

        With ``early_s`` the next tick comes that long after the answer, and not when it is due; it is due by
        ``late_s`` later than the rate says.
        """
        tick, self.tick = self.tick, self.tick + 1
        at_s = self.due_s()
        sync = Sync(tick, self._epoch_unix_s + tick // self.tick_hz).encode()
        self._bus.send([sync, *frames, TickDone(tick, 0).encode()])
        return self._listen(tick + 1, at_s, self.period_s + late_s, due=True, early_s=early_s)

    def sync(self, tick: int, seconds: float | None = None, frames: Sequence[Frame] = ()) -> TickReply:
        """Send a SYNC of any tick, no TICK_DONE, and listen for so long; None: for the time of a tick."""
        at_s = self.due_s()
        self._bus.send([Sync(tick, self._epoch_unix_s).encode(), *frames])
        return self._listen(tick, at_s, self.period_s if seconds is None else seconds)

    def restart(self) -> TickReply:
        """Send PLANT_BOOT, which restarts a board in a later tick than 0, and listen for a tick."""
        self.tick = 0
        at_s = self.clock()
        self._bus.send([PlantBoot(0, 1, 0, counter=self._boots).encode()])
        self._boots += 1
        self._due_s = at_s
        return self._listen(0, at_s, self.period_s)

    def silence(self, seconds: float) -> TickReply:
        """Send nothing for a while: what the board sends all the same."""
        self._due_s = at_s = self.clock()
        return self._listen(self.tick, at_s, seconds)

    def due_s(self) -> float:
        """When the next SYNC is due, by the clock; if that is too long ago, it is now.

        So a tick in which this computer was busy does not take from the next one's time for an answer.
        """
        if self._late():
            self._put_off(self.clock())
        return self._due_s

    def _listen(
        self, tick: int, at_s: float, seconds: float, due: bool = False, early_s: float | None = None
    ) -> TickReply:
        self._watch()
        self._due_s += seconds
        reply = TickReply(tick, at_s, due)
        self._receive(reply, early_s)
        if self._late():  # this computer was busy, and perhaps the board's link with it
            self._put_off(self.clock() + LATE_PART * self.period_s)
            self._receive(reply)
        self.replies.append(reply)
        return reply

    def _receive(self, reply: TickReply, early_s: float | None = None) -> None:
        """Take what comes until the next SYNC is due, and what waits by then: it has come in time."""
        while (left_s := self._due_s - self.clock()) > -self.period_s:  # a board that babbles has no end
            frame = self._bus.receive(max(0.0, left_s))
            if frame is not None:
                self._take(frame, reply)
            elif left_s <= 0.0:
                return
            if early_s is not None and reply.only(self.kind.sample):
                self._due_s = min(self._due_s, self.clock() + early_s)

    def _late(self) -> bool:
        return self.clock() > self._due_s + LATE_PART * self.period_s

    def _put_off(self, due_s: float) -> None:
        self.put_off_s += due_s - self._due_s
        self._due_s = due_s

    def _take(self, frame: Frame, reply: TickReply) -> None:
        sender = SENDERS.get(frame.can_id)
        if sender == self.kind.node:
            if intact(frame):
                reply.messages.append(CLASSES[frame.can_id].decode(frame.data))
            else:
                reply.broken.append(frame)
        elif frame.can_id in (Sync.ID, TickDone.ID):
            raise HarnessError("another node sends SYNC or TICK_DONE on this bus: a board is tested alone")
