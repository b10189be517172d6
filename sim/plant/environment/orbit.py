"""Orbits: position and velocity in the inertial frame ``eci`` (TEME of date) for many times at once."""

from typing import Protocol

import numpy as np
import numpy.typing as npt
from sgp4.api import SGP4_ERRORS, Satrec
from sgp4.io import verify_checksum

from sim.plant.config import OrbitConfig

Array = npt.NDArray[np.float64]

MU_M3PS2 = 3.986004418e14
EARTH_RADIUS_M = 6378.137e3
DAY_S = 86400
MOST_AXIS_PART = 0.05
"""By so much the semi-major axis may leave that of the mean motion, as it does after a decay."""
UNIX_EPOCH_JD = 2440587.5


class Orbit(Protocol):
    """A motion of the mass centre."""

    def at(self, t_s: Array) -> tuple[Array, Array]:
        """Position [m] and velocity [m/s], each (n, 3), frame ``eci``, at n times [s] since the epoch."""


class CircularOrbit:
    """Keplerian circle: r = a (p cos u + q sin u), u = u0 + sqrt(mu / a^3) t.

    p points to the ascending node, q is normal to it in the direction of motion.
    """

    def __init__(self, config: OrbitConfig) -> None:
        self._radius_m = EARTH_RADIUS_M + config.altitude_m
        self._rate_radps = np.sqrt(MU_M3PS2 / self._radius_m**3)
        self._u0_rad = config.u0_rad
        self.mean_speed_mps = float(self._radius_m * self._rate_radps)
        ci, si = np.cos(config.inclination_rad), np.sin(config.inclination_rad)
        co, so = np.cos(config.raan_rad), np.sin(config.raan_rad)
        self._p = np.array([co, so, 0.0])
        self._q = np.array([-so * ci, co * ci, si])

    def at(self, t_s: Array) -> tuple[Array, Array]:
        """Position and velocity, as in ``Orbit``."""
        u = self._u0_rad + self._rate_radps * t_s
        cos_u, sin_u = np.cos(u)[:, None], np.sin(u)[:, None]
        r_eci_m = self._radius_m * (cos_u * self._p + sin_u * self._q)
        v_eci_mps = self._radius_m * self._rate_radps * (cos_u * self._q - sin_u * self._p)
        return r_eci_m, v_eci_mps


class Sgp4Orbit:
    """SGP4 over a two-line element set.

    Args:
        tle: the two lines.
        epoch_unix_s: the time that t = 0 stands for.

    Raises:
        ValueError: a line is malformed or its checksum is wrong.
    """

    def __init__(self, tle: tuple[str, str], epoch_unix_s: int) -> None:
        self._satellite = _satellite(tle)
        self.mean_speed_mps = float((MU_M3PS2 * self._satellite.no_kozai / 60.0) ** (1.0 / 3.0))
        """(mu n)^(1/3) of the mean motion n."""
        days, self._second = divmod(epoch_unix_s, DAY_S)
        self._day_jd = UNIX_EPOCH_JD + days

    def at(self, t_s: Array) -> tuple[Array, Array]:
        """Position and velocity, as in ``Orbit``.

        Raises:
            ValueError: SGP4 finds no orbit at one of the times, for instance after its decay.
        """
        fraction = (self._second + t_s) / DAY_S
        errors, r_km, v_kmps = self._satellite.sgp4_array(np.full_like(t_s, self._day_jd), fraction)
        if errors.any():
            first = int(np.flatnonzero(errors)[0])
            raise ValueError(f"SGP4 at {t_s[first]:.0f} s after the epoch: {SGP4_ERRORS[int(errors[first])]}")
        inverse = 2.0 / np.linalg.norm(r_km, axis=1) - np.sum(v_kmps**2, axis=1) / self._satellite.mu
        mean_km = self._satellite.a * self._satellite.radiusearthkm
        off = ~(np.abs(1.0 - mean_km * inverse) <= MOST_AXIS_PART * mean_km * inverse)
        if off.any():
            first = int(np.flatnonzero(off)[0])
            raise ValueError(
                f"SGP4 at {t_s[first]:.0f} s after the epoch: its semi-major axis is no longer that of the "
                f"mean motion, {mean_km:.0f} km"
            )
        return 1e3 * r_km, 1e3 * v_kmps


class LeadingOrbit:
    """The motion on another orbit ``lead_s`` later: r(t + lead_s), v(t + lead_s).

    The errors of two-line elements are mainly along the track (Flohrer, Krag and Klinkrad 2008).
    """

    def __init__(self, orbit: Orbit, lead_s: float) -> None:
        self._orbit = orbit
        self._lead_s = lead_s

    def at(self, t_s: Array) -> tuple[Array, Array]:
        """Position and velocity, as in ``Orbit``."""
        return self._orbit.at(t_s + self._lead_s)


def make_orbit(config: OrbitConfig, epoch_unix_s: int) -> Orbit:
    """The configured orbit, with the satellite ``along_track_m`` ahead on it, at its mean speed."""
    orbit: CircularOrbit | Sgp4Orbit
    orbit = CircularOrbit(config) if config.tle is None else Sgp4Orbit(config.tle, epoch_unix_s)
    if not config.along_track_m:
        return orbit
    return LeadingOrbit(orbit, config.along_track_m / orbit.mean_speed_mps)


def _satellite(tle: tuple[str, str]) -> Satrec:
    """The table has checked the lines of a scenario; sgp4 itself accepts lines that are cut or swapped."""
    for number, line in enumerate(tle, start=1):
        if len(line) != 69 or not line.startswith(f"{number} "):
            raise ValueError(f"line {number} of the TLE is malformed")
    verify_checksum(*tle)
    return Satrec.twoline2rv(*tle)
