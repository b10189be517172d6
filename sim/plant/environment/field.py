"""The geomagnetic field in the inertial frame ``eci``, for many points at once."""

from typing import Protocol

import numpy as np

from sim.plant.config import FieldConfig
from sim.plant.environment.earth import gmst82_rad, turn_about_pole
from sim.plant.environment.igrf import Igrf
from sim.plant.environment.orbit import Array

DIPOLE_TM3 = 7.812e15


class Field(Protocol):
    """A model of the geomagnetic field."""

    def at(self, t_s: Array, r_eci_m: Array) -> Array:
        """The field [T], (n, 3), at n times [s] since the epoch and positions (n, 3), all in ``eci``."""


class RotatingIgrf:
    """IGRF-14 up to ``degree``, turned with the Earth by GMST82.

    Args:
        degree: highest degree; 1 is the tilted dipole.
        epoch_unix_s: the time that t = 0 stands for.
    """

    def __init__(self, degree: int, epoch_unix_s: int) -> None:
        self._igrf = Igrf(degree)
        self._epoch_unix_s = epoch_unix_s

    def at(self, t_s: Array, r_eci_m: Array) -> Array:
        """The field, as in ``Field``."""
        angle_rad = gmst82_rad(self._epoch_unix_s, t_s)
        b_ecef_t = self._igrf.at(self._epoch_unix_s + t_s, turn_about_pole(angle_rad, r_eci_m))
        return turn_about_pole(-angle_rad, b_ecef_t)


class DirectDipole:
    """Dipole along the Earth's axis: B = (mu_e / r^3) (k - 3 (k . e) e), e = r/|r|, k = +z of ``eci``."""

    def at(self, t_s: Array, r_eci_m: Array) -> Array:
        """The field, as in ``Field``."""
        r_m = np.sqrt((r_eci_m * r_eci_m).sum(axis=1))[:, None]
        e = r_eci_m / r_m
        b_eci_t: Array = DIPOLE_TM3 / r_m**3 * (np.array([0.0, 0.0, 1.0]) - 3.0 * e[:, 2:] * e)
        return b_eci_t


def make_field(config: FieldConfig, epoch_unix_s: int) -> Field:
    """The configured field."""
    if config.model == "direct_dipole":
        return DirectDipole()
    return RotatingIgrf(1 if config.model == "tilted_dipole" else config.degree, epoch_unix_s)
