"""The flight node: collects frames into inboxes and runs a step at each SYNC. No I/O of its own."""

from fsw.core.config import FlightConfig
from fsw.core.state import FlightState, Inbox
from fsw.core.step import boot, step
from fsw.core.telemetry import boot_frame
from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, Sync, intact

KEPT_FRAMES = 1024
"""Frames kept between two SYNCs: bounds memory under a flood, far above what the gate looks at."""

LEAP_TICKS = 60
"""A SYNC further ahead is believed when the next one goes on from it: one alone must not end the count."""


class FlightNode:
    """Flight software seen from the bus: frames in, frames out."""

    def __init__(self, config: FlightConfig) -> None:
        self.config = config
        self.state: FlightState = boot(config)
        self.ended = False
        self._inbox: list[Frame] = []
        self._leapt_to: int | None = None

    def start(self) -> Frame:
        """FSW_BOOT, the first frame this node sends; what came before it does not count."""
        self._inbox.clear()
        return boot_frame(self.config.table_crc)

    def receive(self, frame: Frame) -> tuple[Frame, ...]:
        """Take one frame; the answer, TICK_DONE last, when it is a SYNC, else nothing."""
        if frame.can_id == Sync.ID and intact(frame):
            sync = Sync.decode(frame.data)
            inbox = Inbox(sync.tick, sync.unix_time_s, tuple(self._inbox))
            self._inbox.clear()
            if not self._believes(sync.tick):
                self.state = self.state._replace(ignored_syncs=self.state.ignored_syncs + 1)
                return ()
            self.state, outbox = step(self.state, inbox, self.config)
            return outbox
        if frame.can_id == PlantEnd.ID and intact(frame):
            self.ended = True
        if len(self._inbox) < KEPT_FRAMES:
            self._inbox.append(frame)
        return ()

    def hears_plant_start(self, frame: Frame) -> bool:
        """Whether the plant asks for FSW_BOOT: it started after this node did."""
        return self.state.tick < 0 and frame.can_id == PlantBoot.ID and intact(frame)

    def _believes(self, tick: int) -> bool:
        """Whether a SYNC may be this tick's: the first one, one near, or one that goes on from a leap."""
        goes_on = self._leapt_to is not None and tick == self._leapt_to + 1
        near = self.state.tick < 0 or tick <= self.state.tick + LEAP_TICKS
        self._leapt_to = None if near else tick
        return near or goes_on
