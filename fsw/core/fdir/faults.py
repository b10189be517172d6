"""Units and their faults, by the numbers that the bus reports."""

from enum import IntEnum


class Sensor(IntEnum):
    """Numbers of the sensors."""

    MAGNETOMETER = 1
    SUN_SENSOR = 2


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
