"""Sunlight that the Earth reflects, at the satellite."""

from sim.plant.environment.orbit import EARTH_RADIUS_M
from sim.plant.rotation import Vec3

ALBEDO = 0.3
"""Fraction of sunlight that the Earth reflects on average; 0.05 over open ocean, 0.6 over high clouds or ice
(ECSS-E-ST-10-04C, annex F)."""


def earthlight(r_eci_m: Vec3, sun_eci: Vec3) -> Vec3:
    """Vector a = -A (R / r)^2 max(0, e . s) e, e = r / |r|: Earth's light relative to the Sun's, ``eci``.

    The vector of irradiance, towards its source: a plate with the normal n that sees all of the Earth gets
    the fraction n . a of what it would get if it faced the Sun. (R / r)^2 is the view factor of the Earth
    from a plate that faces it; the illumination of all of the Earth in view is taken as that below the
    satellite. There is none if the Sun has set there, hence none in eclipse.

    The integral over a diffuse Earth, computed in its test, is within 0.02 of it, and deflects a measured Sun
    direction by at most 0.6 deg more, between 500 and 800 km. A diffuse Earth is also the model of Flatley
    and Moore 1994 (NASA TM-104596). With measured reflectivity it depends on the place as well (Bhanderi and
    Bak 2005, Modeling Earth Albedo for Satellites in Earth Orbit).

    Args:
        r_eci_m: position of the satellite.
        sun_eci: unit vector s to the Sun.
    """
    (x, y, z), (sx, sy, sz) = r_eci_m, sun_eci
    r2_m2 = x * x + y * y + z * z
    towards_m = max(0.0, x * sx + y * sy + z * sz)
    factor = -ALBEDO * EARTH_RADIUS_M**2 * towards_m / (r2_m2 * r2_m2)
    return (factor * x, factor * y, factor * z)
