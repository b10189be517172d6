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


class Storm:
    """A field with that of a geomagnetic storm: currents above the auroral zones, and a ring far away.

    Above 50 deg of geomagnetic latitude, in full from 60 deg on, pulsations about three axes with periods of
    7, 4 and 11 min, of the class Pc 5 and longer (Jacobs et al. 1964); everywhere a fifth of that along -z,
    against the dipole, as of the ring current (Daglis et al. 1999).

    Args:
        quiet: the field without it.
        amplitude_t: of each pulsation.
    """

    def __init__(self, quiet: Field, amplitude_t: float) -> None:
        self._quiet = quiet
        self._amplitude_t = amplitude_t

    def at(self, t_s: Array, r_eci_m: Array) -> Array:
        """The field, as in ``Field``."""
        b_eci_t = self._quiet.at(t_s, r_eci_m)
        r_m, b_t = np.linalg.norm(r_eci_m, axis=1), np.linalg.norm(b_eci_t, axis=1)
        dip_rad = np.arcsin(np.clip(np.abs((r_eci_m * b_eci_t).sum(axis=1)) / (r_m * b_t), 0.0, 1.0))
        latitude_deg = np.degrees(np.arctan(0.5 * np.tan(dip_rad)))
        part = np.clip((latitude_deg - 50.0) / 10.0, 0.0, 1.0)
        waves = [np.sin(2.0 * np.pi * t_s / period_s + phase) for period_s, phase in PULSATIONS]
        ring = np.array([0.0, 0.0, -RING_PART])
        storm_t: Array = self._amplitude_t * (part[:, None] * np.stack(waves, axis=1) + ring)
        return b_eci_t + storm_t


PULSATIONS = ((420.0, 0.0), (240.0, 0.7), (660.0, 2.0))
"""Period and phase about each axis, s and rad."""
RING_PART = 0.2


def make_field(config: FieldConfig, epoch_unix_s: int) -> Field:
    """The configured field."""
    quiet: Field
    if config.model == "direct_dipole":
        quiet = DirectDipole()
    else:
        quiet = RotatingIgrf(1 if config.model == "tilted_dipole" else config.degree, epoch_unix_s)
    return Storm(quiet, config.storm_t) if config.storm_t else quiet
