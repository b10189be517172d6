"""Sliding control on a surface in which the inertia does not weigh the rate.

The surface is s = Omega + K q, rad/s. The classical law demands M_eq, which holds the motion on it, and a
torque that brings the motion to it; the modified one leaves out M_eq:

    M_ref = M_eq - c J layer sat(s / layer),     M_eq = -J (f + K dq/dt),

with dq/dt = 1/2 (q0 Omega + q x Omega), f = dOmega/dt without control, and sat(x) = x limited to +-1 for each
axis. Coils give the projection of M_ref; without its component along the field M_eq no longer holds s.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Sofyali, Jafarov 2012, whose title has a classical and
a modified algorithm; the review gives the surface alone. Both torques are those of the method of equivalent
control (Utkin 1992), derived here; which term the modified one leaves out is this project's reading.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import canonical
from fsw.core.algebra.vector import Vec3, add, cross, scale, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.predictive import free_change
from fsw.core.laws.projection import torque_dipole


@dataclass(frozen=True, slots=True)
class RateSurfaceGains:
    """In units of the orbital rate w0: c = reach w0, K = slope w0, layer = layer w0."""

    reach: float = 3.0
    slope: float = 0.5
    layer: float = 1.0

    def __post_init__(self) -> None:
        """Raises ValueError: one that is not greater than 0."""
        if min(self.reach, self.slope, self.layer) <= 0.0:
            raise ValueError("reach, slope and layer must be greater than 0")


def rate_surface(omega_body_orbit_radps: Vec3, attitude: Vec3, slope_radps: float) -> Vec3:
    """The surface s = Omega + K q, body axes, rad/s.

    Args:
        omega_body_orbit_radps: Omega, body axes.
        attitude: q, vector part of the quaternion for a scalar part >= 0.
        slope_radps: K.
    """
    return add(omega_body_orbit_radps, scale(slope_radps, attitude))


def reaching_change(s_radps: Vec3, reach_radps: float, layer_radps: float) -> Vec3:
    """-c layer sat(s / layer): the change of the rate that brings it to the surface, rad/s^2."""
    s1, s2, s3 = (max(-layer_radps, min(layer_radps, part)) for part in s_radps)
    return (-reach_radps * s1, -reach_radps * s2, -reach_radps * s3)


def equivalent_change(free_radps2: Vec3, attitude_change_radps: Vec3, slope_radps: float) -> Vec3:
    """-(f + K dq/dt): the change of the rate that holds s where it is, rad/s^2."""
    return scale(-1.0, add(free_radps2, scale(slope_radps, attitude_change_radps)))


def sliding_rate(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The classical law: M_eq, and the torque to the surface."""
    return _demand(inputs, config, config.gains["sliding_rate"], holds=True)


def sliding_rate_modified(
    inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig
) -> Demand:
    """The modified law: the torque to the surface alone."""
    return _demand(inputs, config, config.gains["sliding_rate_modified"], holds=False)


def _demand(inputs: LawInput, config: ControlConfig, gains: RateSurfaceGains, *, holds: bool) -> Demand:
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand()
    w0, omega = inputs.reference.orbit_rate_radps, inputs.attitude.omega_body_orbit_radps
    q0, q1, q2, q3 = canonical(inputs.attitude.q_body_from_orbit)
    slope_radps, qv = gains.slope * w0, (q1, q2, q3)
    s = rate_surface(omega, qv, slope_radps)
    change = reaching_change(s, gains.reach * w0, gains.layer * w0)
    if holds:
        turning = scale(0.5, add(scale(q0, omega), cross(qv, omega)))
        free = free_change(inputs, inputs.reference, config)
        change = add(change, equivalent_change(free, turning, slope_radps))
    return Demand(torque_dipole(transform(config.inertia_kgm2, change), inputs.b_body_t))


LAWS = {
    "sliding_rate": LawEntry(63, Aim.THREE_AXIS, sliding_rate, sliding_rate, RateSurfaceGains),
    "sliding_rate_modified": LawEntry(
        64, Aim.THREE_AXIS, sliding_rate_modified, sliding_rate_modified, RateSurfaceGains
    ),
}
