"""The last samples of field and Sun, and for how long each has been repeated."""

from dataclasses import dataclass
from typing import final

from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.fdir.sensors.standstill import ReadingMotion
from fsw.core.gate.measurements import Measurements

DARK: Vec3 = (0.0, 0.0, 0.0)
"""The sample of a Sun sensor without a Sun."""


@final
@dataclass(slots=True)
class Memory:
    """The last samples as they were sent, and for how many ticks each has been repeated.

    ``motion``: what field and Sun have moved by meanwhile, None if both readings are continuous.
    """

    field: Vec3 = ZERO
    sun: Vec3 = ZERO
    field_still: int = 0
    sun_still: int = 0
    motion: ReadingMotion | None = None


def remember(memory: Memory, measurements: Measurements) -> None:
    """Keep the samples of this tick, and count how often each has been repeated."""
    field, sun = measurements.field, measurements.sun
    if field is not None:
        memory.field_still = memory.field_still + 1 if field.b_body_nt == memory.field else 0
        memory.field = field.b_body_nt
    if sun is not None:
        sample = sun.s_body if sun.valid else DARK
        memory.sun_still = memory.sun_still + 1 if sun.valid and sample == memory.sun else 0
        memory.sun = sample
