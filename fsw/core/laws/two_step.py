"""Two turns across the field in place of one about it, where the field does not turn.

Near the magnetic equator the field keeps its direction N in the orbital frame, and no torque acts about it.
But any attitude is two turns about axes normal to N: q = A (x) P. With q = (q0, v), z = v . N and equal
angles phi of both turns, c = cos(phi / 2), s = sin(phi / 2), at a1 and a2 in the plane normal to N,

    q0 = c^2 - s^2 cos(a2 - a1),     z = -s^2 sin(a2 - a1),
    v across N = 2 c s cos((a2 - a1) / 2) at the angle (a1 + a2) / 2,

whence s^2 = ((1 - q0)^2 + z^2) / (2 (1 - q0)) <= 1 and tan((a2 - a1) / 2) = -z / (1 - q0). A turn about N
alone, however small, takes two half turns. Of q and -q the one with the smaller phi is taken. The PD law
turns to P, about an axis across the field, and from there to the goal; while the turn about N is small it
turns to the goal at once. In both turns J f is subtracted from the torque, f = dOmega/dt without control,
so that nothing bends the path: for a sphere f = w0 Omega x e3, normal to a field along the orbit normal.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Inamori, Otsuki, Sugawara, Saisutjarit, Nakasuka 2016,
for a sphere. The review prints no equation; the split is derived here.
"""

from dataclasses import dataclass
from math import atan2, cos, radians, sin, sqrt

from fsw.core.algebra.quaternion import IDENTITY, Quaternion, conjugate, multiply, rotate
from fsw.core.algebra.vector import Vec3, add, cross, dot, norm, scale, sub, transform, unit
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import far_error, pd_dipole
from fsw.core.laws.predictive import free_change
from fsw.core.laws.projection import torque_dipole

FREE, FIRST, SECOND = 0.0, 1.0, 2.0
"""Stages: the PD law alone, on the way to P, on the way from P to the goal."""


@dataclass(frozen=True, slots=True)
class TwoStepGains:
    """Angle about the field from which two turns are made; angle and rate at which one of them is done."""

    begin_deg: float = 15.0
    done_deg: float = 3.0
    done_degps: float = 0.01

    def __post_init__(self) -> None:
        """Raises ValueError: angles or rate out of range, or turns that would begin again at once."""
        if not 0.0 < self.done_deg < self.begin_deg < 180.0 or self.done_degps <= 0.0:
            raise ValueError("0 < done_deg < begin_deg < 180, and done_degps must be greater than 0")


def first_turn(q_body_from_orbit: Quaternion, field_direction: Vec3) -> Quaternion:
    """P, the attitude between the two turns; of q and -q, the one with the smaller angle is taken.

    Args:
        q_body_from_orbit: q, not the goal.
        field_direction: N, unit vector, orbital axes.
    """
    q0, q1, q2, q3 = q_body_from_orbit
    ways = (_split(q_body_from_orbit, field_direction), _split((-q0, -q1, -q2, -q3), field_direction))
    return max(ways, key=lambda p: abs(p[0]))


def _split(q: Quaternion, n: Vec3) -> Quaternion:
    """The attitude P for this sign of q; the goal where q is the goal."""
    q0, q1, q2, q3 = q
    v = (q1, q2, q3)
    rest, z = 1.0 - q0, dot(v, n)
    if rest <= 0.0:
        return IDENTITY
    square = min((rest * rest + z * z) / (2.0 * rest), 1.0)
    x, y = _across(n)
    mean = atan2(dot(v, y), dot(v, x))
    at = mean - atan2(-z, rest)
    s = sqrt(square)
    p1, p2, p3 = scale(s, add(scale(cos(at), x), scale(sin(at), y)))
    return (sqrt(1.0 - square), p1, p2, p3)


def _across(n: Vec3) -> tuple[Vec3, Vec3]:
    """Two axes that make n the third of a right-handed frame."""
    least = min(range(3), key=lambda axis: abs(n[axis]))
    helper: Vec3 = (float(least == 0), float(least == 1), float(least == 2))
    x = unit(cross(helper, n))
    return x, cross(n, x)


def two_step(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The turns one after the other; memory: the stage, and P, body from orbit."""
    reference = inputs.reference
    if not inputs.attitude.usable or reference is None or dot(inputs.b_body_t, inputs.b_body_t) <= 0.0:
        return Demand()
    gains: TwoStepGains = config.gains["two_step"]
    q = inputs.attitude.q_body_from_orbit
    stage, goal = _next(inputs, memory, gains)
    off = multiply(conjugate(goal if stage == FIRST else IDENTITY), q)
    omega = inputs.attitude.omega_body_orbit_radps
    dipole = pd_dipole(inputs.b_body_t, omega, far_error(off), setpoint.k_w, setpoint.k_a)
    if stage != FREE:
        bending = transform(config.inertia_kgm2, free_change(inputs, reference, config))
        dipole = sub(dipole, torque_dipole(bending, inputs.b_body_t))
    return Demand(dipole, memory=(stage, *goal))


def _next(inputs: LawInput, memory: Memory, gains: TwoStepGains) -> tuple[float, Quaternion]:
    """The stage of this tick, and P; a turn is done when its component across the field is."""
    q, n = inputs.attitude.q_body_from_orbit, unit(inputs.b_body_t)
    stage, goal = (memory[0], (memory[1], memory[2], memory[3], memory[4])) if memory else (FREE, IDENTITY)
    slow = norm(inputs.attitude.omega_body_orbit_radps) < radians(gains.done_degps)
    off = multiply(conjugate(goal if stage == FIRST else IDENTITY), q)
    done = slow and 2.0 * norm(_part_across((off[1], off[2], off[3]), n)) < radians(gains.done_deg)
    if stage == FIRST and done:
        return SECOND, goal
    if stage == SECOND and done:
        return FREE, IDENTITY
    about_rad = 2.0 * atan2(abs(dot((q[1], q[2], q[3]), n)), abs(q[0]))
    if stage == FREE and about_rad > radians(gains.begin_deg):
        return FIRST, first_turn(q, rotate(conjugate(q), n))
    return stage, goal


def _part_across(v: Vec3, n: Vec3) -> Vec3:
    return sub(v, scale(dot(v, n), n))


LAWS = {
    "two_step": LawEntry(58, Aim.THREE_AXIS, two_step, two_step, TwoStepGains),
}
