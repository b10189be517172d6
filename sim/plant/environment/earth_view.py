"""The Earth's light on small plates, by integration over the part of the Earth that is in view."""

from math import pi, sqrt

import numpy as np

from sim.plant.environment.orbit import EARTH_RADIUS_M, Array
from sim.plant.rotation import Vec3

RINGS, SECTORS = 8, 12
"""Patches of equal solid angle: within 0.01 of the integral, for plates in any attitude."""

_ANGLES = 2.0 * np.pi * (np.arange(SECTORS) + 0.5) / SECTORS
_COSINES, _SINES = np.tile(np.cos(_ANGLES), RINGS), np.tile(np.sin(_ANGLES), RINGS)
_PLACES = np.repeat((np.arange(RINGS) + 0.5) / RINGS, SECTORS)


def earth_view(r_eci_m: Vec3, sun_eci: Vec3, normals_eci: Array) -> Array:
    """Light of a diffuse Earth that reflects all, relative to the Sun's, on plates with these normals, (n,).

    The sum over patches of the solid angle, in the direction d, of max(0, p . s) max(0, n . d) / pi, p being
    the vertical there: each part of the Earth is as bright as the sine of the Sun's elevation there.

    Args:
        r_eci_m: position of the satellite.
        sun_eci: unit vector s to the Sun.
        normals_eci: outward unit normals n, (n, 3).
    """
    r = np.array(r_eci_m)
    distance_m = sqrt(r @ r)
    up, s = r / distance_m, np.array(sun_eci)
    ratio = EARTH_RADIUS_M / distance_m
    edge = sqrt(1.0 - ratio * ratio)
    if up @ s <= -edge:  # the Sun has set on all of the Earth in view
        return np.zeros(len(normals_eci))
    across, third = _horizontal(up.tolist())
    down = 1.0 - (1.0 - edge) * _PLACES
    aside = np.sqrt(1.0 - down * down)
    towards = np.outer(aside * _COSINES, across) + np.outer(aside * _SINES, third) - np.outer(down, up)
    reach = down / ratio - np.sqrt(np.maximum(0.0, 1.0 - (aside / ratio) ** 2))
    verticals = up / ratio + reach[:, None] * towards
    solid = 2.0 * pi * (1.0 - edge) / len(down)
    bright = np.maximum(0.0, verticals @ s) * (solid / pi)
    light: Array = bright @ np.maximum(0.0, towards @ normals_eci.T)
    return light


def _horizontal(up: list[float]) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to ``up`` and to each other."""
    x, y, z = up
    if abs(x) < 0.7:
        size = sqrt(y * y + z * z)
        across = (0.0, z / size, -y / size)
    else:
        size = sqrt(x * x + z * z)
        across = (-z / size, 0.0, x / size)
    a, b, c = across
    return np.array(across), np.array((y * c - z * b, z * a - x * c, x * b - y * a))
