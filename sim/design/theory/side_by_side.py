"""Many flights side by side, one a row of x = (q, omega): quaternion from a frame to the body, body rate."""

from collections.abc import Callable

import numpy as np

from sim.value_types import Array


def in_body(q: Array, v: Array) -> Array:
    """C(q) v = v - 2 q0 qv x v + 2 qv x (qv x v), (n, 3)."""
    q0, qv = q[:, :1], q[:, 1:4]
    twice = 2.0 * np.cross(v, qv)
    turned: Array = v + q0 * twice - np.cross(qv, twice)
    return turned


def quaternion_rate(q: Array, omega_radps: Array) -> Array:
    """dq/dt at a rate relative to the frame, body axes; (n, 4)."""
    q0, qv = q[:, :1], q[:, 1:4]
    q0_rate = -0.5 * np.sum(qv * omega_radps, axis=1, keepdims=True)
    return np.concatenate([q0_rate, 0.5 * (q0 * omega_radps + np.cross(qv, omega_radps))], axis=1)


def angle_deg(x: Array) -> Array:
    """From the frame to the body, (n,)."""
    angle: Array = np.degrees(2.0 * np.arctan2(np.linalg.norm(x[:, 1:4], axis=1), np.abs(x[:, 0])))
    return angle


def step(rates: Callable[[Array, Array], Array], x: Array, fields_t: Array, h_s: float) -> Array:
    """Runge-Kutta of fourth order.

    Args:
        rates: dx/dt of x in a field, T, axes of the frame.
        x: before.
        fields_t: at the start, in the middle and at the end, (3, 3).
        h_s: length of the step.
    """
    start, middle, end = fields_t
    k1 = rates(x, start)
    k2 = rates(x + 0.5 * h_s * k1, middle)
    k3 = rates(x + 0.5 * h_s * k2, middle)
    k4 = rates(x + h_s * k3, end)
    moved = x + h_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    moved[:, :4] /= np.linalg.norm(moved[:, :4], axis=1)[:, None]
    return moved
