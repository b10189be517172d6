"""Roll and yaw of a satellite whose wheel is along body axis 3, and its pitch held to the orbit.

Roll is the turn about axis 2, along-track, yaw that about axis 1, the radius, pitch that about axis 3. For
small angles the wheel's momentum h e3 tilts by (h roll, -h yaw) along orbit axes 1 and 2, and a torque T
moves it as

    h (roll' + w0 yaw) = T1,    h (-yaw' + w0 roll) = T2:

the precession, slow compared with the nutation of the body about the momentum. The coil m3 along the wheel
gives T = m3 (-b2, b1), so that

    d(roll^2 + yaw^2)/dt = -2 m3 (b2 roll + b1 yaw) / h.

Source: Stickler, Alfriend 1976, the satellite; the equations are derived here from the momentum.
"""

from math import sin
from typing import NamedTuple

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Vec3
from fsw.core.laws.dual_spin import pitch, pitch_dipole
from fsw.core.laws.interface import ControlConfig, LawInput, Setpoint
from fsw.core.laws.pd import attitude_error


class RollYaw(NamedTuple):
    """Angles, rad, and rates relative to the orbital frame, rad/s."""

    roll: float
    yaw: float
    roll_rate: float
    yaw_rate: float


def roll_yaw(inputs: LawInput) -> RollYaw:
    """Half of S of the PD law about axes 2 and 1, and the rates about them."""
    s1, s2, _ = attitude_error(dcm(inputs.attitude.q_body_from_orbit))
    w1, w2, _ = inputs.attitude.omega_body_orbit_radps
    return RollYaw(0.5 * s2, 0.5 * s1, w2, w1)


def pitch_holding_dipole(inputs: LawInput, setpoint: Setpoint) -> Vec3:
    """(m1, m2) that holds the pitch at zero: ``pitch_dipole`` of -2 k_a sin pitch - k_w Omega3."""
    turn = pitch(dcm(inputs.attitude.q_body_from_orbit))
    rate = inputs.attitude.omega_body_orbit_radps[2]
    return pitch_dipole(inputs.b_body_t, -2.0 * setpoint.k_a * sin(turn) - setpoint.k_w * rate)


def can_hold(inputs: LawInput, config: ControlConfig) -> bool:
    """Whether the attitude is known and there is a wheel along the orbit normal."""
    return inputs.attitude.usable and config.wheel_body_nms[2] > 0.0
