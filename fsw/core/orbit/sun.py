"""The direction of the Sun, and whether it lights a satellite."""

from math import cos, radians, sin

from fsw.core.algebra.vector import ZERO, Vec3, add, dot, is_zero, norm, scale, sub
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


def earthlight_eci(r_eci_m: Vec3, sun_eci: Vec3) -> Vec3:
    """The light of an Earth that reflects all, relative to the Sun's: -(R / r)^2 max(0, e . s) e.

    It comes from the point below the satellite, e being the radius direction: a Sun sensor whose cells vary
    with the cosine of the incidence sees the sum of this and the Sun's (Bhanderi and Bak 2005, Modeling Earth
    Albedo for Satellites in Earth Orbit).
    """
    square_m2, along_m = dot(r_eci_m, r_eci_m), dot(r_eci_m, sun_eci)
    return scale(-RADIUS_M * RADIUS_M * max(0.0, along_m) / (square_m2 * square_m2), r_eci_m)


def apparent_sun(r_eci_m: Vec3, sun_eci: Vec3, albedo: float) -> tuple[Vec3, Vec3]:
    """What a Sun sensor takes for the Sun, u = unit(s + albedo a), and its derivative by the albedo; eci.

    a is the light of an Earth that reflects all.
    """
    a = earthlight_eci(r_eci_m, sun_eci)
    if is_zero(a):
        return sun_eci, ZERO
    light = add(sun_eci, scale(albedo, a))
    factor = 1.0 / norm(light)
    u = scale(factor, light)
    return u, scale(factor, sub(a, scale(dot(u, a), u)))
