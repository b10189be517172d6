"""Damping at the bound of the coils: the momentum, or the energy, falls as fast as it can.

The bound is on each coil, |m_j| <= m0, and the torque is m x b. Then

    d|h|^2/dt / 2 = h . (m x b) = m . (b x h),      dT/dt = omega . (m x b) = m . (b x omega),

each least for the relay m_j = -m0 sign of the product's component j. Within a band about rest the relay
becomes linear, which holds what is reached without chatter.

Source: Lyubimov, Podkletnova 2016, as in Ovchinnikov, Roldugin 2019, section 1 [28]. The review prints no
equation and the paper's abstract gives the aims: the momentum brought to small given values and held there,
and the rate damped as a reference model, three independent linear equations. The laws are derived from these.
"""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, add, cross, norm, sub, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.projection import torque_dipole


@dataclass(frozen=True, slots=True)
class MomentumGains:
    """Momentum under which the coils are no longer fully on.

    Raises:
        ValueError: it is not positive.
    """

    band_mnms: float = 1.0

    def __post_init__(self) -> None:
        _positive("band_mnms of least_momentum", self.band_mnms)


@dataclass(frozen=True, slots=True)
class EnergyGains:
    """Rate under which the coils are no longer fully on.

    Raises:
        ValueError: it is not positive.
    """

    band_radps: float = 0.001

    def __post_init__(self) -> None:
        _positive("band_radps of least_energy", self.band_radps)


@dataclass(frozen=True, slots=True)
class ModelGains:
    """How fast the rate about each body axis is to decay, 1/s.

    Raises:
        ValueError: one of them is not positive.
    """

    decay_1: float = 0.001
    decay_2: float = 0.001
    decay_3: float = 0.001

    def __post_init__(self) -> None:
        for number, decay in enumerate((self.decay_1, self.decay_2, self.decay_3), 1):
            _positive(f"decay_{number} of rate_model", decay)


def fastest_dipole(b_body_t: Vec3, motion_body: Vec3, band: float, m_am2: float) -> Vec3:
    """m_j = -m0 sat((b x v)_j / (|b| v0)), v the momentum or the rate, sat cut at -1 and 1.

    Args:
        b_body_t: field in body axes, T; without one there is no dipole.
        motion_body: v, body axes: momentum [N m s] or rate [rad/s].
        band: v0, in the unit of v.
        m_am2: m0, bound of each coil.

    Returns:
        Dipole in body axes, A m^2.
    """
    size = norm(b_body_t) * band
    if size == 0.0:
        return (0.0, 0.0, 0.0)
    x, y, z = cross(b_body_t, motion_body)
    return (-m_am2 * _cut(x / size), -m_am2 * _cut(y / size), -m_am2 * _cut(z / size))


def model_torque(omega_body_radps: Vec3, momentum_body_nms: Vec3, acceleration_body: Vec3) -> Vec3:
    """M = omega x h + J a, body axes, N m: the torque under which d(omega)/dt = a.

    Args:
        omega_body_radps: absolute rate.
        momentum_body_nms: h, wheel included.
        acceleration_body: J a, N m: inertia times the angular acceleration wanted.
    """
    return add(cross(omega_body_radps, momentum_body_nms), acceleration_body)


def least_momentum(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The body's momentum J (omega - spin), reduced at the bound of the coils."""
    gains: MomentumGains = config.gains["least_momentum"]
    rate = _rate_left(inputs, setpoint, config)
    if rate is None:
        return Demand()
    momentum = transform(config.inertia_kgm2, rate)
    return Demand(fastest_dipole(inputs.b_body_t, momentum, 1e-3 * gains.band_mnms, config.mean_dipole_am2))


def least_energy(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The rotational energy, that of omega - spin, reduced at the bound of the coils."""
    gains: EnergyGains = config.gains["least_energy"]
    rate = _rate_left(inputs, setpoint, config)
    if rate is None:
        return Demand()
    return Demand(fastest_dipole(inputs.b_body_t, rate, gains.band_radps, config.mean_dipole_am2))


def rate_model(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The reference model d(omega_i)/dt = -decay_i (omega_i - spin_i), its torque projected."""
    gains: ModelGains = config.gains["rate_model"]
    moving, left = motion(inputs, config), _rate_left(inputs, setpoint, config)
    if moving is None or left is None:
        return Demand()
    w1, w2, w3 = left
    wanted = (-gains.decay_1 * w1, -gains.decay_2 * w2, -gains.decay_3 * w3)
    needed = transform(config.inertia_kgm2, wanted)
    torque = model_torque(moving.omega_body_radps, moving.momentum_body_nms, needed)
    return Demand(torque_dipole(torque, inputs.b_body_t))


def _rate_left(inputs: LawInput, setpoint: Setpoint, config: ControlConfig) -> Vec3 | None:
    """The absolute rate less the spin of the setpoint about axis 1; None if unknown."""
    moving = motion(inputs, config)
    return None if moving is None else sub(moving.omega_body_radps, (setpoint.spin_radps, 0.0, 0.0))


def _cut(value: float) -> float:
    return max(-1.0, min(1.0, value))


def _positive(name: str, value: float) -> None:
    if not value > 0.0:
        raise ValueError(f"{name} must be positive, not {value:g}")


LAWS = {
    "least_momentum": LawEntry(6, Aim.RATE, least_momentum, least_momentum, MomentumGains),
    "least_energy": LawEntry(7, Aim.RATE, least_energy, least_energy, EnergyGains),
    "rate_model": LawEntry(8, Aim.RATE, rate_model, rate_model, ModelGains),
}
