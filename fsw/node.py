"""The flight node: collects frames into inboxes and runs a step at each SYNC. No I/O of its own."""

from enum import Enum, auto
from typing import Self

from fsw.core.config import FlightConfig
from fsw.core.packing import copy_state
from fsw.core.state import FlightState, Inbox
from fsw.core.step import boot, step, takes_inbox
from fsw.core.telemetry import boot_frame
from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, Sync, intact

MOST_INBOX_FRAMES = 1024
"""Frames stored between two answers: bounds memory under a flood, far above what the gate reads."""

NO_PLANT_S = 2.0
"""After this long without an answered SYNC, a PLANT_BOOT is from a plant that waits for FSW_BOOT."""

TICKS_MODULO = 1 << 24
"""PLANT_END counts ticks modulo this."""


class End(Enum):
    """Whether the run is over."""

    NO = auto()
    DOUBTED = auto()
    """PLANT_END names a tick slightly ahead: the run is over if silence follows."""
    YES = auto()


class FlightNode:
    """The flight software as a node of the bus: frames in, frames out."""

    def __init__(self, config: FlightConfig) -> None:
        self.config = config
        self.state: FlightState = boot(config)
        self.end = End.NO
        self._inbox: list[Frame] = []

    def start(self) -> Frame:
        """FSW_BOOT, the first frame this node sends: a flight begins, and earlier frames do not count."""
        self.state, self.end = boot(self.config), End.NO
        self._inbox = []
        return boot_frame(self.config.table_crc)

    @property
    def ended(self) -> bool:
        """Whether the run is certainly over."""
        return self.end is End.YES

    def receive(self, frame: Frame) -> tuple[Frame, ...]:
        """Take one frame; return the answer, TICK_DONE last, if it is an accepted SYNC, otherwise nothing.

        PLANT_BOOT takes no place among the frames of a tick: a waiting plant repeats it, unlogged.
        """
        if frame.can_id == Sync.ID and intact(frame):
            return self._answer(Sync.decode(frame.data))
        if frame.can_id == PlantEnd.ID and intact(frame):
            self.end = self._judge_end(PlantEnd.decode(frame.data).ticks)
        if len(self._inbox) < MOST_INBOX_FRAMES and not (frame.can_id == PlantBoot.ID and intact(frame)):
            self._inbox.append(frame)
        return ()

    def is_boot_request(self, frame: Frame, idle_s: float = 0.0) -> bool:
        """Whether the plant asks for FSW_BOOT: it started after this node did, or started again.

        Args:
            frame: the received frame.
            idle_s: time since a SYNC was answered.
        """
        waits = self.state.tick < 0 or idle_s > NO_PLANT_S
        return waits and frame.can_id == PlantBoot.ID and intact(frame)

    def copy(self) -> Self:
        """An independent copy of the node in its present state."""
        other = type(self)(self.config)
        other.state, other.end, other._inbox = copy_state(self.state), self.end, self._inbox.copy()
        return other

    def _answer(self, sync: Sync) -> tuple[Frame, ...]:
        """One step; the frames of the boards are stored until a SYNC consumes them."""
        before = self.state.tick
        outbox = step(self.state, Inbox(sync.tick, sync.unix_time_s, tuple(self._inbox)), self.config)
        if takes_inbox(before, self.state.tick, self.config.leap_ticks):
            self._inbox = []
        if outbox:
            self.end = End.NO
        return outbox

    def _judge_end(self, ticks: int) -> End:
        """Whether a PLANT_END ends the run; none is accepted before the first tick."""
        ahead = (ticks - self.state.tick - 1) % TICKS_MODULO
        if self.state.tick < 0 or ahead > self.config.leap_ticks:
            return self.end
        return End.DOUBTED if ahead else End.YES
