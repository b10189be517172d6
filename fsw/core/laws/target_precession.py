"""Spin axis to a direction in space by one coil, with any function of the errors that keeps their sign."""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, norm, scale
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.spin import AXES
from fsw.core.laws.spin_axis import SpinAxisGains


@dataclass(frozen=True, slots=True)
class PrecessionGains(SpinAxisGains):
    """Axis, direction and gain of ``SpinAxisGains``, and where the function f bends.

    Attributes:
        limit: f(x) = x up to it and constant beyond; 1: f(x) = x.

    Raises:
        ValueError: the limit is not between 0 and 1, or what ``SpinAxisGains`` refuses.
    """

    limit: float = 0.3

    def __post_init__(self) -> None:
        SpinAxisGains.__post_init__(self)
        if not 0.0 < self.limit <= 1.0:
            raise ValueError(f"limit of target_precession must lie between 0 and 1, not {self.limit:g}")


def precession_dipole(b_body_t: Vec3, target_body: Vec3, axis: int, k_am2pt: float, limit: float) -> Vec3:
    """m_e = k (b_u f(t_v) - b_v f(t_u)), t the direction wanted, e, u, v in cyclic order.

    The torque is m_e e x b = m_e (-b_v, b_u) in u, v. For f(x) = x its component along t is
    k (b_u t_v - b_v t_u)^2; for another f with the sign of x that holds on average over a spin period.

    Args:
        b_body_t: field in body axes, T.
        target_body: t, unit vector, body axes.
        axis: index of e, from zero.
        k_am2pt: gain, A m^2 / T.
        limit: where f bends.

    Returns:
        Dipole in body axes, A m^2.

    Source: Wheeler 1967, as in Ovchinnikov, Roldugin 2019, eq. 5: m3 = K1 [b1 f(a23) - b2 f(a13)], the
    direction cosines less those wanted; x f(x) > 0 and f(0) = 0.
    """
    u, v = (axis + 1) % 3, (axis + 2) % 3
    error = b_body_t[u] * bent(target_body[v], limit) - b_body_t[v] * bent(target_body[u], limit)
    return scale(k_am2pt * error, AXES[axis])


def bent(value: float, limit: float) -> float:
    """The function f: the value, cut at +-limit."""
    return max(-limit, min(limit, value))


def target_precession(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The momentum to its target, k = k_h |h|; nutation is left to a damper."""
    gains: PrecessionGains = config.gains["target_precession"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    target = rotate(moving.q_body_from_eci, gains.target_eci)
    k_am2pt = gains.k_h * norm(moving.momentum_body_nms)
    return Demand(precession_dipole(inputs.b_body_t, target, gains.number, k_am2pt, gains.limit))


LAWS = {
    "target_precession": LawEntry(18, Aim.SPIN, target_precession, target_precession, PrecessionGains),
}
