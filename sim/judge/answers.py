"""What a flight software has sent, tick by tick, from the log of its flight: boots, answers, requests."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.wire.frame import Frame, crc8
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    CoilDipole,
    CoilEvent,
    CoilFire,
    CoilRefused,
    CoilStatus,
    FswBoot,
    MagField,
    NavAttitude,
    Sync,
    TickDone,
    intact,
)
from sim.flight.second_senders import ONCE
from sim.record.candump import LogEntry

FROM_FSW = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
_SEALED = FROM_FSW - {TickDone.ID}


@dataclass(frozen=True, slots=True)
class CoilRequest:
    """A COIL_FIRE in answer to a tick, and what became of it: ``refused``, a reason or 0."""

    tick: int
    fire: CoilFire
    stuck: bool
    """The board had reported a current that it does not drive, and nothing better since."""
    refused: int = 0


class OutOfTurn(NamedTuple):
    """A message that is not where it belongs: after TICK_DONE of the tick, or a second time before it."""

    tick: int
    name: str
    late: bool


@dataclass(slots=True)
class AnswerRecord:
    """The record of the answers.

    Attributes:
        ticks: number of SYNC, each counted once.
        boots: ticks in which FSW_BOOT came; -1: before the first.
        answered_in: by tick, the tick in which its TICK_DONE came; -1: it did not.
        repeats: how often SYNC was repeated, by tick.
        odd_done: TICK_DONE of a tick that had not come, or had its answer: the tick in which it came, and the
            one it names.
        out_of_turn: messages after TICK_DONE, or twice in an answer; none of a SYNC that was repeated.
        broken: number of frames that are not whole, by message.
        first_broken: of each, the tick and the frame.
        counters: number of counters that do not rise by one, by message.
        requests: every COIL_FIRE that is whole.
        dipoles: number of COIL_DIPOLE.
        refused_dipoles: number of those that the board refused.
        estimates: number of ticks with a NAV_ATTITUDE.
        stuck_at: tick in which the coil board first reported a current that it does not drive; -1: never.
        state_crcs: number of TICK_DONE with a CRC of the state.
    """

    ticks: int = 0
    boots: list[int] = field(default_factory=list)
    answered_in: list[int] = field(default_factory=list)
    repeats: Counter[int] = field(default_factory=Counter)
    odd_done: list[tuple[int, int]] = field(default_factory=list)
    out_of_turn: list[OutOfTurn] = field(default_factory=list)
    broken: Counter[str] = field(default_factory=Counter)
    first_broken: dict[str, tuple[int, Frame]] = field(default_factory=dict)
    counters: Counter[str] = field(default_factory=Counter)
    requests: list[CoilRequest] = field(default_factory=list)
    dipoles: int = 0
    refused_dipoles: int = 0
    estimates: int = 0
    stuck_at: int = -1
    state_crcs: int = 0


MOST_ODD = 100


def tick_as_named(at: int, named: int) -> str:
    """A TICK_DONE that names another tick than the one that it answers, and what that seems to come of."""
    ways = {
        "the byte order is wrong, it is that tick with its bytes the other way round": named
        and _swapped(named) == at,
        "the one after it": named == at + 1,
        "the one before it": named == (at - 1) % 2**32,
        "the lowest byte of it alone": named == at & 0xFF,
        "the lowest two bytes of it alone": named == at & 0xFFFF,
        "always the first": not named,
    }
    why = next((f": {way}" for way, holds in ways.items() if holds), "")
    return f"TICK_DONE names tick {named} in the answer to tick {at}{why}"


def _swapped(tick: int) -> int:
    return int.from_bytes(tick.to_bytes(4, "little"), "big")


CURRENT_WHILE_OFF = 3
"""``event`` of COIL_EVENT; restated here, as in docs/icd.md."""
_STEP = 16


class _Reader:
    """Reads the log frame by frame."""

    def __init__(self, forged: bool) -> None:
        self.record = AnswerRecord()
        self._forged = forged
        self._open = False
        self._in_answer: set[str] = set()
        self._counter: dict[int, int] = {}
        self._stuck = False
        self._refusable: dict[tuple[int, int], int] = {}
        self._dipole_ticks: set[int] = set()
        self._estimated_at = -1

    @property
    def _tick(self) -> int:
        return self.record.ticks - 1

    def take(self, frame: Frame) -> None:
        """The next frame."""
        if frame.can_id in FROM_FSW:
            if self._open or not self._forged or self.record.ticks == 0:
                self._take_answer(frame)
        elif intact(frame):
            self._take_other(frame)

    def _take_other(self, frame: Frame) -> None:
        record = self.record
        if frame.can_id == Sync.ID:
            tick = Sync.decode(frame.data).tick
            if tick == record.ticks:
                self._open = True
                self._in_answer.clear()
                record.ticks += 1
                record.answered_in.append(-1)
            elif tick == self._tick:
                record.repeats[tick] += 1
        elif frame.can_id == CoilStatus.ID:
            status = CoilStatus.decode(frame.data)
            if self._stuck and not status.level and not status.current_ma:
                self._stuck = False
        elif frame.can_id == CoilEvent.ID and CoilEvent.decode(frame.data).event == CURRENT_WHILE_OFF:
            self._stuck = True
            if record.stuck_at < 0:
                record.stuck_at = self._tick + 1
        elif frame.can_id == CoilRefused.ID:
            self._take_refusal(CoilRefused.decode(frame.data))

    def _take_refusal(self, refused: CoilRefused) -> None:
        place = self._refusable.pop((refused.seq, refused.tick), None)
        if place is None:
            self.record.refused_dipoles += refused.tick in self._dipole_ticks
            return
        found = self.record.requests[place]
        self.record.requests[place] = replace(found, refused=refused.reason)

    def _take_answer(self, frame: Frame) -> None:
        record, name = self.record, NAMES[frame.can_id]
        if len(frame.data) != CLASSES[frame.can_id].LENGTH or (frame.can_id in _SEALED and not intact(frame)):
            record.broken[name] += 1
            record.first_broken.setdefault(name, (self._tick, frame))
            return
        if frame.can_id == TickDone.ID:
            self._take_done(TickDone.decode(frame.data))
            return
        self._take_counter(frame, name)
        self._take_turn(frame.can_id, name)
        if frame.can_id == FswBoot.ID:
            if record.boots and self._tick < 0:
                return  # asked for again
            record.boots.append(self._tick)
        elif frame.can_id == CoilFire.ID:
            self._take_request(CoilFire.decode(frame.data))
        elif frame.can_id == CoilDipole.ID:
            record.dipoles += 1
            self._dipole_ticks = {self._tick & 0xFF, self._tick - 1 & 0xFF}
        elif frame.can_id == NavAttitude.ID and self._estimated_at != self._tick:
            self._estimated_at = self._tick
            record.estimates += 1

    def _take_turn(self, can_id: int, name: str) -> None:
        record, late = self.record, not self._open
        if can_id == FswBoot.ID:
            self._in_answer.clear()
        elif record.ticks and self._tick not in record.repeats and len(record.out_of_turn) < MOST_ODD:
            if late or (can_id in ONCE and name in self._in_answer):
                record.out_of_turn.append(OutOfTurn(self._tick, name, late))
            self._in_answer.add(name)

    def _take_done(self, done: TickDone) -> None:
        record = self.record
        self._in_answer.clear()
        if 0 <= done.tick <= self._tick and record.answered_in[done.tick] < 0:
            self._open &= done.tick != self._tick
            record.answered_in[done.tick] = self._tick
            record.state_crcs += done.state_crc != 0
        elif self._open and done.tick not in record.repeats and len(record.odd_done) < MOST_ODD:
            record.odd_done.append((self._tick, done.tick))

    def _take_counter(self, frame: Frame, name: str) -> None:
        counter, last = frame.data[0] & 0xF, self._counter.get(frame.can_id)
        if frame.can_id == FswBoot.ID:
            self._counter.clear()
        elif last is not None and counter != (last + 1) % _STEP:
            self.record.counters[name] += 1
        self._counter[frame.can_id] = counter

    def _take_request(self, fire: CoilFire) -> None:
        self._refusable[fire.seq, self._tick & 0xFF] = len(self.record.requests)
        self.record.requests.append(CoilRequest(self._tick, fire, self._stuck))


def read_answers(entries: Iterable[LogEntry], forged: bool = False) -> AnswerRecord:
    """The record of a flight, from the entries of its log.

    Args:
        entries: the log.
        forged: a fault of the scenario sends under identifiers of the flight software, before SYNC: what
            comes between two answers is not its own.
    """
    reader = _Reader(forged)
    for entry in entries:
        reader.take(entry.frame)
    return reader.record


def field_samples(entries: Iterable[LogEntry], ticks: int) -> NDArray[np.int16]:
    """The numbers of MAG_FIELD by tick as they are on the bus, (n, 3); 0 where none came."""
    samples = np.zeros((ticks, 3), dtype=np.int16)
    tick = 0
    for entry in entries:
        frame = entry.frame
        if frame.can_id == Sync.ID and intact(frame):
            tick = Sync.decode(frame.data).tick + 1
        elif frame.can_id == MagField.ID and intact(frame) and tick < ticks:
            samples[tick] = np.frombuffer(frame.data[1:7], dtype="<i2")
    return samples


def crc_as_sent(frame: Frame) -> str:
    """How the CRC of a frame that is not whole seems to have been made, a clause; empty: unknown."""
    if not frame.data:
        return ""
    *_, found = frame.data
    body, number = frame.data[:-1], frame.can_id & 0x7FF
    ways = {
        "over the identifier low byte first": crc8(number.to_bytes(2, "little") + body),
        "over the data alone, without the identifier": crc8(body),
        "without the final XOR": crc8(number.to_bytes(2, "big") + body) ^ 0xFF,
        "from the initial value 0": crc8(number.to_bytes(2, "big") + body, 0x00),
    }
    return next((f"its CRC is made {way}" for way, crc in ways.items() if crc == found), "")
