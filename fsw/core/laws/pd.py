"""PD dipole law for three-axis pointing in the orbital frame, with an integral against constant torques."""

from fsw.core.algebra.quaternion import Quaternion, dcm
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, add, cross, norm, scale
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint


def attitude_error(c_body_from_orbit: Mat3) -> Vec3:
    """S = (a23 - a32, a31 - a13, a12 - a21), about +2 theta near zero and zero again at 180 deg."""
    (_, a12, a13), (a21, _, a23), (a31, a32, _) = c_body_from_orbit
    return (a23 - a32, a31 - a13, a12 - a21)


def far_error(q_body_from_orbit: Quaternion) -> Vec3:
    """E = 4 qv for a scalar part >= 0: about +2 theta near zero, largest at 180 deg.

    There S vanishes and the gravity gradient holds a satellite upside down; this error does not let it.
    """
    q0, q1, q2, q3 = q_body_from_orbit
    factor = 4.0 if q0 >= 0.0 else -4.0
    return (factor * q1, factor * q2, factor * q3)


def acquisition_error(inputs: LawInput, setpoint: Setpoint, config: ControlConfig) -> Vec3:
    """E, limited where k_a |b| |E| is the mean dipole that the coils give, and where k_a |E| is k_w w0.

    Beyond the first the attitude alone decides what the coils do. Beyond the second it asks for a turn faster
    than the orbit's, with which the field does not come round. A satellite that passes through all attitudes
    then gains as much energy as it loses, and tumbles on for orbits. The rate's term has no limit.

    Source: Wie, Lu 1995, Feedback control logic for spacecraft eigenaxis rotations under slew rate and
    control constraints: the attitude's term is limited alone, by the rate that it asks for.
    """
    error = far_error(inputs.attitude.q_body_from_orbit)
    if inputs.reference is not None and setpoint.k_w > 0.0:
        asked, most = setpoint.k_a * norm(error), setpoint.k_w * inputs.reference.orbit_rate_radps
        error = scale(most / asked, error) if asked > most else error
    return within_mean_dipole(error, inputs.b_body_t, setpoint.k_a, config.mean_dipole_am2)


def pd_dipole(b_body_t: Vec3, omega_body_orbit_radps: Vec3, error: Vec3, k_w: float, k_a: float) -> Vec3:
    """The dipole m = -k_w b x Omega - k_a b x S.

    Args:
        b_body_t: field in body axes, T.
        omega_body_orbit_radps: body rate relative to the orbital frame, body axes, rad/s.
        error: S of ``attitude_error``, or E of ``far_error``.
        k_w: damping gain, N m s / T^2.
        k_a: attitude gain, N m / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin, Ivanov, Penkov 2015, eq. 3.
    """
    w1, w2, w3 = omega_body_orbit_radps
    s1, s2, s3 = error
    return cross((k_w * w1 + k_a * s1, k_w * w2 + k_a * s2, k_w * w3 + k_a * s3), b_body_t)


def integrate_error(
    integral_s: Vec3, error: Vec3, b_body_t: Vec3, k_i: float, tick_s: float, mean_dipole_am2: float
) -> Vec3:
    """The integral I + S h, h a tick, limited as by ``within_mean_dipole``."""
    return within_mean_dipole(add(integral_s, scale(tick_s, error)), b_body_t, k_i, mean_dipole_am2)


def within_mean_dipole(term: Vec3, b_body_t: Vec3, gain: float, mean_dipole_am2: float) -> Vec3:
    """A term x of the law, limited where gain |b| |x| is the mean dipole that the coils give."""
    demanded_am2 = gain * norm(b_body_t) * norm(term)
    if demanded_am2 <= mean_dipole_am2:
        return term
    return scale(mean_dipole_am2 / demanded_am2, term)


def pd(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole m = -k_w b x Omega - k_a b x S - k_i b x I, I the integral of S; memory: I."""
    integral_s = _integral(memory)
    if not inputs.attitude.usable:
        return Demand(memory=integral_s)
    error = attitude_error(dcm(inputs.attitude.q_body_from_orbit))
    if setpoint.k_i > 0.0:
        integral_s = integrate_error(
            integral_s, error, inputs.b_body_t, setpoint.k_i, config.tick_s, config.mean_dipole_am2
        )
    return _demand(inputs, error, integral_s, setpoint)


def pd_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same law far from the goal: an error that does not vanish upside down, the integral frozen.

    Both are limited: k_i may have been raised since the integral grew.
    """
    integral_s = _integral(memory)
    if not inputs.attitude.usable:
        return Demand(memory=integral_s)
    integral_s = within_mean_dipole(integral_s, inputs.b_body_t, setpoint.k_i, config.mean_dipole_am2)
    return _demand(inputs, acquisition_error(inputs, setpoint, config), integral_s, setpoint)


def _demand(inputs: LawInput, error: Vec3, integral_s: Vec3, setpoint: Setpoint) -> Demand:
    held = cross(scale(setpoint.k_i, integral_s), inputs.b_body_t)
    dipole = pd_dipole(
        inputs.b_body_t, inputs.attitude.omega_body_orbit_radps, error, setpoint.k_w, setpoint.k_a
    )
    return Demand(add(dipole, held), memory=integral_s)


def _integral(memory: Memory) -> Vec3:
    return (memory[0], memory[1], memory[2]) if memory else ZERO


LAWS = {
    "pd": LawEntry(0, Aim.THREE_AXIS, pd_far, pd),
}
