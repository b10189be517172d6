"""Super-twisting control on a terminal surface: continuous, an integral in place of the relay.

The surface bends at the goal, with |q|^p sign(q) for each axis and p between 1/2 and 1. With full control the
law overcomes disturbances that change no faster than L rad/s^3 (Levant 1998):

    s = J Omega + K (|q|^p sign(q) + share q),     r = (s - n (n . s)) / J_mean,     n = b / |b|,
    M_ref / J_mean = -1.5 L^(1/2) r / |r|^(1/2) + v,     dv/dt = -1.1 L r / |r| - leak v.

r is the component of s normal to the field, on which coils can act: that along the field would wind v up. The
leak lets v forget earlier directions of the field. M_ref is projected.

Source: Ovchinnikov, Roldugin 2019, section 3.1, the nonlinear surface, after Janardhanan, Nabi, Tiwari 2012.
The scan damages its last term, which is read as one linear in q. The torque is Levant's in this project's
scale; the component normal to the field and the leak are this project's.
"""

from dataclasses import dataclass
from math import copysign, sqrt

from fsw.core.algebra.quaternion import canonical
from fsw.core.algebra.vector import ZERO, Vec3, add, dot, norm, scale, sub, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.projection import torque_dipole
from fsw.core.laws.sliding import mean_moment


@dataclass(frozen=True, slots=True)
class SuperTwistingGains:
    """With w0 the orbital rate: K = slope w0 J_mean, L = level w0^3, leak = leak w0; power p, share."""

    slope: float = 0.15
    power: float = 0.8
    share: float = 0.5
    level: float = 0.03
    leak: float = 0.3

    def __post_init__(self) -> None:
        """Raises ValueError: destabilising gains, or a power with an infinite torque at the goal."""
        if min(self.slope, self.level) <= 0.0 or min(self.share, self.leak) < 0.0:
            raise ValueError("slope and level must be greater than 0, share and leak not less than 0")
        if not 0.5 < self.power <= 1.0:
            raise ValueError("power must be greater than 0.5 and at most 1")


def bent(value: float, power: float) -> float:
    """|x|^p sign(x)."""
    return copysign(abs(value) ** power, value)


def terminal_surface(
    momentum_nms: Vec3, attitude: Vec3, stiffness_nms: float, power: float, share: float
) -> Vec3:
    """The surface s = J Omega + K (|q|^p sign(q) + share q), body axes, N m s.

    Args:
        momentum_nms: J Omega.
        attitude: q, vector part of the quaternion for a scalar part >= 0.
        stiffness_nms: K.
        power: p.
        share: of the linear term.
    """
    q1, q2, q3 = (bent(q, power) + share * q for q in attitude)
    return add(momentum_nms, scale(stiffness_nms, (q1, q2, q3)))


def twisting(r_radps: Vec3, held_radps2: Vec3, level_radps3: float) -> Vec3:
    """-1.5 L^(1/2) r / |r|^(1/2) + v, rad/s^2."""
    size = norm(r_radps)
    factor = -1.5 * sqrt(level_radps3 / size) if size > 0.0 else 0.0
    return add(held_radps2, scale(factor, r_radps))


def sliding_twisting(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The torque to the terminal surface, projected; memory: v, limited to what the coils can hold."""
    held = (memory[0], memory[1], memory[2]) if len(memory) == 3 else ZERO
    square = dot(inputs.b_body_t, inputs.b_body_t)
    if not inputs.attitude.usable or inputs.reference is None or square <= 0.0:
        return Demand(memory=held)
    gains: SuperTwistingGains = config.gains["sliding_twisting"]
    w0, moment = inputs.reference.orbit_rate_radps, mean_moment(config)
    _, q1, q2, q3 = canonical(inputs.attitude.q_body_from_orbit)
    momentum = transform(config.inertia_kgm2, inputs.attitude.omega_body_orbit_radps)
    s = terminal_surface(momentum, (q1, q2, q3), gains.slope * w0 * moment, gains.power, gains.share)
    lost = scale(dot(inputs.b_body_t, s) / square, inputs.b_body_t)
    r, level = scale(1.0 / moment, sub(s, lost)), gains.level * w0**3
    torque = scale(moment, twisting(r, held, level))
    kept = scale(max(1.0 - gains.leak * w0 * config.tick_s, 0.0), held)
    most = config.mean_dipole_am2 * sqrt(square) / moment
    now = _grown(kept, r, 1.1 * level * config.tick_s, most)
    return Demand(torque_dipole(torque, inputs.b_body_t), memory=now)


def _grown(held: Vec3, r: Vec3, step: float, most: float) -> Vec3:
    """The integral v less a step along r, rad/s^2, limited."""
    size = norm(r)
    grown = sub(held, scale(step / size, r)) if size > 0.0 else held
    length = norm(grown)
    return scale(most / length, grown) if length > most else grown


LAWS = {
    "sliding_twisting": LawEntry(65, Aim.THREE_AXIS, sliding_twisting, sliding_twisting, SuperTwistingGains),
}
