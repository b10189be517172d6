"""A control law in a package of its own: the torque of a PD controller, projected on what the coils can give.

The gains are those of the torque, in N m s and N m, so that they do not depend on the strength of the field
as those of the law ``pd`` do.
"""

from dataclasses import dataclass

from fsw.core.algebra.vector import ZERO, Vec3, cross, dot, norm, scale
from fsw.own_law import ControlConfig, ControlLaw, Demand, LawInput, Memory, Setpoint, quantity

LEAST_FIELD_T = 1e-9


@dataclass(frozen=True, slots=True)
class Gains:
    """Of the wanted torque: against the rate, and against the attitude error."""

    damping_nms: float = quantity(1e-2, "N m s", least=0.0, most=10.0)
    stiffness_nm: float = quantity(4e-6, "N m", least=0.0, most=1.0)


def projected_dipole(b_body_t: Vec3, wanted_nm: Vec3) -> Vec3:
    """M = b x T / |b|^2: the least dipole whose torque m x b is the part of T normal to b.

    Args:
        b_body_t: field, body axes, T.
        wanted_nm: T, body axes, N m.

    Returns:
        Dipole in body axes, A m^2; none without a field, in which no dipole turns anything.
    """
    if norm(b_body_t) < LEAST_FIELD_T:
        return ZERO
    return scale(1.0 / dot(b_body_t, b_body_t), cross(b_body_t, wanted_nm))


def point(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """T = -d Omega - s 2 qv, qv the vector part of the attitude error with a scalar part that is positive."""
    if not inputs.attitude.usable:
        return Demand()
    gains: Gains = config.gains[setpoint.law]
    q0, q1, q2, q3 = inputs.attitude.q_body_from_orbit
    w1, w2, w3 = inputs.attitude.omega_body_orbit_radps
    d, s = -gains.damping_nms, -2.0 * gains.stiffness_nm * (1.0 if q0 >= 0.0 else -1.0)
    wanted_nm = (d * w1 + s * q1, d * w2 + s * q2, d * w3 + s * q3)
    return Demand(projected_dipole(inputs.b_body_t, wanted_nm))


projected_pd = ControlLaw(point, gains=Gains)
