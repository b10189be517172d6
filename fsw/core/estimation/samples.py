"""Which samples of the boards the filter may use."""

from fsw.core.algebra.vector import Vec3, scale, unit
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.gate.readings import Readings

TESLA_PER_NT = 1e-9


def usable_field(readings: Readings) -> Vec3 | None:
    """The field sample, T; None where a coil may add a field of its own that is not known."""
    field = readings.field
    if field is None or not field.valid or not coils_idle(readings):
        return None
    return (field.b_x * TESLA_PER_NT, field.b_y * TESLA_PER_NT, field.b_z * TESLA_PER_NT)


def saturated_field(readings: Readings) -> tuple[Vec3, Vec3] | None:
    """A field sample with one axis at the end of its range, T, and the direction that it leaves open."""
    field, saturated = readings.field, readings.saturated
    if field is None or len(saturated) != 1 or not coils_idle(readings):
        return None
    return scale(TESLA_PER_NT, (field.b_x, field.b_y, field.b_z)), saturated[0]


def coils_idle(readings: Readings) -> bool:
    """Whether no coil adds a field to what the magnetometer senses, beyond what has been subtracted."""
    coil = readings.coil
    if readings.settled:
        return readings.quiet
    return readings.quiet and coil is not None and coil.level == 0 and coil.current_ma == 0


def usable_sun(readings: Readings) -> Vec3 | None:
    """The measured Sun direction, or None."""
    sun = readings.sun
    return (sun.s_x, sun.s_y, sun.s_z) if sun is not None and sun.valid else None


def usable_cells(readings: Readings, cells: CellSet | None) -> tuple[float | None, ...]:
    """What each Sun cell shows, as a fraction of full sunlight; None for one that is not to be used."""
    sample = readings.cells
    if cells is None or sample is None or not sample.valid:
        return ()
    currents = (sample.cell_1, sample.cell_2, sample.cell_3, sample.cell_4, sample.cell_5, sample.cell_6)
    return tuple(
        [
            None if cell in readings.unusable_cells else current / full
            for cell, (current, full) in enumerate(zip(currents, cells.full_sun, strict=False))
        ]
    )


def sensed_sun(readings: Readings, cells: CellSet | None) -> Vec3 | None:
    """The direction of the Sun from its sensor, or the coarse one of the cells; None where there is none."""
    return usable_sun(readings) if cells is None else coarse_sun(usable_cells(readings, cells), cells)


def sun_direction(readings: Readings, cells: CellSet | None) -> Vec3 | None:
    """``sensed_sun`` for a law: where the Sun is, not how bright; the coarse one becomes a unit vector."""
    sun = sensed_sun(readings, cells)
    return sun if sun is None or cells is None else unit(sun)
