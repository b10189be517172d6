"""Dual spin: a wheel along body axis 3, the orbit normal; one coil holds it there, two turn the body.

The review has the wheel along its second axis; its axes 1, 2, 3 are 2, 3, 1 here.
"""

from dataclasses import dataclass
from math import atan2, sin

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Mat3, Vec3, add
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint


@dataclass(frozen=True, slots=True)
class DualSpinGains:
    """Pitch angle in the orbit plane and the stiffness of its control.

    Attributes:
        pitch_rad: angle about the orbit normal, body from orbit.
        stiffness: gain of that angle over 2 k_a.

    Raises:
        ValueError: a negative stiffness.
    """

    pitch_rad: float = 0.0
    stiffness: float = 1.0

    def __post_init__(self) -> None:
        if not self.stiffness >= 0.0:
            raise ValueError(f"stiffness of dual_spin must not be negative, not {self.stiffness:g}")


def wheel_axis_dipole(
    b_body_t: Vec3, omega_body_orbit_radps: Vec3, s2: float, k_w: float, k_a: float
) -> Vec3:
    """m3 = k1 b2 phi2 - k2 (b1 Omega2 - b2 Omega1), k1 = 2 k_a and k2 = k_w, for a wheel along +e3.

    A turn phi2 about axis 2 tilts the momentum h e3 by h phi2 along axis 1; the torque -m3 b2 takes it back.
    A turn about axis 1 becomes one about axis 2 a quarter of an orbit later. The second term is -k2 times the
    power of the coil per dipole, so it only takes energy away.

    Args:
        b_body_t: field in body axes, T.
        omega_body_orbit_radps: rate relative to the orbital frame, body axes.
        s2: 2 phi2, of ``twice_roll``.
        k_w: N m s / T^2.
        k_a: N m / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Stickler, Alfriend 1976, as in Ovchinnikov, Roldugin 2019, eq. 6. The scan lost the first factor
    and the dots; they follow from the general law after Hablani 1995 printed below it, and from the torque.
    """
    b1, b2, _ = b_body_t
    w1, w2, _ = omega_body_orbit_radps
    return (0.0, 0.0, k_a * b2 * s2 - k_w * (b1 * w2 - b2 * w1))


def pitch_dipole(b_body_t: Vec3, torque_gain: float) -> Vec3:
    """(m1, m2) = T' (b2, -b1): the torque about axis 3 is T' (b1^2 + b2^2).

    Args:
        b_body_t: field in body axes, T.
        torque_gain: T', N m / T^2; k sin(alpha_ref - alpha) less damping.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Penkov, Roldugin et al. 2017, as in Ovchinnikov, Roldugin 2019, section 2.2, where
    the matrix is lost but for +- k sin(alpha_ref - alpha); components and signs follow from the torque.
    """
    return (torque_gain * b_body_t[1], -torque_gain * b_body_t[0], 0.0)


def pitch(c_body_from_orbit: Mat3) -> float:
    """Turn about axis 3, body from orbit, rad: the one nearest to the attitude."""
    (a11, a12, _), (a21, a22, _), _ = c_body_from_orbit
    return atan2(a12 - a21, a11 + a22)


def twice_roll(c_body_from_orbit: Mat3) -> float:
    """2 phi2 = -2 a13, whatever the pitch: the lean of axis 3 from the orbit normal, seen along body axis 1.

    At pitch zero it is the second component of S of the PD law, to first order.
    """
    return -2.0 * c_body_from_orbit[0][2]


def dual_spin(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The wheel held to the orbit normal, the body turned to its pitch.

    Without a wheel, or with one against the orbit normal, nothing: there the damping relative to the orbital
    frame would destabilise the satellite.
    """
    gains: DualSpinGains = config.gains["dual_spin"]
    if not inputs.attitude.usable or config.wheel_body_nms[2] <= 0.0:
        return Demand()
    c = dcm(inputs.attitude.q_body_from_orbit)
    omega = inputs.attitude.omega_body_orbit_radps
    holding = wheel_axis_dipole(inputs.b_body_t, omega, twice_roll(c), setpoint.k_w, setpoint.k_a)
    stiff = 2.0 * setpoint.k_a * gains.stiffness
    turning = pitch_dipole(inputs.b_body_t, stiff * sin(gains.pitch_rad - pitch(c)) - setpoint.k_w * omega[2])
    return Demand(add(holding, turning))


LAWS = {
    "dual_spin": LawEntry(20, Aim.AXIS, dual_spin, dual_spin, DualSpinGains, needs=Need.MOMENTUM),
}
