"""The direction of the Sun, and whether it lights a satellite."""

from math import cos, radians, sin

from fsw.core.algebra.vector import Vec3, dot
from fsw.core.orbit.earth import RADIUS_M, days_since_j2000


def sun_eci(unix_s: float) -> Vec3:
    """The unit vector from the Earth to the Sun, mean equator and equinox of date, taken as eci.

    Mean longitude L, mean anomaly g, ecliptic longitude = L + 1.915 deg sin g + 0.020 deg sin 2g; good to
    0.01 deg from 1950 to 2050 (Astronomical Almanac, low-precision formulas for the Sun).
    """
    days = days_since_j2000(unix_s)
    anomaly = radians(357.528 + 0.9856003 * days)
    sine, cosine = sin(anomaly), cos(anomaly)
    longitude = radians(280.460 + 0.9856474 * days + sine * (1.915 + 0.040 * cosine))
    obliquity = radians(23.439 - 4.0e-7 * days)
    across = sin(longitude)
    return (cos(longitude), cos(obliquity) * across, sin(obliquity) * across)


def lit(r_eci_m: Vec3, sun_eci: Vec3, radius_m: float = RADIUS_M) -> bool:
    """Whether the satellite is outside the Earth's cylindrical shadow, whose edge is mid-penumbra.

    With a smaller radius: whether it may be outside, allowing for the uncertainty of the edge.
    """
    along = dot(r_eci_m, sun_eci)
    return along >= 0.0 or dot(r_eci_m, r_eci_m) - along * along > radius_m * radius_m
