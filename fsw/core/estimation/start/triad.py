"""Attitude from two vectors: TRIAD, used to start the filter."""

from math import acos

from fsw.core.algebra.quaternion import Quaternion, from_dcm
from fsw.core.algebra.vector import Vec3, cross, dot, norm, product, transpose, unit


def triad(primary_body: Vec3, secondary_body: Vec3, primary_ref: Vec3, secondary_ref: Vec3) -> Quaternion:
    """The attitude that maps the primary pair exactly and the planes of the pairs onto each other.

    C = M_body M_ref^T, the columns of M being (p, p x s, p x (p x s)), each normalised.

    Args:
        primary_body: direction trusted more, body axes; any length.
        secondary_body: direction trusted less, body axes; any length.
        primary_ref: the primary direction in the reference frame.
        secondary_ref: the secondary direction in the reference frame.

    Returns:
        q_body_from_ref. The directions must not be parallel (see ``consistent``).

    Source: Black 1964; Shuster and Oh 1981, eqs. 1-11.
    """
    columns_body = _frame(primary_body, secondary_body)
    columns_ref = _frame(primary_ref, secondary_ref)
    return from_dcm(product(transpose(columns_body), columns_ref))


def consistent(
    b_body_t: Vec3,
    s_body: Vec3,
    b_ref_t: Vec3,
    s_ref: Vec3,
    max_field_error_t: float,
    max_angle_error_rad: float,
    min_separation_rad: float,
) -> bool:
    """Whether a pair can start a filter: strength and field-Sun angle as modelled, not nearly parallel."""
    if abs(norm(b_body_t) - norm(b_ref_t)) > max_field_error_t:
        return False
    angle_body, angle_ref = _angle(b_body_t, s_body), _angle(b_ref_t, s_ref)
    separated = norm(cross(unit(b_ref_t), unit(s_ref))) > min_separation_rad
    return separated and abs(angle_body - angle_ref) <= max_angle_error_rad


def _frame(primary: Vec3, secondary: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    first = unit(primary)
    second = unit(cross(first, secondary))
    return (first, second, cross(first, second))


def _angle(a: Vec3, b: Vec3) -> float:
    return acos(max(-1.0, min(1.0, dot(unit(a), unit(b)))))
