"""The interface of faults: each kind overrides the methods of what it affects."""

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
    """The state of the flight software's process."""

    RUNNING = auto()
    STOPPED = auto()
    """As by SIGSTOP: frames to it wait."""
    DEAD = auto()
    """As by SIGKILL: when it runs again it boots."""


class Fault(Interference):
    """A fault that is active from ``begin`` to ``end``. This one does nothing.

    Args:
        rng: source of all random numbers of the fault.
        parameters: by name, as in the table of kinds.
    """

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        self.rng = rng
        self.parameters = parameters

    def begin(self, plant: Plant) -> None:
        """The fault begins, before the tick does."""

    def end(self, plant: Plant) -> None:
        """The fault ends, before the tick begins."""

    def before(self, tick: int, plant: Plant) -> None:
        """A tick with the fault active is about to begin."""

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Of the frames that boards sent in this tick, those that fsw receives; SYNC is not among them."""
        return frames

    def strangers(self, tick: int) -> list[Frame]:
        """The frames that a node outside the contract sends before SYNC; all others receive them."""
        return []

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """The frames that fsw receives in place of this tick's SYNC."""
        return [frame]

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Of the frames of fsw's answer to this tick, those that the boards receive."""
        return frames

    repeats_sync = False
    """Whether SYNC is repeated while a tick is held."""

    def held_ms(self, tick: int) -> int:
        """True time from SYNC to fsw's answer, where a board has a clock of its own [ms]."""
        return 0

    def condition(self, tick: int) -> Condition:
        """The state of fsw's process in this tick."""
        return Condition.RUNNING

    def upset(self, state: "FlightState") -> "FlightState":
        """The flight state in memory after an upset, before this tick's step."""
        return state
