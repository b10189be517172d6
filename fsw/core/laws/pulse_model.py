"""What pulsed coils can be asked for, and how the body moves from one opportunity to the next."""

from typing import NamedTuple

from fsw.core.algebra.vector import Mat3, Vec3, cross, scale, transform
from fsw.core.laws.riccati import Problem

NEVER = -1
"""Ticks until a coil may be fired that has a fault."""
AXES: Mat3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Pulse(NamedTuple):
    """A pulse to fire: coil 0..2, level -3..3; level 0 is none."""

    coil: int
    level: int


NO_PULSE = Pulse(0, 0)


class PulseModel(NamedTuple):
    """The choices at an opportunity, and the step from one to the next.

    ``pulses`` are none, then coil by coil each level with either sign, ``impulses_am2_s`` their T_p m, body
    axes. There are ``step_ticks`` from one opportunity to the next, for which ``problem`` has the motion, and
    ``rest`` steps from a pulse to the next of the same coil.
    """

    pulses: tuple[Pulse, ...]
    impulses_am2_s: tuple[Vec3, ...]
    step_ticks: int
    rest: int
    problem: Problem


def pulse_model(levels_am2: Vec3, pulse_s: float, step_ticks: int, rest: int, problem: Problem) -> PulseModel:
    """The model of coils with these levels."""
    choices = [
        (Pulse(coil, sign * level), scale(sign * levels_am2[level - 1] * pulse_s, AXES[coil]))
        for coil in range(3)
        for level in (1, 2, 3)
        for sign in (1, -1)
    ]
    pulses, impulses = zip((NO_PULSE, (0.0, 0.0, 0.0)), *choices, strict=True)
    return PulseModel(pulses, impulses, step_ticks, rest, problem)


def kicks(model: PulseModel, b_body_t: Vec3, inertia_inverse: Mat3) -> list[Vec3]:
    """The change of rate by each choice, J^-1 (T_p m x b), body axes, rad/s."""
    return [transform(inertia_inverse, cross(impulse, b_body_t)) for impulse in model.impulses_am2_s]
