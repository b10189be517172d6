"""Which samples of the boards the filter may use."""

from fsw.core.algebra.vector import Vec3
from fsw.core.gate.readings import Readings

TESLA_PER_NT = 1e-9


def usable_field(readings: Readings) -> Vec3 | None:
    """The field sample, T; None where a coil was driven, its current still flowed, or either may be."""
    field = readings.field
    if field is None or not field.valid or not coils_idle(readings):
        return None
    return (field.b_x * TESLA_PER_NT, field.b_y * TESLA_PER_NT, field.b_z * TESLA_PER_NT)


def coils_idle(readings: Readings) -> bool:
    """Whether no coil adds its own field to what the magnetometer senses."""
    coil = readings.coil
    return readings.quiet and coil is not None and coil.level == 0 and coil.current_ma == 0


def usable_sun(readings: Readings) -> Vec3 | None:
    """The measured Sun direction, or None."""
    sun = readings.sun
    return (sun.s_x, sun.s_y, sun.s_z) if sun is not None and sun.valid else None
