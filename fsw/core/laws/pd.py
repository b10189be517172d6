"""PD dipole law for three-axis pointing in the orbital frame."""

from fsw.core.vector import Mat3, Vec3, cross


def attitude_error(c_body_from_orbit: Mat3) -> Vec3:
    """S = (a23 - a32, a31 - a13, a12 - a21), about +2 theta near zero and zero again at 180 deg."""
    (_, a12, a13), (a21, _, a23), (a31, a32, _) = c_body_from_orbit
    return (a23 - a32, a31 - a13, a12 - a21)


def pd_dipole(b_body_t: Vec3, omega_body_orbit_radps: Vec3, error: Vec3, k_w: float, k_a: float) -> Vec3:
    """M = -k_w b x Omega - k_a b x S.

    Args:
        b_body_t: field in body axes, T.
        omega_body_orbit_radps: body rate relative to the orbital frame, body axes, rad/s.
        error: S of ``attitude_error``.
        k_w: damping gain, N m s / T^2.
        k_a: attitude gain, N m / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Penkov, Roldugin 2015, eq. 3.
    """
    w1, w2, w3 = omega_body_orbit_radps
    s1, s2, s3 = error
    return cross((k_w * w1 + k_a * s1, k_w * w2 + k_a * s2, k_w * w3 + k_a * s3), b_body_t)
