"""Controllability on the mean: whether coils alone can bring the linear motion to rest within an orbit.

At no instant can coils turn the satellite about the field, but the field turns along the orbit. The linear
motion x' = A x - J^-1 [B x] m of x = (Omega / w0, theta) is controllable over one orbit if its Gramian

    W = integral over u of P(u) B(u) B(u)^T P(u)^T,  P(u) = exp(A (2 pi - u)), B(u) = (-J^-1 [b x]; 0)

has no zero eigenvalue, b the direct dipole's field in units of B0 and J in units of its mean moment. The
least eigenvalue beside the greatest tells how much more effort the worst motion takes than the best one.

Source: Bhat, Dham 2003; Bhat 2005; Yang 2016, as in Ovchinnikov, Roldugin 2019, introduction [4, 5, 9].
"""

from math import pi

import numpy as np
from scipy.linalg import expm

from sim.design.theory.bodies import Body
from sim.design.theory.linear import dipole_field, free_motion, skew
from sim.value_types import Array

STEPS = 360
"""Of the integral, an orbit: the integrand is smooth and nearly periodic."""


def gramian(body: Body) -> Array:
    """The Gramian W over one orbit from u = 0, (6, 6)."""
    inertia = np.asarray(body.inertia_kgm2)
    turn = np.linalg.inv(inertia / (np.trace(inertia) / 3.0))
    u = np.linspace(0.0, 2.0 * pi, STEPS, endpoint=False) + pi / STEPS
    push = np.zeros((STEPS, 6, 3))
    push[:, :3] = -turn @ skew(dipole_field(u, body))
    step = expm(free_motion(body) * 2.0 * pi / STEPS)
    onward = expm(free_motion(body) * pi / STEPS)
    total = np.zeros((6, 6))
    for pushed in push[::-1]:  # from the last step to the first
        reached = onward @ pushed
        total += reached @ reached.T
        onward = onward @ step
    whole: Array = 2.0 * pi / STEPS * total
    return whole


def conditioning(body: Body) -> float:
    """Least over greatest eigenvalue of the Gramian: zero if there is a motion that no dipole stops."""
    values = np.linalg.eigvalsh(gramian(body))
    return float(max(0.0, values[0]) / values[-1])
