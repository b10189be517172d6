"""A sliding surface that the coils can reach: its matrix changes so that no torque along the field is needed.

On the surface s = J Omega + K e = 0, with e = 2 qv and K symmetric, positive definite, the attitude decays.
With f = dOmega/dt without control and e' = q0 Omega + qv x Omega, ds/dt = -c s asks for the torque

    M = M0 - K' e,     M0 = -c s - J f - K e'.

Coils give it where b . M = 0, which is one equation for the six elements of K'. Of all symmetric K' the one
with the least sum of squares is taken, n = b / |b|, plus a slow return to K0 = slope w0 J_mean E:

    K' = -r (K - K0) + (n . M0 + r n . (K - K0) e) (n e^T + e n^T) / (|e|^2 + (n . e)^2).

K is carried from tick to tick; a step that would leave least K0 < K < most K0 is halved until it does not,
and what is then left of M along b is lost. The denominator vanishes only where the error does.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Ovchinnikov, Roldugin, Penkov, Tkachev, Mashtakov 2016:
a surface that a magnetic system can realise in full, by a matrix that depends on time and is built step by
step. The review prints no equation; the change of K, its return and its bounds are derived here.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import canonical
from fsw.core.algebra.vector import Mat3, Vec3, add, cross, dot, positive_definite, scale, sub, transform
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.predictive import free_change
from fsw.core.laws.projection import torque_dipole
from fsw.core.laws.sliding import mean_moment
from fsw.core.orbit.ephemeris import Reference

Sym = tuple[float, float, float, float, float, float]
"""A symmetric matrix: elements 11, 22, 33, 23, 13, 12."""

UNIT: Sym = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
STEP_PARTS = (1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.0)
"""Fractions of a step of K that are tried, largest first; the return alone never leaves the bounds."""


@dataclass(frozen=True, slots=True)
class RealisableGains:
    """In units of the orbital rate w0: c = reach w0, K0 = slope w0 J_mean, r = back w0; bounds of K in K0."""

    reach: float = 1.0
    slope: float = 0.3
    back: float = 1.0
    least: float = 0.1
    most: float = 5.0

    def __post_init__(self) -> None:
        """Raises ValueError: a surface on which the attitude would not decay, or bounds without K0."""
        if min(self.reach, self.slope) <= 0.0 or self.back < 0.0:
            raise ValueError("reach and slope must be greater than 0, and back not less than 0")
        if not 0.0 < self.least < 1.0 < self.most:
            raise ValueError("least must be between 0 and 1, and most greater than 1")


def matrix_change(wanted: float, field_direction: Vec3, error: Vec3) -> Sym:
    """The least symmetric K' with n . K' e = ``wanted``; zero where the error is.

    Args:
        wanted: what K' e has to be along the field; K' has the same unit.
        field_direction: n, unit vector, body axes.
        error: e.
    """
    along = dot(field_direction, error)
    size = dot(error, error) + along * along
    if size <= 0.0:
        return (0.0,) * 6
    (n1, n2, n3), (e1, e2, e3) = scale(wanted / size, field_direction), error
    return (
        2.0 * n1 * e1,
        2.0 * n2 * e2,
        2.0 * n3 * e3,
        n2 * e3 + n3 * e2,
        n1 * e3 + n3 * e1,
        n1 * e2 + n2 * e1,
    )


def stepped(matrix: Sym, change: Sym, least: float, most: float) -> Sym:
    """K after the largest fraction of a step that leaves K - least E and most E - K positive definite."""
    tried = (_sum(matrix, change, part) for part in STEP_PARTS)
    return next((k for k in tried if _within(k, least, most)), matrix)


def rows(matrix: Sym) -> Mat3:
    """The whole matrix."""
    k11, k22, k33, k23, k13, k12 = matrix
    return ((k11, k12, k13), (k12, k22, k23), (k13, k23, k33))


def error_and_rate(attitude: Attitude) -> tuple[Vec3, Vec3]:
    """The error e = 2 qv for q0 >= 0, and de/dt = q0 Omega + qv x Omega, rad/s, both in body axes."""
    q0, q1, q2, q3 = canonical(attitude.q_body_from_orbit)
    omega = attitude.omega_body_orbit_radps
    return (2.0 * q1, 2.0 * q2, 2.0 * q3), add(scale(q0, omega), cross((q1, q2, q3), omega))


def sliding_realisable(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The torque to the surface, projected; memory: the six elements of K in units of K0's."""
    square, reference = dot(inputs.b_body_t, inputs.b_body_t), inputs.reference
    if not inputs.attitude.usable or reference is None or square <= 0.0:
        return Demand(memory=memory)
    gains: RealisableGains = config.gains["sliding_realisable"]
    w0, tick_s = reference.orbit_rate_radps, config.tick_s
    stiffness_nms = gains.slope * w0 * mean_moment(config)
    error, _ = error_and_rate(inputs.attitude)
    matrix = _matrix(memory)
    held_nm = fixed_torque(inputs, reference, matrix, stiffness_nms, config)
    n = scale(square**-0.5, inputs.b_body_t)
    returned = _sum(UNIT, _sum(matrix, UNIT, -1.0), max(1.0 - gains.back * w0 * tick_s, 0.0))
    left_nm = _torque(held_nm, matrix, returned, error, stiffness_nms / tick_s)
    change = matrix_change(dot(n, left_nm) * tick_s / stiffness_nms, n, error)
    now = stepped(returned, change, gains.least, gains.most)
    torque_nm = _torque(held_nm, matrix, now, error, stiffness_nms / tick_s)
    return Demand(torque_dipole(torque_nm, inputs.b_body_t), memory=now)


def fixed_torque(
    inputs: LawInput, reference: Reference, matrix: Sym, stiffness_nms: float, config: ControlConfig
) -> Vec3:
    """M0 = -c s - J f - K e', the torque for a constant K, body axes, N m.

    Args:
        inputs: with a usable attitude.
        reference: its orbit.
        matrix: K in K0.
        stiffness_nms: K0.
        config: for the inertia and c.
    """
    gains: RealisableGains = config.gains["sliding_realisable"]
    j, omega = config.inertia_kgm2, inputs.attitude.omega_body_orbit_radps
    free = free_change(inputs, reference, config)
    error, error_rate = error_and_rate(inputs.attitude)
    k = rows(matrix)
    s = add(transform(j, omega), scale(stiffness_nms, transform(k, error)))
    turning = scale(stiffness_nms, transform(k, error_rate))
    reaching = scale(gains.reach * reference.orbit_rate_radps, s)
    return scale(-1.0, add(reaching, add(transform(j, free), turning)))


def _torque(held_nm: Vec3, before: Sym, now: Sym, error: Vec3, factor_nm: float) -> Vec3:
    """The torque M0 - K' e, K' h the change of K in a tick h; ``factor_nm`` is K0 / h."""
    return sub(held_nm, scale(factor_nm, transform(rows(_sum(now, before, -1.0)), error)))


def _matrix(memory: Memory) -> Sym:
    if len(memory) != 6:
        return UNIT
    k11, k22, k33, k23, k13, k12 = memory
    return (k11, k22, k33, k23, k13, k12)


def _sum(a: Sym, b: Sym, part: float) -> Sym:
    """A + part b."""
    (a1, a2, a3, a4, a5, a6), (b1, b2, b3, b4, b5, b6) = a, b
    return (a1 + part * b1, a2 + part * b2, a3 + part * b3, a4 + part * b4, a5 + part * b5, a6 + part * b6)


def _within(matrix: Sym, least: float, most: float) -> bool:
    below = rows(_sum(matrix, UNIT, -least))
    above = rows(_sum((most, most, most, 0.0, 0.0, 0.0), matrix, -1.0))
    return positive_definite(below) and positive_definite(above)


LAWS = {
    "sliding_realisable": LawEntry(
        62, Aim.THREE_AXIS, sliding_realisable, sliding_realisable, RealisableGains
    ),
}
