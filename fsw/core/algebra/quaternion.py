"""Quaternion algebra: Hamilton product, scalar first, unit norm.

A quaternion ``q_body_from_ref`` converts components: v_body = C(q) v_ref with
C = (q0^2 - |qv|^2) I + 2 qv qv^T - 2 q0 [qv x], and dq/dt = 1/2 q (x) (0, omega), omega in body axes.
Chains multiply from the reference outward: q_c_from_a = q_b_from_a (x) q_c_from_b.
"""

from math import sqrt

from fsw.core.algebra.vector import Mat3, Vec3

Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    """The Hamilton product p (x) q."""
    p0, p1, p2, p3 = p
    q0, q1, q2, q3 = q
    return (
        p0 * q0 - p1 * q1 - p2 * q2 - p3 * q3,
        p0 * q1 + p1 * q0 + p2 * q3 - p3 * q2,
        p0 * q2 - p1 * q3 + p2 * q0 + p3 * q1,
        p0 * q3 + p1 * q2 - p2 * q1 + p3 * q0,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """The inverse of a unit quaternion: q_ref_from_body of q_body_from_ref."""
    return (q[0], -q[1], -q[2], -q[3])


def normalise(q: Quaternion) -> Quaternion:
    """Q / |q|."""
    q0, q1, q2, q3 = q
    factor = 1.0 / sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    return (q0 * factor, q1 * factor, q2 * factor, q3 * factor)


def canonical(q: Quaternion) -> Quaternion:
    """Of q and -q, which are the same attitude, the one whose scalar part is not negative."""
    return q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])


def rotate(q: Quaternion, v: Vec3) -> Vec3:
    """C(q) v: the components in the body frame of a vector given in the reference frame."""
    q0, q1, q2, q3 = q
    v1, v2, v3 = v
    t1 = 2.0 * (v2 * q3 - v3 * q2)
    t2 = 2.0 * (v3 * q1 - v1 * q3)
    t3 = 2.0 * (v1 * q2 - v2 * q1)
    return (
        v1 + q0 * t1 + (t2 * q3 - t3 * q2),
        v2 + q0 * t2 + (t3 * q1 - t1 * q3),
        v3 + q0 * t3 + (t1 * q2 - t2 * q1),
    )


def dcm(q: Quaternion) -> Mat3:
    """The direction cosine matrix C(q), body from reference."""
    q0, q1, q2, q3 = q
    d = q0 * q0 - q1 * q1 - q2 * q2 - q3 * q3
    return (
        (d + 2.0 * q1 * q1, 2.0 * (q1 * q2 + q0 * q3), 2.0 * (q1 * q3 - q0 * q2)),
        (2.0 * (q1 * q2 - q0 * q3), d + 2.0 * q2 * q2, 2.0 * (q2 * q3 + q0 * q1)),
        (2.0 * (q1 * q3 + q0 * q2), 2.0 * (q2 * q3 - q0 * q1), d + 2.0 * q3 * q3),
    )


def from_dcm(c: Mat3) -> Quaternion:
    """The quaternion of a direction cosine matrix, scalar part >= 0 (Shepperd 1978: the largest pivot)."""
    (c11, c12, c13), (c21, c22, c23), (c31, c32, c33) = c
    p0, p1 = 1.0 + c11 + c22 + c33, 1.0 + c11 - c22 - c33
    p2, p3 = 1.0 - c11 + c22 - c33, 1.0 - c11 - c22 + c33
    one, other = max(p0, p1), max(p2, p3)
    largest = max(one, other)
    if largest == p0:
        q = (largest, c23 - c32, c31 - c13, c12 - c21)
    elif largest == p1:
        q = (c23 - c32, largest, c12 + c21, c13 + c31)
    elif largest == p2:
        q = (c31 - c13, c12 + c21, largest, c23 + c32)
    else:
        q = (c12 - c21, c13 + c31, c23 + c32, largest)
    return canonical(normalise(q))


def from_small_rotation(rotation_rad: Vec3) -> Quaternion:
    """The unit quaternion along (1, rotation / 2): second-order accurate, exactly unit, no trigonometry."""
    r1, r2, r3 = rotation_rad
    return normalise((1.0, 0.5 * r1, 0.5 * r2, 0.5 * r3))
