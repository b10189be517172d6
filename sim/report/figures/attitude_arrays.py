"""Attitude algebra on histories: arrays of quaternions, shape (n, 4), scalar first, v_body = C(q) v_ref."""

import numpy as np

from fsw.core.laws.plan.law_axes import LawAxes
from sim.value_types import Array


def relative(q_from: Array, q_to: Array) -> Array:
    """conj(q_from) (x) q_to: the rotation from the first attitude to the second, scalar part >= 0, (n, 4)."""
    p0, p = q_from[:, :1], -q_from[:, 1:]
    q0, q = q_to[:, :1], q_to[:, 1:]
    scalar = p0 * q0 - np.sum(p * q, axis=1, keepdims=True)
    vector = p0 * q + q0 * p + np.cross(p, q)
    turn = np.hstack((scalar, vector))
    return np.where(scalar < 0.0, -turn, turn)


def law_attitude(q_body_from_orbit: Array, axes: LawAxes | None) -> Array:
    """The attitude of the axes that the laws count by, scalar first, (n, 4); 1 0 0 0 is the nominal one."""
    if axes is None:
        return q_body_from_orbit
    q_orbit_from_body = q_body_from_orbit * (1.0, -1.0, -1.0, -1.0)
    return relative(q_orbit_from_body, np.tile(axes.q_law_from_body, (len(q_body_from_orbit), 1)))


def law_vector(v_body: Array, axes: LawAxes | None) -> Array:
    """Vectors in the axes that the laws count by, (n, 3)."""
    return v_body if axes is None else v_body[:, axes.place] * np.array(axes.sign, dtype=np.float64)


def rotated(q: Array, v: Array) -> Array:
    """C(q) v of each row: components of vectors in the frame that the attitude leads to, (n, 3)."""
    q0, qv = q[:, :1], q[:, 1:]
    along = np.sum(qv * v, axis=1, keepdims=True)
    size = np.sum(qv * qv, axis=1, keepdims=True)
    result: Array = (q0 * q0 - size) * v + 2.0 * along * qv - 2.0 * q0 * np.cross(qv, v)
    return result


def angle_rad(turn: Array) -> Array:
    """The angle of each rotation, 0 to pi, (n,)."""
    result: Array = 2.0 * np.arctan2(np.linalg.norm(turn[:, 1:], axis=1), np.abs(turn[:, 0]))
    return result


def axis1_angle_rad(q_body_from_orbit: Array) -> Array:
    """The angle between axis 1 and the radius, (n,)."""
    q0, q1, q2, q3 = q_body_from_orbit.T
    sine = 2.0 * np.hypot(q1 * q2 + q0 * q3, q1 * q3 - q0 * q2)
    cosine = q0**2 + q1**2 - q2**2 - q3**2
    result: Array = np.arctan2(sine, cosine)
    return result


def normal_in_body(q_body_from_orbit: Array) -> Array:
    """The orbit normal in body axes, the third column of C, (n, 3)."""
    q0, q1, q2, q3 = q_body_from_orbit.T
    return np.stack(
        (2.0 * (q1 * q3 - q0 * q2), 2.0 * (q2 * q3 + q0 * q1), q0**2 - q1**2 - q2**2 + q3**2), axis=1
    )


def rotation_vectors(turn: Array) -> Array:
    """Angle times axis of quaternions whose scalar part is at least 0, (n, 3), rad."""
    angle, vector = angle_rad(turn), turn[:, 1:]
    size = np.linalg.norm(vector, axis=1)
    factor = np.divide(angle, size, out=np.full_like(angle, 2.0), where=size > 0.0)
    result: Array = factor[:, None] * vector
    return result


def errors(q: Array) -> Array:
    """The rotation vector from nominal to each attitude, (n, 3), rad, body axes."""
    return rotation_vectors(relative(np.tile((1.0, 0.0, 0.0, 0.0), (len(q), 1)), q))


def axis1_errors(q: Array) -> Array:
    """The rotation vector from body axis 1 to the vertical, (n, 3), rad, body axes; 0 about axis 1."""
    q0, q1, q2, q3 = q.T
    across = np.stack((np.zeros_like(q0), -2.0 * (q1 * q3 + q0 * q2), 2.0 * (q1 * q2 - q0 * q3)), axis=1)
    size = np.linalg.norm(across, axis=1)
    factor = np.divide(axis1_angle_rad(q), size, out=np.zeros_like(size), where=size > 0.0)
    result: Array = factor[:, None] * across
    return result
