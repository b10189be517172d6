"""The realisable torque nearest to a demanded one, by least squares within the coils' limits.

    min |m x b - M_ref|^2   over   |m_i| <= m_max

The projection m = b x M_ref / |b|^2, cut to the limits, is a different dipole: where one coil is at its limit
the other two can still take over. The minimum is found by dichotomous coordinate descent: steps of
m_max 2^-n along one coil at a time, n = 1 to 15, each taken only where it lowers the error. A little of |m|^2
is added to the cost, as the part of m along b does nothing.

Source: Schlanbusch, Kristiansen, Nicklasson 2010, as in Ovchinnikov, Roldugin 2019, section 3.2, where only
the method is named; the descent: Zakharov, Tozer 1999. M_ref is that of the PD law, as in ``projection``.
"""

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, cross, dot
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import attitude_error, far_error
from fsw.core.laws.projection import reference_torque

BITS = 15
"""Halvings of the step: to 3e-5 of the limit."""
UPDATES = 400
"""Largest number of steps."""
RIDGE = 1e-4
"""Weight of |m|^2 |b|^2 in the cost."""


def boxed_dipole(torque_body_nm: Vec3, b_body_t: Vec3, most_am2: float) -> Vec3:
    """The dipole within the limits whose torque is nearest to the demanded one.

    It solves H m = g, H = (1 + ridge) |b|^2 E - b b^T and g = b x M_ref, in the least-squares sense, bounded.

    Args:
        torque_body_nm: M_ref, body axes, N m.
        b_body_t: field, body axes, T; without a field there is no dipole.
        most_am2: m_max of each coil.

    Returns:
        Dipole in body axes, A m^2.
    """
    square = dot(b_body_t, b_body_t)
    if square == 0.0:
        return ZERO
    m, slope = [0.0, 0.0, 0.0], list(cross(b_body_t, torque_body_nm))  # g - H m
    own = [(1.0 + RIDGE) * square - part * part for part in b_body_t]
    step, updates = most_am2, 0
    for _ in range(BITS):
        step *= 0.5
        moved = True
        while moved and updates < UPDATES:
            moved = False
            for i in range(3):
                by = step if slope[i] > 0.0 else -step
                if abs(slope[i]) > 0.5 * step * own[i] and abs(m[i] + by) <= most_am2:
                    m[i] += by
                    for j in range(3):
                        slope[j] -= by * (own[i] if i == j else -b_body_t[i] * b_body_t[j])
                    moved, updates = True, updates + 1
    return (m[0], m[1], m[2])


def boxed(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The PD torque by least squares within the limits."""
    if not inputs.attitude.usable:
        return Demand()
    return _boxed(inputs, attitude_error(dcm(inputs.attitude.q_body_from_orbit)), setpoint, config)


def boxed_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from the goal, by the error that does not vanish upside down."""
    if not inputs.attitude.usable:
        return Demand()
    return _boxed(inputs, far_error(inputs.attitude.q_body_from_orbit), setpoint, config)


def _boxed(inputs: LawInput, error: Vec3, setpoint: Setpoint, config: ControlConfig) -> Demand:
    torque = reference_torque(inputs.b_body_t, inputs.attitude.omega_body_orbit_radps, error, setpoint)
    return Demand(boxed_dipole(torque, inputs.b_body_t, config.mean_dipole_am2))


LAWS = {
    "pd_boxed": LawEntry(48, Aim.THREE_AXIS, boxed_far, boxed),
}
