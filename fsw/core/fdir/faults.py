"""Units and their faults, by the numbers that the bus reports."""

from enum import IntEnum
from typing import Final


class Sensor(IntEnum):
    """Numbers of the sensors; Sun cells together are the Sun sensor."""

    MAGNETOMETER = 1
    SUN_SENSOR = 2
    CELL_1 = 3
    CELL_2 = 4
    CELL_3 = 5
    CELL_4 = 6
    CELL_5 = 7
    CELL_6 = 8


class SensorFault(IntEnum):
    """Faults of a sensor."""

    SATURATED = 1
    STRENGTH = 2
    FROZEN = 3
    REFUSED = 4
    SILENT = 5
    UNLIT = 6


class CoilFault(IntEnum):
    """Faults of a coil."""

    OPEN = 1
    WEAK = 2
    REVERSED = 3
    STUCK = 4


OPEN_PART: Final = 0.2
REVERSED_PART: Final = -0.5
"""Fractions of the nominal current or effect below which nothing flows, and below which it is reversed."""


def coil_fault(part: float, weak_part: float) -> int:
    """The fault of a coil with this fraction of its nominal effect; 0 unless it is below ``weak_part``."""
    if not part < weak_part:
        return 0
    if part < REVERSED_PART:
        return CoilFault.REVERSED
    return CoilFault.OPEN if part < OPEN_PART else CoilFault.WEAK
