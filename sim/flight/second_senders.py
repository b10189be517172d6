"""Who else speaks on the bus of a flight: frames under identifiers whose only sender is known.

No node hears what it sends itself. What comes to the plant under an identifier of the plant, or of a board
that lives in the plant's process, is another's. Under an identifier of the flight software it is another's
where the flight software cannot have sent it: a second TICK_DONE of one tick, a FSW_BOOT in flight, and in
lockstep what stands outside an answer or in it twice.

Only whole frames count: broken ones are noise. Identifiers of the ground and of nobody are free. Faults that
a scenario asks for are sent by the plant itself, which does not hear them.
"""

from collections.abc import Sequence
from typing import NamedTuple

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    NAMES,
    SENDERS,
    CoilDipole,
    CoilFire,
    FswBoot,
    FswHeartbeat,
    NavAttitude,
    NavQuality,
    NavRate,
    Sync,
    TickDone,
    intact,
)
from sim.record.run_record import SenderRecord

WITH_BOARDS = frozenset({"PLANT", "COIL", "MAG", "SUN"})
"""Senders that live in the plant's process where the boards are its own."""
ALONE = frozenset({"PLANT"})
"""The same where the boards are nodes of the bus."""

_ONCE = frozenset({CoilFire.ID, CoilDipole.ID, NavAttitude.ID, NavRate.ID, NavQuality.ID, FswHeartbeat.ID})
"""What the flight software sends once in an answer, if at all."""


class SecondSender(NamedTuple):
    """Frames of another under one identifier: how many, and the tick of the first."""

    can_id: int
    tick: int
    frames: int

    def as_json(self) -> SenderRecord:
        """As it stands in run.json and summary.json."""
        return {
            "message": NAMES[self.can_id],
            "id": f"{self.can_id:03X}",
            "tick": self.tick,
            "frames": self.frames,
        }


class SenderWatch:
    """Takes what the plant hears, tick by tick.

    Args:
        lockstep: the plant waits for each answer, so that the flight software is silent between two of them.
        own: senders that live in this process.
    """

    def __init__(self, lockstep: bool, own: frozenset[str] = WITH_BOARDS) -> None:
        self._lockstep = lockstep
        self._own = frozenset(can_id for can_id, sender in SENDERS.items() if sender in own)
        self._done = self._again = -1
        self._found: dict[int, SecondSender] = {}

    @property
    def found(self) -> list[SecondSender]:
        """All second senders so far, by their first frame."""
        return list(self._found.values())

    def take(self, tick: int, before: list[Frame], answers: list[Frame], again: bool = False) -> bool:
        """Judge a tick: whether an identifier is new among those of a second sender.

        Args:
            tick: of the SYNC that the plant has sent.
            before: what came to it before that since the last tick.
            answers: what came after.
            again: SYNC has been sent more than once, and may be answered as often.
        """
        if again:
            self._again = tick
        heard = [frame for frame in before + answers if intact(frame)]
        strange = [(frame.can_id, tick) for frame in heard if frame.can_id in self._own]
        told = [frame for frame in heard if SENDERS[frame.can_id] == "FSW"]
        if Sync.ID not in self._found and all(can_id != Sync.ID for can_id, _ in strange):
            # else the flight software has answered a SYNC that was not the plant's: nothing tells whose
            early = sum(SENDERS[frame.can_id] == "FSW" for frame in before if intact(frame))
            strange += self._in_lockstep(tick, told, early) if self._lockstep else self._in_time(tick, told)
        known = len(self._found)
        for can_id, when in strange:
            first = self._found.get(can_id, SecondSender(can_id, when, 0))
            self._found[can_id] = first._replace(frames=first.frames + 1)
        return len(self._found) > known

    def _in_lockstep(self, tick: int, told: list[Frame], early: int) -> list[tuple[int, int]]:
        """Each answer ends with its TICK_DONE; ``early`` frames came while none was asked for."""
        strange: list[tuple[int, int]] = []
        answer: list[tuple[int, Frame]] = []
        for place, frame in enumerate(told):
            if frame.can_id == TickDone.ID and self._surplus(tick, frame):
                if TickDone.decode(frame.data).tick != self._again:
                    strange.append((TickDone.ID, _named(tick, frame)))
                answer.clear()  # it was answered before: by whom, nothing tells
            else:
                answer.append((place, frame))
        seen: set[int] = set()
        for place, frame in answer:
            can_id = frame.can_id
            if can_id == FswBoot.ID:
                is_strange = tick > 0 or can_id in seen  # in tick 0 it may have been asked for twice
            else:
                is_strange = place < early or (can_id in _ONCE and can_id in seen)
            if is_strange:
                strange.append((can_id, tick))
            else:
                seen.add(can_id)
        return strange

    def _in_time(self, tick: int, told: list[Frame]) -> list[tuple[int, int]]:
        """In real time an answer may come late: a tick that ends twice, or too soon, gives another away."""
        strange = []
        for frame in told:
            if frame.can_id == TickDone.ID and self._surplus(tick, frame):
                strange.append((TickDone.ID, _named(tick, frame)))
            elif frame.can_id == FswBoot.ID and tick > 0:
                strange.append((FswBoot.ID, tick))
        return strange

    def _surplus(self, tick: int, frame: Frame) -> bool:
        """Whether the tick that a TICK_DONE names has been answered before, or has not begun."""
        done = TickDone.decode(frame.data).tick
        if self._done < done <= tick:
            self._done = done
            return False
        return True


def _named(tick: int, frame: Frame) -> int:
    """The tick that a surplus TICK_DONE belongs to: the one before, whose answer it repeats, or this one."""
    done = TickDone.decode(frame.data).tick
    return done if done == tick - 1 else tick


def said(senders: Sequence[SenderRecord]) -> str:
    """Second senders, as they stand in run.json, in a clause for people."""
    named = [
        f"{one['message']} ({one['id']}) from tick {one['tick']} on"
        if one["frames"] > 1
        else f"{one['message']} ({one['id']}) at tick {one['tick']}"
        for one in senders
    ]
    return f"a second sender is on the bus: {', '.join(named)}"
