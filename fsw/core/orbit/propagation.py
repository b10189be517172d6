"""The orbit: SGP4 on a two-line element set or on elements from the ground, or a circular Kepler orbit."""

from dataclasses import dataclass, field
from math import cos, inf, isfinite, pi, radians, sin, sqrt
from typing import Any, Final

from sgp4.api import SGP4_ERRORS, WGS72, Satrec

from fsw.core.algebra.vector import Vec3, dot, norm
from fsw.core.orbit.earth import MU_M3PS2, RADIUS_M
from fsw.core.orbit.elements import Elements
from fsw.core.orbit.tle import DAY_MIN, DAY_S, UNIX_EPOCH_JD, read_tle

State = tuple[Vec3, Vec3]
"""Position (m) and velocity (m/s), both in eci."""

_SGP4_EPOCH_DAY = -7306.0
"""1949-12-31 in days since 1970-01-01."""

MOST_AXIS_PART: Final = 0.05
"""By so much the osculating semi-major axis may differ from that of the mean motion: perturbations move it by
less than 1 %, and SGP4 gets far beyond, without an error, around a decay."""


@dataclass(frozen=True, slots=True)
class TleOrbit:
    """A two-line element set and the propagator initialised from it."""

    line1: str
    line2: str
    satellite: Any = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ElementOrbit:
    """Elements from the ground and the propagator initialised from them."""

    elements: Elements
    satellite: Any = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class CircularKeplerOrbit:
    """A circular Kepler orbit: r = radius (node cos u + ahead sin u), u = u0 + rate (t - epoch)."""

    epoch_unix_s: float
    radius_m: float
    rate_radps: float
    u0_rad: float
    node_eci: Vec3
    ahead_eci: Vec3


Orbit = TleOrbit | ElementOrbit | CircularKeplerOrbit


def sgp4_orbit(line1: str, line2: str) -> TleOrbit:
    """The orbit of a two-line element set (Vallado et al. 2006, WGS-72 as the sets are made).

    Raises:
        ValueError: a line is malformed or its checksum wrong, the lines are of two satellites, SGP4 refuses
            the elements, or they are of a deep-space orbit, whose propagator remembers earlier calls, or
            lead through the Earth.
    """
    satellite = read_tle(line1, line2)
    _check_propagator(satellite, satellite.satnum_str)
    return TleOrbit(line1.rstrip(), line2.rstrip(), satellite)


def element_orbit(elements: Elements) -> ElementOrbit:
    """The orbit of elements from the ground (Vallado et al. 2006, WGS-72).

    Raises:
        ValueError: SGP4 refuses the elements, or they are of a deep-space orbit or lead through the Earth.
    """
    satellite = Satrec()
    satellite.sgp4init(
        WGS72,
        "i",
        0,
        elements.epoch_day - _SGP4_EPOCH_DAY + elements.epoch_fraction,
        elements.bstar,
        0.0,
        0.0,
        elements.eccentricity,
        radians(elements.perigee_deg),
        radians(elements.inclination_deg),
        radians(elements.anomaly_deg),
        elements.motion_revpday * 2.0 * pi / DAY_MIN,
        radians(elements.raan_deg),
    )
    _check_propagator(satellite, "the ground")
    return ElementOrbit(elements, satellite)


def _check_propagator(satellite: Any, name: str) -> None:  # noqa: ANN401  (of a library without types)
    error, _, _ = satellite.sgp4_tsince(0.0)
    if error:
        raise ValueError(f"SGP4 refuses the elements of {name}: {SGP4_ERRORS[error]}")
    if satellite.method != "n":
        raise ValueError(f"{name} takes 225 minutes or more an orbit: the field is for low orbits")
    if satellite.altp <= 0.0:
        raise ValueError(f"the perigee is {-satellite.altp:.3f} Earth radii below the ground")


def circular_orbit(
    altitude_km: float, inclination_deg: float, raan_deg: float, u0_deg: float, epoch_unix_s: float
) -> CircularKeplerOrbit:
    """The circular orbit at an altitude above 6378.137 km with the argument of latitude u0 at the epoch.

    Raises:
        ValueError: the orbit is not above the ground, or a number is not finite.
    """
    if not all(map(isfinite, (altitude_km, inclination_deg, raan_deg, u0_deg, epoch_unix_s))):
        raise ValueError("the elements of a circular orbit must be finite numbers")
    if altitude_km <= 0.0:
        raise ValueError(f"a circular orbit needs an altitude above 0 km, not {altitude_km:g}")
    radius_m = RADIUS_M + 1000.0 * altitude_km
    raan, inclination = radians(raan_deg), radians(inclination_deg)
    return CircularKeplerOrbit(
        epoch_unix_s=epoch_unix_s,
        radius_m=radius_m,
        rate_radps=sqrt(MU_M3PS2 / radius_m) / radius_m,
        u0_rad=radians(u0_deg),
        node_eci=(cos(raan), sin(raan), 0.0),
        ahead_eci=(-sin(raan) * cos(inclination), cos(raan) * cos(inclination), sin(inclination)),
    )


def state_eci(orbit: Orbit, unix_s: float) -> State | None:
    """Position (m) and velocity (m/s) in eci, or None where SGP4 has no valid answer (a decayed orbit)."""
    if isinstance(orbit, CircularKeplerOrbit):
        return _circular_state(orbit, unix_s)
    days, seconds = divmod(unix_s, DAY_S)
    error, r_km, v_kmps = orbit.satellite.sgp4(UNIX_EPOCH_JD + days, seconds / DAY_S)
    if error or not axis_holds(orbit.satellite, axis_km(orbit.satellite, r_km, v_kmps)):
        return None
    return (
        (1000.0 * r_km[0], 1000.0 * r_km[1], 1000.0 * r_km[2]),
        (1000.0 * v_kmps[0], 1000.0 * v_kmps[1], 1000.0 * v_kmps[2]),
    )


def axis_km(satellite: Any, r_km: Vec3, v_kmps: Vec3) -> float:  # noqa: ANN401  (of a library without types)
    """The osculating semi-major axis, 1 / (2 / r - v^2 / mu); infinite on an orbit that is not closed."""
    inverse = 2.0 / norm(r_km) - dot(v_kmps, v_kmps) / satellite.mu
    return 1.0 / inverse if inverse > 0.0 else inf


def mean_axis_km(satellite: Any) -> float:  # noqa: ANN401  (of a library without types)
    """The semi-major axis of the mean motion n at the epoch, (mu / n^2)^(1/3)."""
    return float(satellite.a * satellite.radiusearthkm)


def axis_holds(satellite: Any, osculating_km: float) -> bool:  # noqa: ANN401  (of a library without types)
    """Whether an osculating semi-major axis is still that of the elements."""
    mean_km = mean_axis_km(satellite)
    return abs(osculating_km - mean_km) <= MOST_AXIS_PART * mean_km


def _circular_state(orbit: CircularKeplerOrbit, unix_s: float) -> State:
    u = orbit.u0_rad + orbit.rate_radps * (unix_s - orbit.epoch_unix_s)
    x, y = orbit.radius_m * cos(u), orbit.radius_m * sin(u)
    n, a, w0 = orbit.node_eci, orbit.ahead_eci, orbit.rate_radps
    return (
        (n[0] * x + a[0] * y, n[1] * x + a[1] * y, n[2] * x + a[2] * y),
        (w0 * (a[0] * x - n[0] * y), w0 * (a[1] * x - n[1] * y), w0 * (a[2] * x - n[2] * y)),
    )
