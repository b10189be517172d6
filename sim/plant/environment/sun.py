"""Sun and eclipse, for many times at once."""

import numpy as np

from sim.plant.environment.earth import J2000_UNIX_S
from sim.plant.environment.orbit import DAY_S, EARTH_RADIUS_M, Array

AU_M = 149597870.7e3
SUN_RADIUS_M = 695700e3


def sun_eci_m(epoch_unix_s: int, t_s: Array) -> Array:
    """Geocentric position of the Sun [m], (n, 3), mean equator and equinox of date, taken as ``eci``.

    Low-precision formula of the Astronomical Almanac (page C5), good to 0.01 deg between 1950 and 2050.

    Args:
        epoch_unix_s: the time that t = 0 stands for.
        t_s: times since the epoch, shape (n,).
    """
    days = (epoch_unix_s - J2000_UNIX_S + t_s) / DAY_S
    anomaly = np.radians(357.528 + 0.9856003 * days)
    longitude = np.radians(
        280.460 + 0.9856474 * days + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2.0 * anomaly)
    )
    obliquity = np.radians(23.439 - 4e-7 * days)
    distance_m = AU_M * (1.00014 - 0.01671 * np.cos(anomaly) - 0.00014 * np.cos(2.0 * anomaly))
    sin_longitude = np.sin(longitude)
    direction = (np.cos(longitude), np.cos(obliquity) * sin_longitude, np.sin(obliquity) * sin_longitude)
    r_m: Array = distance_m[:, None] * np.stack(direction, axis=1)
    return r_m


def illumination(r_m: Array, sun_m: Array) -> Array:
    """Fraction 0..1 of the Sun's disc that a spherical Earth does not cover, (n,).

    The discs of Sun (a) and Earth (b), seen at the distance c, as planar circles: the overlap is
    a^2 acos(x/a) + b^2 acos((c - x)/b) - c y with x = (c^2 + a^2 - b^2) / 2c, y = sqrt(a^2 - x^2)
    (Montenbruck and Gill 2000, section 3.4.2).

    Args:
        r_m: geocentric positions, (n, 3).
        sun_m: geocentric positions of the Sun in the same frame, (n, 3).
    """
    to_sun_m = sun_m - r_m
    r_norm, to_sun_norm = np.linalg.norm(r_m, axis=1), np.linalg.norm(to_sun_m, axis=1)
    a = np.arcsin(SUN_RADIUS_M / to_sun_norm)
    b = np.arcsin(EARTH_RADIUS_M / r_norm)
    c = np.arccos(np.clip(-(r_m * to_sun_m).sum(axis=1) / (r_norm * to_sun_norm), -1.0, 1.0))
    free: Array = np.ones_like(c)
    nested = c <= np.abs(b - a)
    free[nested] = 1.0 - np.minimum(1.0, b[nested] / a[nested]) ** 2
    partial = ~nested & (c < a + b)
    a, b, c = a[partial], b[partial], c[partial]
    x = (c * c + a * a - b * b) / (2.0 * c)
    y = np.sqrt(a * a - x * x)
    overlap = a * a * np.arccos(x / a) + b * b * np.arccos((c - x) / b) - c * y
    free[partial] = 1.0 - overlap / (np.pi * a * a)
    return free
