"""Which unit the flight software has isolated, by its events."""

from collections.abc import Mapping

from fsw.core.events import Event
from fsw.core.fdir.faults import Sensor

UNITS: Mapping[int, Mapping[int, str]] = {
    Event.SENSOR_ISOLATED: {Sensor.MAGNETOMETER: "magnetometer", Sensor.SUN_SENSOR: "sun sensor"},
    Event.COIL_FAULT: {1: "coil 0", 2: "coil 1", 3: "coil 2"},
}
"""Units by event, and by the hundreds of its argument. Coils have the number that they have on the bus."""


def isolated_unit(event: int, argument: int) -> str | None:
    """The unit that an event of the flight software isolates; None if it isolates none."""
    if event not in UNITS:
        return None
    return UNITS[event].get(argument // 100, f"unit {argument}")
