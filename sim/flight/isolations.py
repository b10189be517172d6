"""Which unit the flight software has isolated, according to its events."""

from collections.abc import Mapping

from fsw.core.events import Event
from fsw.core.fdir.faults import Sensor

UNITS: Mapping[int, Mapping[int, str]] = {
    Event.SENSOR_ISOLATED: {
        Sensor.MAGNETOMETER: "magnetometer",
        Sensor.SUN_SENSOR: "sun sensor",
        **{sensor: f"cell {sensor - Sensor.SUN_SENSOR}" for sensor in Sensor if sensor > Sensor.SUN_SENSOR},
    },
    Event.COIL_FAULT: {1: "coil 0", 2: "coil 1", 3: "coil 2"},
}
"""Units by event, and by the hundreds of its argument. Coils are numbered as on the bus."""


ISOLATED_BY: Mapping[int, int] = {
    Event.SENSOR_READMITTED: Event.SENSOR_ISOLATED,
    Event.COIL_READMITTED: Event.COIL_FAULT,
}
"""The event that a readmission reverses; its argument is the same."""


def isolated_unit(event: int, argument: int) -> str | None:
    """The unit that an event of the flight software isolates; None if it isolates none."""
    if event not in UNITS:
        return None
    return UNITS[event].get(argument // 100, f"unit {argument}")


def readmitted_unit(event: int, argument: int) -> str | None:
    """The unit that an event of the flight software readmits; None if it readmits none."""
    return isolated_unit(ISOLATED_BY[event], argument) if event in ISOLATED_BY else None
