"""A plant with faults in its sensors, coils, boards and in the bus to its boards."""

from collections.abc import Sequence
from dataclasses import dataclass

from fsw.wire.frame import Frame
from sim.faults.fault import Fault
from sim.plant.config import PlantConfig
from sim.plant.hardware.actuators import Actuator, Driven
from sim.plant.interference import Interference
from sim.plant.plant import Plant
from sim.plant.rotation import Vec3


@dataclass(frozen=True, slots=True)
class Scheduled:
    """A fault that is there in the ticks from ``first`` to before ``end``; None: for ever."""

    fault: Fault
    first: int
    end: int | None = None


class FaultyPlant(Plant):
    """As a plant, but with faults that come and go.

    What ``begin_tick`` gives is what is on the bus of fsw; ``said`` is what the boards themselves have said.

    Args:
        config: the plant.
        faults: what is scheduled from the start.
        actuator: what drives the coils, where that is not a board of the plant's own.
    """

    def __init__(
        self, config: PlantConfig, faults: Sequence[Scheduled] = (), actuator: Actuator | None = None
    ) -> None:
        super().__init__(config, actuator)
        self._waiting = list(faults)
        self._scheduled: list[Scheduled] = []
        self._heard: list[Frame] = []
        self.active: tuple[Fault, ...] = ()
        """The faults that are there in this tick."""
        self.heard: list[Frame] = []
        """What got through to the boards in the tick that has ended last."""
        self.said: list[Frame] = []
        """What the boards and the plant have said in this tick, SYNC last."""

    def inject(self, scheduled: Scheduled) -> None:
        """Schedule one more."""
        self._waiting.append(scheduled)

    def begin_tick(self) -> list[Frame]:
        """The frames of this tick as fsw gets them."""
        self._switch()
        self.said = super().begin_tick()
        *frames, sync = self.said
        strangers: list[Frame] = []
        for fault in self.active:
            frames = fault.from_boards(self.tick, frames)
            strangers += fault.strangers(self.tick)
        self._heard = list(strangers)
        return [*frames, *strangers, sync]

    def receive(self, frame: Frame) -> None:
        """Keep a frame of fsw until the tick ends."""
        self._heard.append(frame)

    def end_tick(self) -> None:
        """Let the boards hear what gets through to them, and go on to the next tick."""
        frames = self._heard
        for fault in self.active:
            frames = fault.to_boards(self.tick, frames)
        for frame in frames:
            super().receive(frame)
        self.heard = frames
        super().end_tick()

    def _switch(self) -> None:
        """Faults that come with this tick, and those that go."""
        tick = self.tick
        over = [one for one in self._scheduled if one.end is not None and one.end <= tick]
        due = [one for one in self._waiting if one.first <= tick]
        for one in over:
            self._scheduled.remove(one)
            one.fault.end(self)
        for one in due:
            self._waiting.remove(one)
            self._scheduled.append(one)
            one.fault.begin(self)
        if over or due:
            self.active = tuple(one.fault for one in self._scheduled)
            self.interference = _Chain(self.active)
        for fault in self.active:
            fault.before(tick, self)


class _Chain(Interference):
    """All faults one after the other."""

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        self._faults = faults

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Through all."""
        for fault in self._faults:
            b_body_t, valid = fault.field(b_body_t, valid)
        return b_body_t, valid

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Through all."""
        for fault in self._faults:
            sun_body, valid = fault.sun(sun_body, valid)
        return sun_body, valid

    def driven(self, driven: Driven) -> Driven:
        """Through all."""
        for fault in self._faults:
            driven = fault.driven(driven)
        return driven
