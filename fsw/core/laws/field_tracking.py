"""Field tracking: the measured field is turned onto that of the nominal attitude, without an estimate."""

from dataclasses import dataclass, replace

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, add, scale, sub
from fsw.core.laws.damping import MAX_DIFFERENCE_S
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import pd

TRACKED = 4
"""Numbers that field tracking remembers."""


@dataclass(frozen=True, slots=True)
class HandOverGains:
    """Gains of field tracking relative to those of the PD law it hands over to.

    Attributes:
        share_w: of k_w.
        share_a: of k_a.

    Raises:
        ValueError: one of them is negative.
    """

    share_w: float = 0.15
    share_a: float = 0.3

    def __post_init__(self) -> None:
        if not (self.share_w >= 0.0 and self.share_a >= 0.0):
            raise ValueError("share_w and share_a of field_tracking_pd must not be negative")


def field_tracking_dipole(error_t: Vec3, error_rate_tps: Vec3, k_w: float, k_a: float) -> Vec3:
    """The dipole m = -k1 (b - B) - k2 (db/dt - dB/dt), k1 = 2 k_a and k2 = k_w.

    A small turn theta from nominal gives b - B = B x theta, so the law is then the PD law
    m = -k_w b x Omega - k_a b x S, S = 2 theta, less k_w dB/dt x theta. That term is as large as the one of
    k_a where k_w w0 ~ k_a: gains found for PD do not serve, and a body that neither a wheel nor the gravity
    gradient holds firmly is driven away (50 kg, 1.02/1.85/1.95 kg m^2: at most 0.005 per rad of u gained).

    Args:
        error_t: b - B, field in body axes less field in orbit axes, component by component, T.
        error_rate_tps: its derivative, T/s.
        k_w: N m s / T^2.
        k_a: N m / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Martel, Pal, Psiaki 1988; Guelman et al. 2005; Ovchinnikov, Roldugin 2019, eq. 7.
    """
    return add(scale(-2.0 * k_a, error_t), scale(-k_w, error_rate_tps))


def field_tracking(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Field tracking from magnetometer and orbit alone. Memory: tick of the last sample and b - B then."""
    sample, reference = inputs.sample, inputs.reference
    if reference is None or sample.tick < 0:
        return Demand()
    expected_t = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
    return track(sub(sample.b_body_t, expected_t), sample.tick, memory, setpoint, config)


def track(error_t: Vec3, tick: int, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole for an error of the field sampled at a tick, and for its change since the sample before."""
    if memory and tick == memory[0]:
        return Demand(memory=memory)
    tracked = (float(tick), *error_t)
    if not memory:
        return Demand(memory=tracked)
    interval_s = (tick - memory[0]) * config.tick_s
    if interval_s > MAX_DIFFERENCE_S:
        return Demand(memory=tracked)
    rate_tps = scale(1.0 / interval_s, sub(error_t, (memory[1], memory[2], memory[3])))
    return Demand(field_tracking_dipole(error_t, rate_tps, setpoint.k_w, setpoint.k_a), memory=tracked)


def tracking_before_pd(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Field tracking far from the goal, before the hand-over; without memory when it returns from PD."""
    gains: HandOverGains = config.gains["field_tracking_pd"]
    own = replace(setpoint, k_w=gains.share_w * setpoint.k_w, k_a=gains.share_a * setpoint.k_a)
    return field_tracking(inputs, memory if len(memory) == TRACKED else (), own, config)


def pd_after_tracking(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The PD law near the goal (the review's eq. 8 in the plane the coils reach), after the hand-over."""
    return pd(inputs, memory if len(memory) != TRACKED else (), setpoint, config)


LAWS = {
    "field_tracking": LawEntry(21, Aim.THREE_AXIS, field_tracking, field_tracking),
    "field_tracking_pd": LawEntry(22, Aim.THREE_AXIS, tracking_before_pd, pd_after_tracking, HandOverGains),
}
