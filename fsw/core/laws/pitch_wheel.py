"""A momentum wheel along the orbit normal whose speed turns the body in pitch; coils hold and unload it.

The review has the wheel along its second axis; its axes 1, 2, 3 are 2, 3, 1 here: the wheel is along axis 3.
"""

from dataclasses import dataclass
from math import sin

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, add, dot
from fsw.core.laws.dual_spin import pitch, pitch_dipole, twice_roll, wheel_axis_dipole
from fsw.core.laws.entry import LEAST_COSINE, Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.wheel_effort import check_frequency


@dataclass(frozen=True, slots=True)
class PitchWheelGains:
    """The pitch that is held, how fast it comes back, and the momentum about which the wheel is held.

    Attributes:
        pitch_rad: angle about the orbit normal, body from orbit.
        frequency_radps: natural frequency of the pitch, rad/s.
        damping: its damping ratio.
        bias_nms: momentum of the wheel, N m s.
        unload_per_s: rate constant with which the momentum returns to the bias, 1/s.
    """

    pitch_rad: float = 0.0
    frequency_radps: float = 0.02
    damping: float = 1.0
    bias_nms: float = 0.05
    unload_per_s: float = 5e-4

    def __post_init__(self) -> None:
        """Check them.

        Raises:
            ValueError: one is out of range.
        """
        check_frequency(self.frequency_radps, self.damping)
        limits = (("pitch_rad", -3.2, 3.2), ("bias_nms", 1e-6, 100.0), ("unload_per_s", 0.0, 0.1))
        for name, low, high in limits:
            value = getattr(self, name)
            if not low <= value <= high:
                raise ValueError(f"{name} must be {low:g} to {high:g}, not {value:g}")


def pitch_torque(angle_rad: float, rate_radps: float, inertia_kgm2: float, gains: PitchWheelGains) -> float:
    """T_3 = J_33 (w_n^2 sin(alpha_ref - alpha) - 2 zeta w_n Omega_3): on the body; on the wheel the opposite.

    Args:
        angle_rad: alpha, the pitch.
        rate_radps: Omega_3, its rate relative to the orbital frame.
        inertia_kgm2: J_33.
        gains: reference, natural frequency w_n and damping ratio zeta.
    """
    turning = gains.frequency_radps**2 * sin(gains.pitch_rad - angle_rad)
    return inertia_kgm2 * (turning - 2.0 * gains.damping * gains.frequency_radps * rate_radps)


def momentum_dipole(b_body_t: Vec3, excess_nms: float, per_s: float) -> Vec3:
    """(m_1, m_2) = T' (b_2, -b_1), T' = -k (h - h_0) / |b|^2: the dipole that unloads the wheel, A m^2.

    Its torque about axis 3 is -k (h - h_0) (b_1^2 + b_2^2) / |b|^2; as the wheel holds the pitch against it,
    that torque changes the wheel's momentum.

    Args:
        b_body_t: field in body axes, T.
        excess_nms: h - h_0.
        per_s: k.
    """
    square = dot(b_body_t, b_body_t)
    return pitch_dipole(b_body_t, -per_s * excess_nms / square if square > 0.0 else 0.0)


def pitch_wheel(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Pitch by the wheel's torque; its axis to the orbit normal by coil 3, its momentum by coils 1 and 2.

    The law for the wheel's axis is that of ``dual_spin``, and so are its gains k_w and k_a. Without a wheel
    along axis 3 whose momentum is known, nothing; while it turns the other way it is only spun up.

    Source: a pitch wheel whose speed is controlled alongside coils, de Ruiter 2012, as in Ovchinnikov,
    Roldugin 2019, section 2.4 [58], which gives no equation; the laws are those of section 2.2 for the axis,
    and follow from the torques m x b and -dh/dt for pitch and momentum.
    """
    gains: PitchWheelGains = config.gains["pitch_wheel"]
    wheel, h = config.wheel, inputs.wheel_nms
    if wheel is None or h is None or not inputs.attitude.usable or wheel.axis_body[2] < LEAST_COSINE:
        return Demand()
    c, omega = dcm(inputs.attitude.q_body_from_orbit), inputs.attitude.omega_body_orbit_radps
    torque_nm = pitch_torque(pitch(c), omega[2], config.inertia_kgm2[2][2], gains)
    unloading = momentum_dipole(inputs.b_body_t, h - gains.bias_nms, gains.unload_per_s)
    holding = ZERO
    if h > 0.0:
        holding = wheel_axis_dipole(inputs.b_body_t, omega, twice_roll(c), setpoint.k_w, setpoint.k_a)
    return Demand(add(holding, unloading), wheel_torque_nm=-torque_nm)


LAWS = {
    "pitch_wheel": LawEntry(
        122, Aim.THREE_AXIS, pitch_wheel, pitch_wheel, PitchWheelGains, needs=Need.PITCH_WHEEL
    ),
}
