"""What a fault may touch. Each kind of fault overrides what it touches and leaves the rest as it is."""

from collections.abc import Mapping
from enum import Enum, auto
from random import Random
from typing import TYPE_CHECKING

from fsw.wire.frame import Frame
from sim.plant.interference import Interference
from sim.plant.plant import Plant

if TYPE_CHECKING:  # the plant's process, which loads the faults of a scenario, has no flight software
    from fsw.core.state import FlightState

Parameters = Mapping[str, float]


class Condition(Enum):
    """How the flight software's process is."""

    RUNNING = auto()
    STOPPED = auto()
    """As by SIGSTOP: what it is sent waits for it."""
    DEAD = auto()
    """As by SIGKILL: when it runs again it boots."""


class Fault(Interference):
    """A fault that is there from ``begin`` to ``end``. This one does nothing.

    Args:
        rng: whatever is random in the fault comes from it.
        parameters: by name, as the table of kinds has them.
    """

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        self.rng = rng
        self.parameters = parameters

    def begin(self, plant: Plant) -> None:
        """The fault comes, before the tick begins."""

    def end(self, plant: Plant) -> None:
        """The fault goes, before the tick begins."""

    def before(self, tick: int, plant: Plant) -> None:
        """A tick with the fault is about to begin."""

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What fsw receives of what the boards sent in this tick; SYNC is not among it."""
        return frames

    def strangers(self, tick: int) -> list[Frame]:
        """What a node that does not belong here sends before SYNC; all others hear it."""
        return []

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """What fsw receives in place of this tick's SYNC."""
        return [frame]

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What the boards receive of fsw's answers to this tick."""
        return frames

    repeats_sync = False
    """Whether SYNC comes again and again while a tick is held."""

    def held_ms(self, tick: int) -> int:
        """True time from SYNC to fsw's answer, where a board has a clock of its own [ms]."""
        return 0

    def condition(self, tick: int) -> Condition:
        """How fsw's process is in this tick."""
        return Condition.RUNNING

    def upset(self, state: "FlightState") -> "FlightState":
        """What becomes of the flight state in memory, before this tick's step."""
        return state
