"""Attitude algebra on histories: arrays of quaternions, shape (n, 4), scalar first, v_body = C(q) v_ref."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def relative(q_from: Array, q_to: Array) -> Array:
    """conj(q_from) (x) q_to: the rotation from the first attitude to the second, scalar part >= 0, (n, 4)."""
    p0, p = q_from[:, :1], -q_from[:, 1:]
    q0, q = q_to[:, :1], q_to[:, 1:]
    scalar = p0 * q0 - np.sum(p * q, axis=1, keepdims=True)
    vector = p0 * q + q0 * p + np.cross(p, q)
    turn = np.hstack((scalar, vector))
    return np.where(scalar < 0.0, -turn, turn)


def angle_rad(turn: Array) -> Array:
    """The angle of each turn, 0 to pi, (n,)."""
    result: Array = 2.0 * np.arctan2(np.linalg.norm(turn[:, 1:], axis=1), np.abs(turn[:, 0]))
    return result


def axis1_angle_rad(q_body_from_orbit: Array) -> Array:
    """The angle between body axis 1 and the radius, (n,)."""
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
