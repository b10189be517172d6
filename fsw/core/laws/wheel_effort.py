"""The torque that laws of a driven wheel ask for, and the effort of coils and wheel that gives it."""

from typing import NamedTuple

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Mat3, Vec3, add, cross, norm, scale, sub, transform
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.interface import ControlConfig, LawInput

MOST_RADPS = 0.5
"""Highest natural frequency."""


class Effort(NamedTuple):
    """What coils and wheel are to give: a dipole, A m^2, and the torque on the wheel, N m."""

    m_body_am2: Vec3
    wheel_torque_nm: float


def shortened(effort: Effort, most_am2: float, most_nm: float) -> Effort:
    """The effort scaled down to what coils and wheel can give: the torque keeps its direction."""
    m, torque_nm = effort
    part = max(norm(m) / most_am2, abs(torque_nm) / most_nm, 1.0)
    return Effort(scale(1.0 / part, m), torque_nm / part)


def wanted_torque(attitude: Attitude, inertia_kgm2: Mat3, frequency_radps: float, damping: float) -> Vec3:
    """T = -J (2 zeta w_n Omega + w_n^2 theta), theta = 2 qv of the shorter turn, body axes, N m.

    Args:
        attitude: relative to the orbital frame.
        inertia_kgm2: J, body axes.
        frequency_radps: w_n.
        damping: zeta.
    """
    q0, q1, q2, q3 = attitude.q_body_from_orbit
    turn = scale(2.0 if q0 >= 0.0 else -2.0, (q1, q2, q3))
    damped = scale(2.0 * damping * frequency_radps, attitude.omega_body_orbit_radps)
    return scale(-1.0, transform(inertia_kgm2, add(damped, scale(frequency_radps**2, turn))))


def compensated_torque(
    inputs: LawInput, config: ControlConfig, frequency_radps: float, damping: float
) -> Vec3:
    """T + omega x (h w) - d, body axes, N m: the wheel's gyroscopic torque and the disturbance fed forward.

    T is that of ``wanted_torque``, omega the absolute rate, h the wheel's momentum along w and d the torque
    that the filter estimates. Without orbit or momentum the term of the wheel is left out.
    """
    wanted = wanted_torque(inputs.attitude, config.inertia_kgm2, frequency_radps, damping)
    wheel, reference = config.wheel, inputs.reference
    if wheel is None or reference is None or inputs.wheel_nms is None:
        return sub(wanted, inputs.torque_body_nm)
    momentum = scale(inputs.wheel_nms, wheel.axis_body)
    normal = rotate(inputs.attitude.q_body_from_orbit, (0.0, 0.0, 1.0))
    omega = add(inputs.attitude.omega_body_orbit_radps, scale(reference.orbit_rate_radps, normal))
    return sub(add(wanted, cross(omega, momentum)), inputs.torque_body_nm)


def check_frequency(frequency_radps: float, damping: float) -> None:
    """Check natural frequency and damping ratio of a law.

    Raises:
        ValueError: one is out of range.
    """
    for name, value, most in (("frequency_radps", frequency_radps, MOST_RADPS), ("damping", damping, 10.0)):
        if not 0.0 < value <= most:
            raise ValueError(f"{name} must be above 0 and at most {most:g}, not {value:g}")
