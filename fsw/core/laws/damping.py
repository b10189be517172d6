"""Damping laws: from a known rate, and from the change of the measured field alone."""

from fsw.core.laws.interface import ControlConfig, Demand, Memory, Seen, Setpoint
from fsw.core.vector import Vec3, cross, scale, sub

MAX_DIFFERENCE_S = 10.0
"""Field samples further apart than this tell nothing of the rate."""


def rate_damping_dipole(b_body_t: Vec3, omega_body_radps: Vec3, k_w: float) -> Vec3:
    """M = -k_w b x omega: the torque m x b takes away the part of the rate normal to the field.

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
    """M = -k_w db/dt by finite difference; db/dt = b x omega, so the gain is that of rate damping.

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


def rate_damping(seen: Seen, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Damping of the rate relative to the orbital frame, down to the spin that is wanted."""
    if not seen.attitude.valid:
        return Demand()
    w1, w2, w3 = seen.attitude.omega_body_orbit_radps
    return Demand(rate_damping_dipole(seen.b_body_t, (w1 - setpoint.spin_radps, w2, w3), setpoint.k_w))


def bdot(seen: Seen, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """B-dot from the last two usable field samples."""
    interval_s = difference_s(seen, config.tick_s)
    if interval_s == 0.0:
        return Demand()
    return Demand(bdot_dipole(seen.sample.b_body_t, seen.before.b_body_t, interval_s, setpoint.k_w))


def difference_s(seen: Seen, tick_s: float) -> float:
    """Time between the last two usable field samples, s; zero where they tell nothing of the rate."""
    interval_s = (seen.sample.tick - seen.before.tick) * tick_s
    return interval_s if seen.before.tick >= 0 and interval_s <= MAX_DIFFERENCE_S else 0.0
