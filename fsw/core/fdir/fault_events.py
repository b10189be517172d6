"""The faults of all units, and what is reported of those that are new or gone."""

from typing import final

from fsw.core.events import Event, Happening
from fsw.core.fdir.faults import Sensor
from fsw.core.fdir.fdir import Health
from fsw.core.fdir.sensors.cells import cell_changes, cell_faults
from fsw.core.fdir.sensors.pair import Standing


@final
class Faults:
    """The faults of all units, to compare with those of another tick.

    By number: ``field`` and ``sun``, those of each cell, and of each coil; ``disputed``: field and Sun
    disagree.
    """

    __slots__ = ("cells", "coils", "disputed", "field", "sun")

    def __init__(
        self, field: int, sun: int, cells: tuple[int, ...], disputed: bool, coils: tuple[int, int, int]
    ) -> None:
        self.field = field
        self.sun = sun
        self.cells = cells
        self.disputed = disputed
        self.coils = coils


def find_faults(health: Health) -> Faults:
    """The faults that have been found so far."""
    sensors = health.sensors
    return Faults(
        sensors.field.fault,
        sensors.sun.fault,
        cell_faults(sensors.cells),
        sensors.pair.standing is Standing.DISPUTED,
        health.coils.faults,
    )


def happenings(before: Faults, after: Faults) -> list[Happening]:
    """An event for each fault that is new or gone."""
    found: list[Happening] = []
    _add_sensor(found, Sensor.MAGNETOMETER, before.field, after.field)
    _add_sensor(found, Sensor.SUN_SENSOR, before.sun, after.sun)
    for cell, was, now in cell_changes(before.cells, after.cells):
        _add_sensor(found, Sensor.CELL_1 + cell, was, now)
    if after.disputed and not before.disputed:
        found.append(Happening(Event.SENSORS_DISAGREE, 0))
    _add_coil(found, 1, before.coils[0], after.coils[0])
    _add_coil(found, 2, before.coils[1], after.coils[1])
    _add_coil(found, 3, before.coils[2], after.coils[2])
    return found


def _add_sensor(found: list[Happening], sensor: int, before: int, after: int) -> None:
    """Add the event of a sensor whose fault has changed, if it has."""
    if before != after:
        kind = Event.SENSOR_ISOLATED if after else Event.SENSOR_READMITTED
        found.append(Happening(kind, 100 * sensor + (after or before)))


def _add_coil(found: list[Happening], coil: int, before: int, after: int) -> None:
    """Add the event of a coil whose fault has changed, if it has; coils are numbered from 1."""
    if before != after:
        kind = Event.COIL_FAULT if after else Event.COIL_READMITTED
        found.append(Happening(kind, 100 * coil + (after or before)))
