"""Satellites to design for: inertia and a circular orbit in the field of the direct dipole."""

from dataclasses import dataclass
from math import sqrt

from sim.value_types import Vec3

Mat3 = tuple[Vec3, Vec3, Vec3]
"""Rows."""

MU_M3PS2 = 3.986004418e14
EARTH_RADIUS_KM = 6378.137
DIPOLE_TM3 = 7.812e15
"""The Earth's magnetic moment, mu_e, as in Ovchinnikov, Roldugin, Ivanov, Penkov 2015."""


@dataclass(frozen=True, slots=True)
class Body:
    """A satellite on a circular orbit.

    Attributes:
        name: its name.
        inertia_kgm2: rows of the inertia tensor, body axes; nominal attitude is body = orbit, with axis 1 the
            radius, 2 along-track, 3 the orbit's normal.
        altitude_km: above 6378.137 km.
        inclination_deg: to the equator.
        wheel_nms: constant angular momentum of wheels, body axes.
    """

    name: str
    inertia_kgm2: Mat3
    altitude_km: float
    inclination_deg: float
    wheel_nms: Vec3 = (0.0, 0.0, 0.0)

    @property
    def rate_radps(self) -> float:
        """The orbit's angular rate, w0 = sqrt(mu / r^3)."""
        return sqrt(MU_M3PS2 / self._radius_m**3)

    @property
    def field_t(self) -> float:
        """The dipole's field above the equator, B0 = mu_e / r^3."""
        return DIPOLE_TM3 / self._radius_m**3

    @property
    def _radius_m(self) -> float:
        return 1e3 * (EARTH_RADIUS_KM + self.altitude_km)


def diagonal(moments_kgm2: Vec3) -> Mat3:
    """The tensor of three principal moments along the body axes."""
    a, b, c = moments_kgm2
    return ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c))


BODIES = tuple(
    Body(name, diagonal(moments_kgm2), altitude_km, inclination_deg)
    for name, moments_kgm2, altitude_km, inclination_deg in (
        ("1U", (0.011, 0.012, 0.013), 550.0, 97.6),
        ("3U", (0.0067, 0.033, 0.0335), 550.0, 97.6),
        ("50 kg", (1.02, 1.85, 1.95), 800.0, 98.6),
        ("100 kg", (5.0, 6.0, 7.0), 600.0, 97.8),
        ("few tons", (1500.0, 3000.0, 3500.0), 700.0, 98.2),
        ("boom", (1.0, 113.0, 113.5), 800.0, 98.6),
    )
)
"""Bodies that the gravity gradient holds (C > B > A); their moments are assumed."""

UNSTABLE_BODIES = tuple(
    Body(name, diagonal(moments_kgm2), altitude_km, inclination_deg)
    for name, moments_kgm2, altitude_km, inclination_deg in (
        ("1U, gravity gradient unstable", (0.013, 0.012, 0.011), 550.0, 97.6),
        ("50 kg, gravity gradient unstable", (1.95, 1.85, 1.02), 800.0, 98.6),
        ("few tons, gravity gradient unstable", (3500.0, 3000.0, 1500.0), 700.0, 98.2),
    )
)
"""The same bodies turned so that the gravity gradient turns them over (A > B > C)."""
