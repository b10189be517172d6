"""Detects second senders on the bus of a flight: frames under identifiers that have one sender by contract.

No node receives its own frames. A frame that the plant receives under its own identifier, or under that of a
board in its process, is from a second sender. A frame under an identifier of the flight software is, if the
flight software cannot have sent it: a second TICK_DONE of one tick, a FSW_BOOT in flight, and in lockstep a
frame outside an answer or a second one in it.

Only intact frames count: corrupt ones are noise. Identifiers of the ground and unassigned ones are free.
Frames of a scenario's faults are sent by the plant itself, which does not receive them.
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
    NavParameter,
    NavQuality,
    NavRate,
    Sync,
    TickDone,
    WheelTorque,
    intact,
)
from sim.record.run_record import SenderRecord

WITH_BOARDS = frozenset({"PLANT", "COIL", "MAG", "SUN", "WHEEL"})
"""Senders in the plant's process where the boards are part of the plant."""
ALONE = frozenset({"PLANT"})
"""The same where the boards are nodes of their own."""

_FROM_FSW = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
ONCE = frozenset(
    {
        CoilFire.ID,
        CoilDipole.ID,
        WheelTorque.ID,
        NavAttitude.ID,
        NavRate.ID,
        NavQuality.ID,
        NavParameter.ID,
        FswHeartbeat.ID,
    }
)
"""Messages that an answer of the flight software contains at most once."""


class SecondSenderFrames(NamedTuple):
    """Frames of a second sender under one identifier: their number, and the tick of the first."""

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
    """Looks for second senders in the frames that the plant receives, tick by tick.

    Args:
        lockstep: the plant waits for each answer, so that the flight software is silent between answers.
        own: senders in this process.
        may_boot: a FSW_BOOT in flight is a restart of the flight software, which is judged elsewhere.
    """

    def __init__(self, lockstep: bool, own: frozenset[str] = WITH_BOARDS, may_boot: bool = False) -> None:
        self._lockstep = lockstep
        self._may_boot = may_boot
        self._own = frozenset(can_id for can_id, sender in SENDERS.items() if sender in own)
        self._done = self._again = -1
        self._found: dict[int, SecondSenderFrames] = {}

    @property
    def found(self) -> list[SecondSenderFrames]:
        """All second senders so far, by their first frame."""
        return list(self._found.values())

    def take(self, tick: int, before: list[Frame], answers: list[Frame], again: bool = False) -> bool:
        """Examine a tick; whether a second sender was found under a new identifier.

        Args:
            tick: of the SYNC that the plant has sent.
            before: frames received between the last tick and that SYNC.
            answers: frames received after it.
            again: SYNC was repeated in this tick, and each may be answered.
        """
        if again:
            self._again = tick
        received = [frame for frame in (*before, *answers) if intact(frame)]
        from_fsw = [frame for frame in received if frame.can_id in _FROM_FSW]
        strange = (
            [(frame.can_id, tick) for frame in received if frame.can_id in self._own]
            if len(from_fsw) < len(received)
            else []
        )
        if Sync.ID not in self._found and not any(can_id == Sync.ID for can_id, _ in strange):
            # otherwise the flight software may have answered a SYNC that was not the plant's
            early = sum([frame.can_id in _FROM_FSW for frame in before if intact(frame)])
            strange += (
                self._in_lockstep(tick, from_fsw, early) if self._lockstep else self._in_time(tick, from_fsw)
            )
        before_count = len(self._found)
        for can_id, when in strange:
            first = self._found.get(can_id, SecondSenderFrames(can_id, when, 0))
            self._found[can_id] = first._replace(frames=first.frames + 1)
        return len(self._found) > before_count

    def _in_lockstep(self, tick: int, from_fsw: list[Frame], early: int) -> list[tuple[int, int]]:
        """Each answer ends with its TICK_DONE; ``early`` frames came before SYNC."""
        strange: list[tuple[int, int]] = []
        answer: list[tuple[int, Frame]] = []
        for place, frame in enumerate(from_fsw):
            if frame.can_id == TickDone.ID and self._surplus(tick, frame):
                if TickDone.decode(frame.data).tick != self._again:
                    strange.append((TickDone.ID, _tick_of_surplus(tick, frame)))
                answer.clear()  # answered before: which of the two answers is false cannot be determined
            else:
                answer.append((place, frame))
        sent: set[int] = set()
        for place, frame in answer:
            can_id = frame.can_id
            if can_id == FswBoot.ID and self._may_boot:
                sent.clear()
                continue
            if can_id == FswBoot.ID:
                is_strange = tick > 0 or can_id in sent  # in tick 0 it may have been requested twice
            else:
                is_strange = place < early or (can_id in ONCE and can_id in sent)
            if is_strange:
                strange.append((can_id, tick))
            else:
                sent.add(can_id)
        return strange

    def _in_time(self, tick: int, from_fsw: list[Frame]) -> list[tuple[int, int]]:
        """In real time an answer may be late: a tick that ends twice, or too soon, shows a second sender."""
        strange = []
        for frame in from_fsw:
            if frame.can_id == TickDone.ID and self._surplus(tick, frame):
                strange.append((TickDone.ID, _tick_of_surplus(tick, frame)))
            elif frame.can_id == FswBoot.ID and tick > 0 and not self._may_boot:
                strange.append((FswBoot.ID, tick))
        return strange

    def _surplus(self, tick: int, frame: Frame) -> bool:
        """Whether the tick of a TICK_DONE was answered before, or has not begun."""
        done = TickDone.decode(frame.data).tick
        if self._done < done <= tick:
            self._done = done
            return False
        return True


def _tick_of_surplus(tick: int, frame: Frame) -> int:
    """The tick that a surplus TICK_DONE belongs to: the one before, whose answer it repeats, or this one."""
    done = TickDone.decode(frame.data).tick
    return done if done == tick - 1 else tick


def describe_senders(senders: Sequence[SenderRecord]) -> str:
    """A clause on the second senders that run.json lists."""
    senders_text = [
        f"{one['message']} ({one['id']}) from tick {one['tick']} on"
        if one["frames"] > 1
        else f"{one['message']} ({one['id']}) at tick {one['tick']}"
        for one in senders
    ]
    return f"a second sender is on the bus: {', '.join(senders_text)}"
