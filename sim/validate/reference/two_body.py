"""Keplerian motion in closed form, for histories that were computed with it."""

import numpy as np

from sim.value_types import Array

_ROUNDS = 50


def two_body(r0_m: Array, v0_mps: Array, mu_m3ps2: float, t_s: Array) -> Array:
    """Positions [m], (n, 3), at times from the start, by Lagrange's f and g.

    n t = x - (1 - r0/a) sin x + (r0.v0 / sqrt(mu a)) (1 - cos x) gives the change x of the eccentric anomaly
    (Battin 1999, section 4.3), solved by Newton's method.

    Raises:
        ValueError: the orbit is not closed.
    """
    radius = float(np.linalg.norm(r0_m))
    a = 1.0 / (2.0 / radius - float(v0_mps @ v0_mps) / mu_m3ps2)
    if not 0.0 < a < np.inf:
        raise ValueError("the orbit is not closed")
    rate = np.sqrt(mu_m3ps2 / a**3)
    cosine, sine = 1.0 - radius / a, float(r0_m @ v0_mps) / np.sqrt(mu_m3ps2 * a)
    mean = rate * t_s
    x = mean.copy()
    for _ in range(_ROUNDS):
        error = x - cosine * np.sin(x) + sine * (1.0 - np.cos(x)) - mean
        change = error / (1.0 - cosine * np.cos(x) + sine * np.sin(x))
        x -= change
        if np.abs(change).max(initial=0.0) < 1e-14 * max(1.0, float(np.abs(mean).max(initial=0.0))):
            break
    f = 1.0 - a / radius * (1.0 - np.cos(x))
    g = t_s - (x - np.sin(x)) / rate
    r_m: Array = f[:, None] * r0_m + g[:, None] * v0_mps
    return r_m
