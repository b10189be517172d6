"""Torques on the body, in body axes."""

from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import Mat3, Quaternion, Vec3, cross, matrix, transform

SOURCES = ("gravity_gradient", "coils", "residual_dipole", "bias")
"""The torques on every body, in the order of ``TruthRow``; those of ``disturbances`` follow."""


def gravity_gradient(inertia_kgm2: Mat3, e_body: Vec3, gradient_ps2: float) -> Vec3:
    """T = 3 mu / r^3 e x J e [N m], e the unit vector of the radius."""
    x, y, z = cross(e_body, transform(inertia_kgm2, e_body))
    return (gradient_ps2 * x, gradient_ps2 * y, gradient_ps2 * z)


def magnetic(m_body_am2: Vec3, b_body_t: Vec3) -> Vec3:
    """T = m x b [N m]."""
    return cross(m_body_am2, b_body_t)


def eddy(k_nms_per_t2: float, omega_body_radps: Vec3, b_body_t: Vec3) -> Vec3:
    """T = k (omega x b) x b [N m] of the currents that the field induces in a rotating conductor.

    It damps omega across the field, and not along it (Wertz 1978, section 17.2). The slow rotation of the
    field along the orbit is neglected.

    Args:
        k_nms_per_t2: k, from the conductor's shape and conductivity; 2/3 pi r^4 sigma d for a thin sphere.
        omega_body_radps: inertial rate.
        b_body_t: field.
    """
    x, y, z = cross(cross(omega_body_radps, b_body_t), b_body_t)
    return (k_nms_per_t2 * x, k_nms_per_t2 * y, k_nms_per_t2 * z)


def total(
    inertia_kgm2: Mat3,
    q_body_from_eci: Quaternion,
    around: Surroundings,
    m_body_am2: Vec3,
    bias_body_nm: Vec3,
) -> Vec3:
    """T = 3 mu / r^3 e x J e + m x b + bias [N m]: the integration's inner loop, written out.

    Args:
        inertia_kgm2: inertia tensor.
        q_body_from_eci: attitude; its norm may differ from 1 by the error of an integration step.
        around: radius, gradient and field, frame ``eci``.
        m_body_am2: dipole of coils and residual together.
        bias_body_nm: constant torque.
    """
    c = matrix(q_body_from_eci)
    e_eci, gradient, b_eci, _ = around
    e_body = ex, ey, ez = transform(c, e_eci)
    bx, by, bz = transform(c, b_eci)
    mx, my, mz = m_body_am2
    dx, dy, dz = bias_body_nm
    fx, fy, fz = transform(inertia_kgm2, e_body)
    return (
        gradient * (ey * fz - ez * fy) + my * bz - mz * by + dx,
        gradient * (ez * fx - ex * fz) + mz * bx - mx * bz + dy,
        gradient * (ex * fy - ey * fx) + mx * by - my * bx + dz,
    )
