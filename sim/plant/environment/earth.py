"""The Earth's rotation: Greenwich mean sidereal time, which turns ``eci`` (TEME) into Earth-fixed axes."""

import numpy as np

from sim.plant.environment.orbit import DAY_S, Array

J2000_UNIX_S = 946728000


def gmst82_rad(epoch_unix_s: int, t_s: Array) -> Array:
    """Greenwich mean sidereal time of 1982, UT1 = UTC, at times [s] since the epoch.

    Theta = 67310.54841 s + (876600 h + 8640184.812866 s) T + 0.093104 s T^2 - 6.2e-6 s T^3, T in Julian
    centuries of UT1 since J2000.0 (Aoki et al. 1982). Whole days are taken out first, so that a double
    holds the angle to 1e-11 rad.
    """
    days, second = divmod(epoch_unix_s - J2000_UNIX_S, DAY_S)
    fraction = (second + t_s) / DAY_S
    centuries = (days + fraction) / 36525.0
    turns = (
        fraction
        + (67310.54841 + 8640184.812866 * centuries + 0.093104 * centuries**2 - 6.2e-6 * centuries**3) / DAY_S
    )
    return 2.0 * np.pi * (turns % 1.0)


def turn_about_pole(angle_rad: Array, vectors: Array) -> Array:
    """R3(angle) v for n vectors (n, 3), R3(a) = [[cos a, sin a, 0], [-sin a, cos a, 0], [0, 0, 1]]."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = vectors.T
    return np.stack([c * x + s * y, c * y - s * x, z], axis=1)
