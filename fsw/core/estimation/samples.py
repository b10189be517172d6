"""Which samples of the boards the filter may use."""

from fsw.core.algebra.vector import Vec3
from fsw.core.gate.readings import Readings

TESLA_PER_NT = 1e-9


def usable_field(readings: Readings) -> Vec3 | None:
    """The field sample, T; None where a coil was driven, its current still flowed, or either may be."""
    field, coil = readings.field, readings.coil
    if field is None or not field.valid or coil is None or coil.level != 0 or coil.current_ma != 0:
        return None
    return (field.b_x * TESLA_PER_NT, field.b_y * TESLA_PER_NT, field.b_z * TESLA_PER_NT)


def usable_sun(readings: Readings) -> Vec3 | None:
    """The measured Sun direction, or None."""
    sun = readings.sun
    return (sun.s_x, sun.s_y, sun.s_z) if sun is not None and sun.valid else None
