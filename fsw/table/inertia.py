"""Checks of the inertia tensor of a table."""

from math import isfinite

from fsw.core.algebra.vector import Mat3, cross, dot, scale, transpose

ROUNDING = 1e-9
SYMMETRY = 1e-14
"""Most difference of two products of inertia that rounding makes, over the trace."""


def three_numbers(value: object) -> bool:
    """Whether a value from TOML is a list of three finite numbers."""
    if not isinstance(value, list | tuple) or len(value) != 3:
        return False
    return all(isinstance(x, int | float) and not isinstance(x, bool) and isfinite(x) for x in value)


def without_rounding(inertia_kgm2: Mat3) -> Mat3:
    """The tensor, made exactly symmetric where it is so up to rounding, as R J R^T in floating point is."""
    (a, d, e), (g, b, f), (h, i, c) = inertia_kgm2
    small = SYMMETRY * (abs(a) + abs(b) + abs(c))
    if max(abs(d - g), abs(e - h), abs(f - i)) > small:
        return inertia_kgm2
    d, e, f = 0.5 * (d + g), 0.5 * (e + h), 0.5 * (f + i)
    return ((a, d, e), (d, b, f), (e, f, c))


def check_inertia(inertia_kgm2: Mat3) -> None:
    """Check that a tensor is that of a rigid body.

    J is possible exactly if tr(J)/2 I - J, the second moment of mass, has no negative eigenvalue, and J > 0.

    Raises:
        ValueError: not symmetric, or principal moments not positive or breaking the triangle inequality.
    """
    if inertia_kgm2 != transpose(inertia_kgm2):
        raise ValueError("inertia_kgm2 must be symmetric")
    first, second, third = inertia_kgm2
    half = 0.5 * (first[0] + second[1] + third[2])
    unit = 1.0 / half if half > 0.0 else 0.0
    if not _possible((scale(unit, first), scale(unit, second), scale(unit, third))):
        raise ValueError("inertia_kgm2 must be positive, no principal moment above the sum of the others")


def _possible(inertia: Mat3) -> bool:
    """Whether a symmetric tensor whose trace is 2 is that of a rigid body, up to rounding."""
    (a, h, g), (_, b, f), (_, _, c) = inertia
    x, y, z = 1.0 - a, 1.0 - b, 1.0 - c
    minors = (x, y, z, x * y - h * h, y * z - f * f, z * x - g * g)
    determinant = x * (y * z - f * f) - h * (h * z + f * g) - g * (h * f + y * g)
    positive = dot(inertia[0], cross(inertia[1], inertia[2])) > ROUNDING
    return positive and min(*minors, determinant) > -ROUNDING
