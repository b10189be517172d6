"""The result of a run, as it travels from a worker to the results."""

from dataclasses import dataclass, field
from enum import StrEnum

from sim.campaign.definition.columns import Cell


class Status(StrEnum):
    """What became of a run."""

    DONE = "done"
    FAILED = "failed"
    """It was not flown to its end; ``failure`` says why."""


@dataclass(frozen=True, slots=True)
class RunRow:
    """A run.

    Attributes:
        run: its number.
        status: whether it was flown.
        failure: why it was not, in a sentence; otherwise empty.
        seed: of the plant's random streams.
        success: whether it meets all requirements and kept the limits of the coils.
        missed: the requirements that it does not meet, as text.
        cells: inputs, figures and digests by column.
        profiles: by name, arrays of 4-byte floats, little-endian.
        wall_s: how long it took.
        worker: which process flew it.
    """

    run: int
    status: Status
    failure: str
    seed: int
    success: bool
    missed: str
    cells: dict[str, Cell]
    profiles: dict[str, bytes] = field(default_factory=dict)
    wall_s: float = 0.0
    worker: str = ""
