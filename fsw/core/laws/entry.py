"""An entry of the table of laws: what a law is for, its two forms and its own parameters."""

from dataclasses import dataclass
from enum import StrEnum

from fsw.core.algebra.vector import Vec3
from fsw.core.laws.interface import Law


class Aim(StrEnum):
    """What a law is for; laws of one aim can be compared."""

    THREE_AXIS = "three_axis"
    """The whole attitude is held to the orbital frame."""
    AXIS = "axis"
    """A body axis with a wheel is held to its direction, the body turned about it."""
    RATE = "rate"
    """The rate is damped, to zero or to the spin of the setpoint."""
    SPIN = "spin"
    """A spin is built up, or the axis of one is turned."""
    SUN = "sun"
    """An axis is turned to the Sun."""
    INERTIAL = "inertial"
    """The whole attitude is held to a target fixed in inertial space."""
    VERTICAL = "vertical"
    """An axis is held to the local vertical, the body free to turn about it."""
    CHECK = "check"
    """Nothing is held: it shows what coils and sensors do."""


class Need(StrEnum):
    """What a law cannot do without: flown without it, it would never ask for anything."""

    NOTHING = "nothing"
    """It asks for dipoles, which every driver of coils gives."""
    PULSES = "pulses"
    """It plans the pulses of a pulsed driver."""
    MOMENTUM = "momentum"
    """It holds the axis of a wheel that turns at constant speed along the orbit's normal, axis 3."""
    DRIVEN_WHEEL = "driven_wheel"
    """It asks for torques of a wheel."""
    PITCH_WHEEL = "pitch_wheel"
    """It asks for torques of a wheel along that axis."""


LEAST_COSINE = 0.99
"""Of the angle between such a wheel and that axis."""


@dataclass(frozen=True, slots=True)
class LawEntry:
    """A law: its number in telecommands, its aim, its forms in ACQUIRE and POINT, and its own parameters.

    The parameters are a class, a frozen dataclass of floats with defaults, or None for a law with none. One
    that is ``open_loop`` is flown in DETUMBLE too.
    """

    number: int
    aim: Aim
    acquire: Law
    point: Law
    gains: type | None = None
    needs: Need = Need.NOTHING
    open_loop: bool = False


def is_met(need: Need, pulsed: bool, wheel_body_nms: Vec3, driven_axis_body: Vec3 | None) -> bool:
    """Whether a satellite has what a law needs; body axes are those that the laws count by.

    Args:
        need: of the law.
        pulsed: whether its coils are pulsed.
        wheel_body_nms: constant momentum of a wheel, body axes.
        driven_axis_body: unit vector along a wheel that can be driven; None: there is none.
    """
    met = {
        Need.NOTHING: True,
        Need.PULSES: pulsed,
        Need.MOMENTUM: wheel_body_nms[2] > 0.0,
        Need.DRIVEN_WHEEL: driven_axis_body is not None,
        Need.PITCH_WHEEL: driven_axis_body is not None and driven_axis_body[2] >= LEAST_COSINE,
    }
    return met[need]
