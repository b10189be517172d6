"""Algebra of 3-vectors and 3x3 matrices on plain floats.

Plain floats give the same bits on every machine and cost a fraction of a numpy call at this size.
"""

from math import sqrt

Vec3 = tuple[float, float, float]
Mat3 = tuple[Vec3, Vec3, Vec3]
"""Rows of a 3x3 matrix."""

ZERO: Vec3 = (0.0, 0.0, 0.0)


def add(a: Vec3, b: Vec3) -> Vec3:
    """A + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a: Vec3, b: Vec3) -> Vec3:
    """A - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(factor: float, a: Vec3) -> Vec3:
    """Factor * a."""
    return (factor * a[0], factor * a[1], factor * a[2])


def row(m: Mat3, index: int) -> Vec3:
    """The row of this index, 0 to 2."""
    return m[0] if index == 0 else m[1] if index == 1 else m[2]


def item(a: Vec3, index: int) -> float:
    """The component of this index, 0 to 2."""
    return a[0] if index == 0 else a[1] if index == 1 else a[2]


def is_finite(number: float) -> bool:
    """Whether it is a number: what is not, or is infinite, less itself is none."""
    return number - number == 0.0


def is_zero(a: Vec3) -> bool:
    """Whether all its components are zero."""
    return a[0] == 0.0 and a[1] == 0.0 and a[2] == 0.0


def dot(a: Vec3, b: Vec3) -> float:
    """A . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec3, b: Vec3) -> Vec3:
    """A x b."""
    a1, a2, a3 = a
    b1, b2, b3 = b
    return (a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1)


def norm(a: Vec3) -> float:
    """|a|."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def unit(a: Vec3) -> Vec3:
    """A / |a|, or zero for a zero vector."""
    length = norm(a)
    return scale(1.0 / length, a) if length > 0.0 else ZERO


def transform(m: Mat3, a: Vec3) -> Vec3:
    """M a."""
    a1, a2, a3 = a
    r1, r2, r3 = m
    return (
        r1[0] * a1 + r1[1] * a2 + r1[2] * a3,
        r2[0] * a1 + r2[1] * a2 + r2[2] * a3,
        r3[0] * a1 + r3[1] * a2 + r3[2] * a3,
    )


def transpose(m: Mat3) -> Mat3:
    """M^T."""
    (a, b, c), (d, e, f), (g, h, i) = m
    return ((a, d, g), (b, e, h), (c, f, i))


def product(m: Mat3, n: Mat3) -> Mat3:
    """M N."""
    (a1, a2, a3), (b1, b2, b3), (c1, c2, c3) = n
    (p1, p2, p3), (q1, q2, q3), (r1, r2, r3) = m
    return (
        (p1 * a1 + p2 * b1 + p3 * c1, p1 * a2 + p2 * b2 + p3 * c2, p1 * a3 + p2 * b3 + p3 * c3),
        (q1 * a1 + q2 * b1 + q3 * c1, q1 * a2 + q2 * b2 + q3 * c2, q1 * a3 + q2 * b3 + q3 * c3),
        (r1 * a1 + r2 * b1 + r3 * c1, r1 * a2 + r2 * b2 + r3 * c2, r1 * a3 + r2 * b3 + r3 * c3),
    )


def skew(a: Vec3) -> Mat3:
    """The matrix [a x], so that [a x] b = a x b."""
    a1, a2, a3 = a
    return ((0.0, -a3, a2), (a3, 0.0, -a1), (-a2, a1, 0.0))


def positive_definite(m: Mat3) -> bool:
    """Whether a symmetric matrix is: all its leading minors are positive."""
    (a, b, _), (d, e, _), _ = m
    return a > 0.0 and a * e - b * d > 0.0 and dot(m[0], cross(m[1], m[2])) > 0.0


def inverse(m: Mat3) -> Mat3:
    """The inverse of a nonsingular matrix, by cofactors.

    Raises:
        ZeroDivisionError: the matrix is singular.
    """
    c1, c2, c3 = cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])
    factor = 1.0 / dot(m[0], c1)
    return transpose((scale(factor, c1), scale(factor, c2), scale(factor, c3)))


def symmetric_inverse(m: Mat3) -> Mat3:
    """The inverse of a nonsingular symmetric matrix, in less than half the time of ``inverse``.

    Raises:
        ZeroDivisionError: the matrix is singular.
    """
    (a, d, e), (_, b, f), (_, _, c) = m
    aa, dd, ee = b * c - f * f, e * f - d * c, d * f - e * b
    factor = 1.0 / (a * aa + d * dd + e * ee)
    bb, ff, cc = factor * (a * c - e * e), factor * (d * e - a * f), factor * (a * b - d * d)
    aa, dd, ee = factor * aa, factor * dd, factor * ee
    return ((aa, dd, ee), (dd, bb, ff), (ee, ff, cc))
