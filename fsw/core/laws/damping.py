"""Damping laws: from the estimated rate, and from the change of the measured field alone."""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, cross, norm, scale, sub
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint

MAX_DIFFERENCE_S = 10.0
"""Field samples further apart than this give no rate."""


@dataclass(frozen=True, slots=True)
class SwitchedGains:
    """When the gain of B-dot changes, and how much.

    Attributes:
        below_radps: apparent rate |db/dt| / |b| under which the gain is ``factor`` k_w, rad/s.
        factor: of the gain below that rate.

    Raises:
        ValueError: one of them is negative.
    """

    below_radps: float = 0.01
    factor: float = 5.0

    def __post_init__(self) -> None:
        if not (self.below_radps >= 0.0 and self.factor >= 0.0):
            raise ValueError("below_radps and factor of bdot_switched must not be negative")


def rate_damping_dipole(b_body_t: Vec3, omega_body_radps: Vec3, k_w: float) -> Vec3:
    """The dipole m = -k_w b x omega: the torque m x b damps the component of the rate normal to the field.

    Args:
        b_body_t: field in body axes, T.
        omega_body_radps: rate to damp, body axes, rad/s.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, eq. 1; with the rate relative to the orbital frame it is the energy
    law of Wisniewski (Tavares et al. use it as their reference).
    """
    return scale(k_w, cross(omega_body_radps, b_body_t))


def bdot_dipole(b_body_t: Vec3, b_previous_body_t: Vec3, interval_s: float, k_w: float) -> Vec3:
    """The dipole m = -k_w db/dt by finite difference; db/dt = b x omega: the gain is that of rate damping.

    Args:
        b_body_t: field now, body axes, T.
        b_previous_body_t: field ``interval_s`` earlier, body axes then, T.
        interval_s: time between the two samples, s, positive.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, eq. 2.
    """
    return scale(-k_w / interval_s, sub(b_body_t, b_previous_body_t))


def switched_gain(b_dot_tps: Vec3, b_body_t: Vec3, k_w: float, below_radps: float, factor: float) -> float:
    """The gain k_w while |db/dt| > w_s |b|, and factor k_w below: the dipole does not fade with the rate.

    Args:
        b_dot_tps: change of the field seen from the body, T/s.
        b_body_t: field in body axes, T.
        k_w: gain, N m s / T^2.
        below_radps: w_s, rad/s.
        factor: of the gain below it.

    Returns:
        The gain of this tick, N m s / T^2.

    Source: Semkin, Lyubimov, Malyshev, as in Ovchinnikov, Roldugin 2019, section 1: two values of the gain,
    changed when the rate falls below a value. There the rate is measured; here the field stands in for it.
    """
    return k_w if norm(b_dot_tps) > below_radps * norm(b_body_t) else factor * k_w


def rate_damping(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Damping of the rate relative to the orbital frame, down to the spin of the setpoint."""
    if not inputs.attitude.usable:
        return Demand()
    w1, w2, w3 = inputs.attitude.omega_body_orbit_radps
    return Demand(rate_damping_dipole(inputs.b_body_t, (w1 - setpoint.spin_radps, w2, w3), setpoint.k_w))


def bdot(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """B-dot from the last two usable field samples."""
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return Demand()
    return Demand(bdot_dipole(inputs.sample.b_body_t, inputs.before.b_body_t, interval_s, setpoint.k_w))


def bdot_switched(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """B-dot whose gain is switched by the apparent rate."""
    gains: SwitchedGains = config.gains["bdot_switched"]
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return Demand()
    now, before = inputs.sample.b_body_t, inputs.before.b_body_t
    b_dot = scale(1.0 / interval_s, sub(now, before))
    k_w = switched_gain(b_dot, now, setpoint.k_w, gains.below_radps, gains.factor)
    return Demand(bdot_dipole(now, before, interval_s, k_w))


def difference_s(inputs: LawInput, tick_s: float) -> float:
    """Time between the last two usable field samples, s; zero where they give no rate."""
    interval_s = (inputs.sample.tick - inputs.before.tick) * tick_s
    return interval_s if inputs.before.tick >= 0 and interval_s <= MAX_DIFFERENCE_S else 0.0


LAWS = {
    "rate_damping": LawEntry(1, Aim.RATE, rate_damping, rate_damping),
    "bdot": LawEntry(2, Aim.RATE, bdot, bdot),
    "bdot_switched": LawEntry(10, Aim.RATE, bdot_switched, bdot_switched, SwitchedGains),
}
