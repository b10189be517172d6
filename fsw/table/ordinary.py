"""Ordinary residual dipole and disturbance torque of a satellite, by its size and the height of its orbit."""

from fsw.core.algebra.vector import Mat3

REFERENCE_KGM2 = 1.6
"""Mean moment of inertia of the 50 kg satellite for which the next two hold."""
DIPOLE_AM2, TORQUE_NM = 0.1, 3e-8
SNAP_RADPS = 1e-4
"""Change of the rate at the shadow's edge, of a body with panels that bend; wide, as one beyond it looks
like an attitude."""
DRAG_KM, DENSITY_POWER = 780.0, 8.8
"""Height h of the perigee below which drag outweighs light; the density goes as h^-DENSITY_POWER."""


def mean_moment(inertia_kgm2: Mat3) -> float:
    """A third of the trace of the inertia tensor, kg m^2."""
    return (inertia_kgm2[0][0] + inertia_kgm2[1][1] + inertia_kgm2[2][2]) / 3.0


def relative_volume(inertia_kgm2: Mat3) -> float:
    """Volume over that of the reference; for bodies of equal density and shape J ~ l^5, l^3 ~ J^(3/5)."""
    volume: float = (mean_moment(inertia_kgm2) / REFERENCE_KGM2) ** 0.6
    return volume


def ordinary_dipole_am2(inertia_kgm2: Mat3) -> float:
    """Residual dipole by component, A m^2: it grows with the volume."""
    return DIPOLE_AM2 * relative_volume(inertia_kgm2)


def ordinary_shadow_impulse_nms(inertia_kgm2: Mat3) -> float:
    """Impulse of a snap at the shadow's edge by component, N m s: it grows with the inertia."""
    return SNAP_RADPS * mean_moment(inertia_kgm2)


def ordinary_torque_nm(inertia_kgm2: Mat3, perigee_km: float) -> float:
    """Disturbance torque by component, N m: T V max(1, (780 km / h)^8.8).

    Solar pressure and drag act on faces (l^2) whose centres are off the mass centre (l), so that both torques
    grow with the volume. T is that of solar pressure. Drag changes along the orbit, so that five times its
    peak counts; at high solar activity, with twice the mean density, that is as much as T at 780 km. The
    density goes as h^-8.8, within a factor of 1.5 from 400 to 800 km (exponential atmosphere, Vallado 2013,
    table 8-4).

    Args:
        inertia_kgm2: body axes.
        perigee_km: height above the equatorial radius.
    """
    drag: float = (DRAG_KM / perigee_km) ** DENSITY_POWER
    return TORQUE_NM * relative_volume(inertia_kgm2) * max(1.0, drag)
