"""A 3U satellite with feathers, which the air holds by one axis."""

from dataclasses import dataclass
from math import sqrt

from sim.plant.config import PlateConfig
from sim.plant.dynamics.surfaces import drag
from sim.plant.rotation import Mat3, Vec3, transform
from sim.validate.review.law_flight import LawFlight

FEATHER, REAR_M = 0.5, 0.35
"""Sine of the angle by which a feather stands out to the flow, and its distance behind the mass centre."""


@dataclass(frozen=True, slots=True)
class Feathers:
    """Drag of four panels that stand out behind, in air of one density."""

    density_kgpm3: float = 4e-12

    def __call__(self, c_body_from_eci: Mat3, velocity_eci_mps: Vec3) -> Vec3:
        """The torque, body axes, N m; the air at rest in space."""
        return drag(_PLATES, transform(c_body_from_eci, velocity_eci_mps), self.density_kgpm3)


_OUT = sqrt(1.0 - FEATHER**2)
_PLATES = tuple(
    PlateConfig(0.03, (x * _OUT, FEATHER, z * _OUT), (0.05 * x, -REAR_M, 0.05 * z))
    for x, z in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
)

SHUTTLECOCK = LawFlight(
    "direction_tracking",
    ((0.040, 0.0, 0.0), (0.0, 0.012, 0.0), (0.0, 0.0, 0.042)),
    k_w=1e5,
    k_a=20.0,
    rotation_rad=(0.2, 0.5, -0.3),
    relative=True,
    omega_body_radps=(0.001, 0.001, -0.001),
    orbits=4.0,
    altitude_km=400.0,
    inclination_deg=80.0,
    extra=Feathers(),
    known=False,
)
"""A 3U satellite with four feathers, its long axis 2 ahead."""
