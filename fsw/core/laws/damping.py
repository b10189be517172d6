"""Damping laws: from a known rate, and from the change of the measured field alone."""

from fsw.core.vector import Vec3, cross, scale, sub


def rate_damping_dipole(b_body_t: Vec3, omega_body_radps: Vec3, k_w: float) -> Vec3:
    """M = -k_w b x omega: the torque m x b takes away the part of the rate normal to the field.

    Args:
        b_body_t: field in body axes, T.
        omega_body_radps: rate to damp, body axes, rad/s.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, eq. 1.
    """
    return scale(k_w, cross(omega_body_radps, b_body_t))


def bdot_dipole(b_body_t: Vec3, b_previous_body_t: Vec3, interval_s: float, k_w: float) -> Vec3:
    """M = -k_w db/dt by finite difference; db/dt = b x omega, so the gain is that of rate damping.

    Args:
        b_body_t: field now, body axes, T.
        b_previous_body_t: field ``interval_s`` earlier, body axes then, T.
        interval_s: time between the two samples, s, positive.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, eq. 2.
    """
    return scale(-k_w / interval_s, sub(b_body_t, b_previous_body_t))
