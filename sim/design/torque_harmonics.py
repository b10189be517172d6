"""A disturbance torque as functions of the argument of latitude, at once and twice the orbital rate.

    T(u) = c0 + c1 cos u + c2 sin u + c3 cos 2u + c4 sin 2u,   c by least squares

is what a periodic regulator can know of the disturbances ahead. The torque of a residual dipole on the
nominal attitude, d x B, has no more than c0, c1, c2 in the direct dipole's field, and little more in the
true one.

Source: Pittelkau 1993, as in Ovchinnikov, Roldugin 2019, section 2.2.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from fsw.core.laws.mpc_simple_field import harmonics
from sim.value_types import Array

FUNCTIONS = 5
"""All of them."""


class Harmonics(NamedTuple):
    """The coefficients c, (count, 3), and the root mean square of what they leave over that of the torque."""

    coefficients_nm: Array
    left: float


def fit(u_rad: Array, torque_nm: Array, count: int = FUNCTIONS) -> Harmonics:
    """The first ``count`` functions fitted to a torque.

    Args:
        u_rad: arguments of latitude, (n,).
        torque_nm: torque there, (n, 3), not zero throughout.
        count: 1: a constant; 3: once the orbital rate too; 5: all.
    """
    shapes = harmonics(u_rad)[:, :count]
    coefficients = np.asarray(np.linalg.lstsq(shapes, torque_nm, rcond=None)[0], dtype=np.float64)
    left = float(np.linalg.norm(torque_nm - shapes @ coefficients) / np.linalg.norm(torque_nm))
    return Harmonics(coefficients, left)


def orbit(points: int = 360) -> Array:
    """Arguments of latitude over an orbit, rad."""
    return 2.0 * pi / points * np.arange(points, dtype=np.float64)
