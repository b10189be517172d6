"""What the coil driver drives over a tick."""

from typing import Final, final

from fsw.wire.value import Value
from sim.plant.rotation import ZERO, Vec3


@final
class CoilDrive(Value):
    """The currents driven over a tick, from its start for ``fraction`` of it.

    Args:
        current_a: target current of each coil.
        fraction: of the tick.
        held_a: target current of each coil for the rest of it: none, unless a switch does not open.
    """

    FIELDS = ("current_a", "fraction", "held_a")
    __slots__ = FIELDS

    def __init__(self, current_a: Vec3, fraction: float, held_a: Vec3 = ZERO) -> None:
        self.current_a = current_a
        self.fraction = fraction
        self.held_a = held_a


OFF: Final = CoilDrive(ZERO, 0.0)
