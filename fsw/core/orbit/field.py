"""The onboard models of the geomagnetic field, in inertial axes."""

from dataclasses import dataclass
from enum import Enum

from fsw.core.algebra.vector import Vec3, dot, norm
from fsw.core.orbit.earth import DIPOLE_TM3, gmst82_rad, rotate_about_pole
from fsw.core.orbit.igrf import FieldModel, field_ecef_t, prepare
from fsw.core.orbit.igrf_coefficients import MAX_DEGREE


class FieldKind(Enum):
    """The onboard field model."""

    IGRF14 = "igrf14"
    TILTED_DIPOLE = "tilted_dipole"
    DIRECT_DIPOLE = "direct_dipole"


@dataclass(frozen=True, slots=True)
class OnboardField:
    """A field ready to be evaluated; ``model`` is None for the direct dipole."""

    kind: FieldKind
    model: FieldModel | None


def prepare_field(kind: FieldKind, epoch_unix_s: float, degree: int = MAX_DEGREE) -> OnboardField:
    """The field of a flight that begins at the epoch; the tilted dipole is IGRF-14 of degree 1.

    Raises:
        ValueError: the epoch is outside 2015 to 2030, or the degree outside 1 to ``MAX_DEGREE``.
    """
    match kind:
        case FieldKind.IGRF14:
            return OnboardField(kind, prepare(epoch_unix_s, degree))
        case FieldKind.TILTED_DIPOLE:
            return OnboardField(kind, prepare(epoch_unix_s, degree=1))
        case FieldKind.DIRECT_DIPOLE:
            return OnboardField(kind, None)


def field_eci_t(field: OnboardField, r_eci_m: Vec3, unix_s: float) -> Vec3:
    """B at a place (m, eci) and time: (3,) in T, eci."""
    if field.model is None:
        return direct_dipole_eci_t(r_eci_m)
    gmst_rad = gmst82_rad(unix_s)
    b_ecef_t = field_ecef_t(rotate_about_pole(gmst_rad, r_eci_m), unix_s, field.model)
    return rotate_about_pole(-gmst_rad, b_ecef_t)


def direct_dipole_eci_t(r_eci_m: Vec3) -> Vec3:
    """B = (mu_e / r^3) (k - 3 (k . r_hat) r_hat) with k the rotation axis (Ovchinnikov et al. 2015)."""
    x, y, z = r_eci_m
    r2 = dot(r_eci_m, r_eci_m)
    strength = DIPOLE_TM3 / (r2 * norm(r_eci_m))
    tilt = -3.0 * strength * z / r2
    return (tilt * x, tilt * y, strength + tilt * z)
