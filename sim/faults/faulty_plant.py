"""A plant with faults in its sensors, coils, boards and in the bus to its boards."""

from collections.abc import Sequence
from dataclasses import dataclass

from fsw.wire.frame import Frame
from sim.faults.fault import Fault
from sim.plant.coil_drive import CoilDrive
from sim.plant.config import PlantConfig
from sim.plant.hardware.actuators import Actuator
from sim.plant.interference import Interference
from sim.plant.own_effects import NO_EFFECTS, OwnEffects
from sim.plant.plant import Plant
from sim.plant.rotation import Vec3


@dataclass(frozen=True, slots=True)
class ScheduledFault:
    """A fault that is active from tick ``first`` to before ``end``; None: to the end of the flight."""

    fault: Fault
    first: int
    end: int | None = None


class FaultyPlant(Plant):
    """A plant with faults that begin and end.

    ``begin_tick`` gives the frames on the bus of fsw; ``sent`` are those that the boards themselves sent.

    Args:
        config: the plant.
        faults: scheduled from the start.
        actuator: drives the coils in place of the plant's own board.
        effects: what else acts on body and sensors, before the faults.
    """

    def __init__(
        self,
        config: PlantConfig,
        faults: Sequence[ScheduledFault] = (),
        actuator: Actuator | None = None,
        effects: OwnEffects = NO_EFFECTS,
    ) -> None:
        super().__init__(config, actuator, effects)
        self._always = (effects,) if effects.any else ()
        self._waiting = list(faults)
        self._schedule: list[ScheduledFault] = []
        self._to_boards: list[Frame] = []
        self.active: tuple[Fault, ...] = ()
        """The faults that are active in this tick."""
        self.received: list[Frame] = []
        """The frames that the boards received in the last complete tick."""
        self.sent: list[Frame] = []
        """The frames that boards and plant sent in this tick, SYNC last."""

    def inject(self, scheduled: ScheduledFault) -> None:
        """Schedule a further fault."""
        self._waiting.append(scheduled)

    def begin_tick(self) -> list[Frame]:
        """The frames of this tick as fsw receives them."""
        self._switch()
        self.sent = super().begin_tick()
        *frames, sync = self.sent
        strangers: list[Frame] = []
        for fault in self.active:
            frames = fault.from_boards(self.tick, frames)
            strangers += fault.strangers(self.tick)
        self._to_boards = list(strangers)
        return [*frames, *strangers, sync]

    def receive(self, frame: Frame) -> None:
        """Store a frame of fsw until the tick ends."""
        self._to_boards.append(frame)

    def end_tick(self) -> None:
        """Hand the boards the frames that reach them, and advance to the next tick."""
        frames = self._to_boards
        for fault in self.active:
            frames = fault.to_boards(self.tick, frames)
        for frame in frames:
            super().receive(frame)
        self.received = frames
        super().end_tick()

    def _switch(self) -> None:
        """Begin and end faults as scheduled for this tick."""
        tick = self.tick
        over = [one for one in self._schedule if one.end is not None and one.end <= tick]
        due = [one for one in self._waiting if one.first <= tick]
        for one in over:
            self._schedule.remove(one)
            one.fault.end(self)
        for one in due:
            self._waiting.remove(one)
            self._schedule.append(one)
            one.fault.begin(self)
        if over or due:
            self.active = tuple(one.fault for one in self._schedule)
            self.interference = _Chain((*self._always, *self.active))
        for fault in self.active:
            fault.before(tick, self)


class _Chain(Interference):
    """All faults, one after the other."""

    def __init__(self, faults: tuple[Interference, ...]) -> None:
        self._faults = faults

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Apply all faults."""
        for fault in self._faults:
            b_body_t, valid = fault.field(b_body_t, valid)
        return b_body_t, valid

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Apply all faults."""
        for fault in self._faults:
            sun_body, valid = fault.sun(sun_body, valid)
        return sun_body, valid

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """Apply all faults."""
        for fault in self._faults:
            currents = fault.cells(currents)
        return currents

    def coil_drive(self, drive: CoilDrive) -> CoilDrive:
        """Apply all faults."""
        for fault in self._faults:
            drive = fault.coil_drive(drive)
        return drive
