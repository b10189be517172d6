"""The law of a pitch wheel with an integral term, against a constant torque."""

from math import sin

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, add
from fsw.core.laws.dual_spin import pitch, pitch_dipole
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import integrate_error, within_mean_dipole
from fsw.core.laws.roll_yaw import can_hold, pitch_holding_dipole, roll_yaw
from fsw.core.laws.six_gain import SixGainGains, six_gain_dipole

BOTH_ANGLES = SixGainGains()
"""Roll and yaw alike, no springs."""


def integral_dipole(b_body_t: Vec3, integral_s: Vec3, k_i: float) -> Vec3:
    """Dipole that on average counters a constant torque.

        m3 = 2 k_i (b2 I1 - b1 I2),   (m1, m2) = -2 k_i I3 (b2, -b1),   I = integral of (yaw, roll, sin pitch)

    A torque T1 about axis 1 leaves the yaw at T1 / (h w0), T2 about axis 2 the roll at T2 / (h w0). As
    the mean of b1 b2 over an orbit is zero, m3 gives the mean torques -2 k_i (b2^2 I1, b1^2 I2): against
    T1 by the integral of yaw, against T2 by that of roll.

    Args:
        b_body_t: field in body axes, T.
        integral_s: I, s (of angles in rad).
        k_i: N m / (T^2 s).

    Returns:
        Dipole in body axes, A m^2.

    Source: Tsuchiya, Inoue 1983, of whom Ovchinnikov, Roldugin 2019, section 2.2, says that they add an
    integral term to the feedback; components and signs are derived here from the torque.
    """
    b1, b2, _ = b_body_t
    i1, i2, i3 = integral_s
    m1, m2, _ = pitch_dipole(b_body_t, -2.0 * k_i * i3)
    return (m1, m2, 2.0 * k_i * (b2 * i1 - b1 * i2))


def wheel_integral(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Wheel and pitch held, with the integral I of (yaw, roll, sin pitch) in the memory."""
    integral_s = _integral(memory)
    if not can_hold(inputs, config):
        return Demand(memory=integral_s)
    motion = roll_yaw(inputs)
    if setpoint.k_i > 0.0:
        error = (motion.yaw, motion.roll, sin(pitch(dcm(inputs.attitude.q_body_from_orbit))))
        integral_s = integrate_error(
            integral_s, error, inputs.b_body_t, 2.0 * setpoint.k_i, config.tick_s, config.mean_dipole_am2
        )
    return _demand(inputs, integral_s, setpoint)


def wheel_integral_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from the goal, the integral frozen, and limited as the gain is now."""
    integral_s = _integral(memory)
    if not can_hold(inputs, config):
        return Demand(memory=integral_s)
    held = within_mean_dipole(integral_s, inputs.b_body_t, 2.0 * setpoint.k_i, config.mean_dipole_am2)
    return _demand(inputs, held, setpoint)


def _demand(inputs: LawInput, integral_s: Vec3, setpoint: Setpoint) -> Demand:
    held = integral_dipole(inputs.b_body_t, integral_s, setpoint.k_i)
    holding = six_gain_dipole(
        inputs.b_body_t, roll_yaw(inputs), 2.0 * setpoint.k_a, setpoint.k_w, BOTH_ANGLES
    )
    return Demand(add(held, add(holding, pitch_holding_dipole(inputs, setpoint))), memory=integral_s)


def _integral(memory: Memory) -> Vec3:
    return (memory[0], memory[1], memory[2]) if memory else ZERO


LAWS = {
    "wheel_integral": LawEntry(25, Aim.AXIS, wheel_integral_far, wheel_integral, needs=Need.MOMENTUM),
}
