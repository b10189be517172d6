"""Rotations of the plant, on plain floats: the plant shares no algebra with the flight software it tests.

Quaternions are Hamilton, scalar first, unit: v_body = C(q_body_from_ref) v_ref with
C = (q0^2 - |qv|^2) I + 2 qv qv^T - 2 q0 [qv x], and q_c_from_a = q_b_from_a (x) q_c_from_b.
"""

from math import cos, sin, sqrt

Vec3 = tuple[float, float, float]
Mat3 = tuple[Vec3, Vec3, Vec3]
"""Rows of a 3x3 matrix."""

Quaternion = tuple[float, float, float, float]

ZERO: Vec3 = (0.0, 0.0, 0.0)
ONES: Vec3 = (1.0, 1.0, 1.0)


def add(a: Vec3, b: Vec3) -> Vec3:
    """A + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def cross(a: Vec3, b: Vec3) -> Vec3:
    """A x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def transform(m: Mat3, v: Vec3) -> Vec3:
    """M v."""
    x, y, z = v
    (a, b, c), (d, e, f), (g, h, i) = m
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)


def matrix(q: Quaternion) -> Mat3:
    """The direction cosine matrix C(q), body from reference."""
    w, x, y, z = q
    return (
        (w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z),
    )


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    """The Hamilton product p (x) q."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """The rotation back: q_ref_from_body of q_body_from_ref."""
    return (q[0], -q[1], -q[2], -q[3])


def normalise(q: Quaternion) -> Quaternion:
    """Q / |q|."""
    w, x, y, z = q
    factor = 1.0 / sqrt(w * w + x * x + y * y + z * z)
    return (w * factor, x * factor, y * factor, z * factor)


def canonical(q: Quaternion) -> Quaternion:
    """Of q and -q, which are the same attitude, the one whose scalar part is not negative."""
    return q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])


def from_matrix(c: Mat3) -> Quaternion:
    """The quaternion, scalar part >= 0, of a direction cosine matrix (Shepperd 1978)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = c
    trace = xx + yy + zz
    if trace >= xx and trace >= yy and trace >= zz:
        q = (1.0 + trace, yz - zy, zx - xz, xy - yx)
    elif xx >= yy and xx >= zz:
        q = (yz - zy, 1.0 + xx - yy - zz, xy + yx, zx + xz)
    elif yy >= zz:
        q = (zx - xz, xy + yx, 1.0 - xx + yy - zz, yz + zy)
    else:
        q = (xy - yx, zx + xz, yz + zy, 1.0 - xx - yy + zz)
    return canonical(normalise(q))


def from_vector(rotation_rad: Vec3) -> Quaternion:
    """The quaternion of a rotation vector: the new frame is the old one turned by it."""
    x, y, z = rotation_rad
    angle = sqrt(x * x + y * y + z * z)
    if angle == 0.0:
        return (1.0, 0.0, 0.0, 0.0)
    factor = sin(0.5 * angle) / angle
    return (cos(0.5 * angle), factor * x, factor * y, factor * z)
