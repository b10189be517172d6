"""What pulsed coils can be asked for, and how the body moves from one opportunity to the next."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fsw.core.algebra.vector import Mat3, Vec3, product, scale, skew
from fsw.core.laws.plan.orbit_ahead import Sight
from fsw.core.laws.plan.riccati import Array, Problem
from fsw.wire.value import Value

NEVER = -1
"""Ticks until a coil with a fault may be fired."""
AXES: Mat3 = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@final
class Pulse(Value):
    """A pulse to fire: coil 0..2, level -3..3; level 0 is none."""

    FIELDS = ("coil", "level")
    __slots__ = FIELDS

    def __init__(self, coil: int, level: int) -> None:
        self.coil = coil
        self.level = level


NO_PULSE = Pulse(0, 0)


@dataclass(frozen=True, slots=True)
class PulseModel:
    """The choices at an opportunity, and the step from one to the next.

    ``pulses`` are none, then coil by coil each level with either sign; ``turns``, shape (19, 3, 3), are
    J^-1 [T_p m x] of each, which turns the field into a change of rate. There are ``step_ticks`` from one
    opportunity to the next, for which ``problem`` has the motion, and ``rest`` steps from a pulse to the next
    of the same coil. ``searched``: how many opportunities are searched; ``sight``: how the orbit is seen
    from the middle of the first pulse on: at the pulse of each, midway from each to the next, and in the
    steps after them.
    """

    pulses: tuple[Pulse, ...]
    turns: Array
    step_ticks: int
    rest: int
    problem: Problem
    searched: int
    sight: Sight


def choices(
    levels_am2: Vec3, pulse_s: float, inertia_inverse: Mat3, coil_axes: Mat3 = AXES
) -> tuple[tuple[Pulse, ...], Array]:
    """``pulses`` and ``turns`` of a body whose coils have these levels, and dipoles per unit nominal one."""
    fired = [
        (Pulse(coil, sign * level), scale(sign * levels_am2[level - 1] * pulse_s, coil_axes[coil]))
        for coil in range(3)
        for level in (1, 2, 3)
        for sign in (1, -1)
    ]
    pulses, impulses_am2_s = zip((NO_PULSE, (0.0, 0.0, 0.0)), *fired, strict=True)
    return pulses, np.array([product(inertia_inverse, skew(impulse)) for impulse in impulses_am2_s])


def kicks(model: PulseModel, b_body_t: Array) -> Array:
    """The change of rate by each choice, J^-1 (T_p m x b), rad/s: (..., 19, 3) for b of (..., 3)."""
    changes: Array = np.add.reduce(model.turns * b_body_t[..., None, None, :], axis=-1)
    return changes
