"""From a torque to a dipole: the weighted projection and the regularised inverse.

A law demands a torque M_ref; coils give M = m x b, normal to the field. Here M_ref is that of the PD law,
-|b|^2 (k_w Omega + k_a S), whose unweighted projection is given by the PD dipole.

Source: Ovchinnikov, Roldugin 2019, section 3.1. The scan damages both formulas; they are derived here.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, dot, scale, sub
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import attitude_error, far_error

NT = 1e-9


@dataclass(frozen=True, slots=True)
class WeightGains:
    """Weights of the torque error about the body axes, all positive; all 0: they are 1 / J_ii."""

    q1: float = 0.0
    q2: float = 0.0
    q3: float = 0.0

    def __post_init__(self) -> None:
        """Raises ValueError: some weights without the others, or a negative one."""
        weights = (self.q1, self.q2, self.q3)
        if any(weights) and not min(weights) > 0.0:
            raise ValueError("q1, q2 and q3 must all be positive, or all 0")


@dataclass(frozen=True, slots=True)
class RegularGains:
    """Square root of lambda, nT."""

    floor_nt: float = 5000.0


def weighted_projection(torque_body_nm: Vec3, b_body_t: Vec3, weights: Vec3) -> Vec3:
    """The torque normal to b nearest to the demanded one: M = M_ref - Q^-1 b (b^T Q^-1 b)^-1 b^T M_ref.

    It minimises (M_ref - M)^T Q (M_ref - M) under M . b = 0: a heavy weight keeps the error off that axis.

    Args:
        torque_body_nm: M_ref, body axes, N m.
        b_body_t: field, body axes, T; without a field there is no torque.
        weights: diagonal of Q, positive.

    Returns:
        M, body axes, N m.
    """
    (b1, b2, b3), (q1, q2, q3) = b_body_t, weights
    eased = (b1 / q1, b2 / q2, b3 / q3)
    size = dot(b_body_t, eased)
    return sub(torque_body_nm, scale(dot(b_body_t, torque_body_nm) / size, eased)) if size > 0.0 else ZERO


def torque_dipole(torque_body_nm: Vec3, b_body_t: Vec3) -> Vec3:
    """The dipole m = b x M / |b|^2, A m^2: the shortest that gives the part of a torque M normal to b."""
    square = dot(b_body_t, b_body_t)
    return scale(1.0 / square, cross(b_body_t, torque_body_nm)) if square > 0.0 else ZERO


def regularised_dipole(torque_body_nm: Vec3, b_body_t: Vec3, floor_t: float) -> Vec3:
    """The dipole m = (B^T B + lambda E)^-1 B^T M_ref with M = B m, B = -[b x], and lambda = floor^2.

    B^T B = |b|^2 E - b b^T has no inverse; with lambda it has, and as B^T M_ref = b x M_ref is normal to b,

        m = b x M_ref / (|b|^2 + lambda):

    the dipole of the projection, scaled down, the more so the weaker the field.

    Args:
        torque_body_nm: M_ref, body axes, N m.
        b_body_t: field, body axes, T.
        floor_t: square root of lambda, T.

    Returns:
        Dipole in body axes, A m^2.
    """
    size = dot(b_body_t, b_body_t) + floor_t * floor_t
    return scale(1.0 / size, cross(b_body_t, torque_body_nm)) if size > 0.0 else ZERO


def reference_torque(b_body_t: Vec3, omega_body_orbit_radps: Vec3, error: Vec3, setpoint: Setpoint) -> Vec3:
    """M_ref = -|b|^2 (k_w Omega + k_a S), body axes, N m."""
    wanted = add(scale(setpoint.k_w, omega_body_orbit_radps), scale(setpoint.k_a, error))
    return scale(-dot(b_body_t, b_body_t), wanted)


def weighted(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the goal, by S: the PD torque by the weighted projection."""
    if not inputs.attitude.usable:
        return Demand()
    return _weighted(inputs, attitude_error(dcm(inputs.attitude.q_body_from_orbit)), setpoint, config)


def weighted_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from the goal, by the error that does not vanish upside down."""
    if not inputs.attitude.usable:
        return Demand()
    return _weighted(inputs, far_error(inputs.attitude.q_body_from_orbit), setpoint, config)


def regularised(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the goal, by S: the PD torque by the regularised inverse."""
    if not inputs.attitude.usable:
        return Demand()
    return _regularised(inputs, attitude_error(dcm(inputs.attitude.q_body_from_orbit)), setpoint, config)


def regularised_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from the goal, by the error that does not vanish upside down."""
    if not inputs.attitude.usable:
        return Demand()
    return _regularised(inputs, far_error(inputs.attitude.q_body_from_orbit), setpoint, config)


def _weighted(inputs: LawInput, error: Vec3, setpoint: Setpoint, config: ControlConfig) -> Demand:
    gains: WeightGains = config.gains["pd_weighted"]
    (j1, _, _), (_, j2, _), (_, _, j3) = config.inertia_kgm2
    weights = (gains.q1, gains.q2, gains.q3)
    if not any(weights):
        weights = (1.0 / j1, 1.0 / j2, 1.0 / j3)
    torque = reference_torque(inputs.b_body_t, inputs.attitude.omega_body_orbit_radps, error, setpoint)
    return Demand(torque_dipole(weighted_projection(torque, inputs.b_body_t, weights), inputs.b_body_t))


def _regularised(inputs: LawInput, error: Vec3, setpoint: Setpoint, config: ControlConfig) -> Demand:
    gains: RegularGains = config.gains["pd_regularised"]
    torque = reference_torque(inputs.b_body_t, inputs.attitude.omega_body_orbit_radps, error, setpoint)
    return Demand(regularised_dipole(torque, inputs.b_body_t, gains.floor_nt * NT))


LAWS = {
    "pd_weighted": LawEntry(50, Aim.THREE_AXIS, weighted_far, weighted, WeightGains),
    "pd_regularised": LawEntry(51, Aim.THREE_AXIS, regularised_far, regularised, RegularGains),
}
