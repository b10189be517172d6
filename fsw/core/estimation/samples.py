"""Which samples of the boards the filter may use."""

from fsw.core.algebra.vector import Vec3, unit
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.gate.measurements import Measurements


def usable_field(measurements: Measurements) -> Vec3 | None:
    """The field sample, T; None where a coil may add a field of its own that is not known."""
    field = measurements.field
    usable = field is not None and field.valid and measurements.field_trusted and coils_idle(measurements)
    return field.b_body_t if field is not None and usable else None


def saturated_field(measurements: Measurements) -> tuple[Vec3, Vec3] | None:
    """A field sample with one axis at the end of its range, T, and the direction that it leaves open."""
    field, saturated = measurements.field, measurements.saturated
    if field is None or len(saturated) != 1 or not measurements.field_trusted or not coils_idle(measurements):
        return None
    return field.b_body_t, saturated[0]


def coils_idle(measurements: Measurements) -> bool:
    """Whether no coil adds a field to what the magnetometer senses, beyond what has been subtracted."""
    coil = measurements.coil
    if measurements.settled:
        return measurements.quiet
    return measurements.quiet and coil is not None and coil.level == 0 and coil.current_ma == 0


def usable_sun(measurements: Measurements) -> Vec3 | None:
    """The measured Sun direction, or None."""
    sun = measurements.sun
    return sun.s_body if sun is not None and sun.valid and measurements.sun_trusted else None


def usable_cells(measurements: Measurements, cells: CellSet | None) -> tuple[float | None, ...]:
    """What each Sun cell shows, as a fraction of full sunlight; None for one that is not to be used."""
    sample = measurements.cells
    if cells is None or sample is None or not sample.valid or not measurements.sun_trusted:
        return ()
    return tuple(
        [
            None if cell in measurements.unusable_cells else current / full
            for cell, (current, full) in enumerate(zip(sample.currents, cells.full_sun, strict=False))
        ]
    )


def sensed_sun(measurements: Measurements, cells: CellSet | None) -> Vec3 | None:
    """The direction of the Sun from its sensor, or the coarse one of the cells; None where there is none."""
    return usable_sun(measurements) if cells is None else coarse_sun(usable_cells(measurements, cells), cells)


def sun_direction(measurements: Measurements, cells: CellSet | None) -> Vec3 | None:
    """``sensed_sun`` for a law: where the Sun is, not how bright; the coarse one becomes a unit vector."""
    sun = sensed_sun(measurements, cells)
    return sun if sun is None or cells is None else unit(sun)
