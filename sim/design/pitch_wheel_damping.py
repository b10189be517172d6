"""How fast rate damping brings a satellite with a pitch wheel to rest, in closed form.

The dipole is m = -k_w b x Omega on a circular orbit in the direct dipole's field, the principal moments are
A, B, C along the axes 1, 2, 3, and a wheel h is along axis 3. Over an orbit the mean torque is
-k w0 diag(d1, d2, d3) Omega,

    k = k_w B0^2 / w0,   d1 = sin^2 i / 2 + cos^2 i,   d2 = 2 sin^2 i + cos^2 i,   d3 = 5/2 sin^2 i,

with i the inclination: no products are left on the mean. With eta = h / w0 + C the motion over the argument
of latitude u is, apart from it,

    pitch:     C pitch'' + 3 (B - A) pitch = 0
    yaw, roll: A yaw'' + g roll' + a yaw = 0,   B roll'' - g yaw' + c roll = 0
               g = eta - A - B,   a = eta - B,   c = eta - A + 3 (C - A)

whose frequencies n are the roots of A B n^4 - (A c + B a + g^2) n^2 + a c = 0: precession, near one for a
strong wheel, and nutation. To first order in k each mode decays by

    pitch:  -k d3 / (2 C)
    others: -k [d1 (c - B n^2) + d2 (a - A n^2)] / [2 (A c + B a + g^2) - 4 A B n^2]        per rad of u.

A strong wheel makes the precession slow, -k (d1 + d2) / (2 eta), and leaves the nutation at
-k (d1 / A + d2 / B) / 2. This holds where no frequency is one: the torque changes with 2 u.

Source: Ovchinnikov, Penkov, Roldugin, Varatharajoo, Ryabikov 2017 gives such expressions, as Ovchinnikov,
Roldugin 2019, section 2.2, says without printing them; these are derived here by averaging.
"""

from math import cos, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from sim.design.theory.bodies import Body


class ModeDecays(NamedTuple):
    """Degrees of stability of the three modes, per radian of u; negative: it decays."""

    pitch: float
    precession: float
    nutation: float


def convergence(body: Body, k_w: float) -> ModeDecays:
    """The decay of each mode under rate damping.

    Args:
        body: principal axes along the body's, wheel along axis 3, or none.
        k_w: N m s / T^2.

    Raises:
        ValueError: the body axes are not principal, the wheel is not along axis 3, or a mode does not swing.
    """
    moments = np.diag(np.asarray(body.inertia_kgm2))
    if np.any(np.asarray(body.inertia_kgm2) != np.diag(moments)):
        raise ValueError(f"{body.name}: the body axes must be principal")
    if body.wheel_nms[0] != 0.0 or body.wheel_nms[1] != 0.0:
        raise ValueError(f"{body.name}: the wheel must be along axis 3")
    a_moment, b_moment, c_moment = map(float, moments)
    k = float(k_w * body.field_t**2 / body.rate_radps)
    d1, d2, d3 = _mean_damping(body.inclination_deg)
    eta = body.wheel_nms[2] / body.rate_radps + c_moment
    g, yaw, roll = eta - a_moment - b_moment, eta - b_moment, eta - a_moment + 3.0 * (c_moment - a_moment)
    total, product = a_moment * roll + b_moment * yaw + g * g, a_moment * b_moment
    discriminant = total * total - 4.0 * product * yaw * roll
    if not (b_moment > a_moment and yaw * roll > 0.0 and total > 0.0 and discriminant > 0.0):
        raise ValueError(f"{body.name}: the motion without coils is not stable")

    def decay(square: float) -> float:
        driven = d1 * (roll - b_moment * square) + d2 * (yaw - a_moment * square)
        return -k * driven / (2.0 * total - 4.0 * product * square)

    fast = (total + sqrt(discriminant)) / (2.0 * product)
    return ModeDecays(-k * d3 / (2.0 * c_moment), decay(yaw * roll / (product * fast)), decay(fast))


def _mean_damping(inclination_deg: float) -> tuple[float, float, float]:
    """The diagonal of the mean of |B|^2 E - B B^T, in units of B0^2."""
    across, along = sin(radians(inclination_deg)) ** 2, cos(radians(inclination_deg)) ** 2
    return 0.5 * across + along, 2.0 * across + along, 2.5 * across
