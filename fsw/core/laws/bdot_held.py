"""B-dot whose gain grows as the rate falls, so that the torque is held."""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, norm, scale, sub
from fsw.core.laws.damping import difference_s
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint

UNM = 1e-6


@dataclass(frozen=True, slots=True)
class HeldGains:
    """The torque that is kept, and how far the gain may grow for it.

    Attributes:
        torque_unm: size of the torque, micro N m.
        most: largest gain, in units of k_w.

    Raises:
        ValueError: one of them is not positive.
    """

    torque_unm: float = 50.0
    most: float = 10.0

    def __post_init__(self) -> None:
        if not (self.torque_unm > 0.0 and self.most > 0.0):
            raise ValueError("torque_unm and most of bdot_held must be positive")


def held_gain(b_dot_tps: Vec3, b_body_t: Vec3, torque_nm: float, most: float) -> float:
    """The gain k = M / (|db/dt| |b|), at most ``most``: with m = -k db/dt, normal to b, the torque is M.

    Args:
        b_dot_tps: change of the field seen from the body, T/s.
        b_body_t: field in body axes, T.
        torque_nm: M, N m.
        most: largest gain, N m s / T^2, which applies once the rate is small.

    Returns:
        The gain of this tick, N m s / T^2.

    Source: Ovchinnikov, Roldugin 2019, section 1, in words: a gain that varies to compensate for the falling
    rate and keep the torque. The equation follows from these words.
    """
    product = norm(b_dot_tps) * norm(b_body_t)
    return torque_nm / product if product * most > torque_nm else most


def bdot_held(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """B-dot from the last two usable field samples, with the held torque."""
    gains: HeldGains = config.gains["bdot_held"]
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return Demand()
    b = inputs.sample.b_body_t
    b_dot = scale(1.0 / interval_s, sub(b, inputs.before.b_body_t))
    gain = held_gain(b_dot, b, UNM * gains.torque_unm, gains.most * setpoint.k_w)
    return Demand(scale(-gain, b_dot))


LAWS = {
    "bdot_held": LawEntry(5, Aim.RATE, bdot_held, bdot_held, HeldGains),
}
