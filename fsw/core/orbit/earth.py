"""The Earth's constants and its rotation.

The inertial frame ``eci`` is TEME of date; ``ecef`` follows from it by one turn about the third axis.
"""

from math import cos, pi, sin
from typing import Final

from fsw.core.algebra.vector import Vec3

MU_M3PS2: Final = 3.986004418e14
RADIUS_M: Final = 6378137.0
DIPOLE_TM3 = 7.812e15
"""mu_e of the direct dipole, whose axis is the rotation axis."""

_J2000_UNIX_S = 946728000.0
_DAY_S = 86400.0


def days_since_j2000(unix_s: float) -> float:
    """Days of UTC, taken as UT1, since 2000-01-01 12:00."""
    return (unix_s - _J2000_UNIX_S) / _DAY_S


def gmst82_rad(unix_s: float) -> float:
    """Greenwich mean sidereal time (Aoki et al. 1982), with UT1 = UTC, in [0, 2 pi).

    With T in Julian centuries of UT1 since J2000 and whole days dropped before they cost precision:
    gmst_s = 67310.54841 + (seconds since noon) + 8640184.812866 T + 0.093104 T^2 - 6.2e-6 T^3.
    """
    since_noon_s = (unix_s - _J2000_UNIX_S) % _DAY_S
    t = days_since_j2000(unix_s) / 36525.0
    gmst_s = 67310.54841 + since_noon_s + t * (8640184.812866 + t * (0.093104 - 6.2e-6 * t))
    return 2.0 * pi * ((gmst_s / _DAY_S) % 1.0)


def rotate_about_pole(angle_rad: float, v: Vec3) -> Vec3:
    """R3(angle) v, in axes turned by the angle: R3(gmst) is ecef from eci, R3(-gmst) the inverse."""
    c, s = cos(angle_rad), sin(angle_rad)
    return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])
