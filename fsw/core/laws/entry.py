"""An entry of the table of laws: what a law is for, its two forms and its own parameters."""

from enum import StrEnum
from typing import NamedTuple

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


class LawEntry(NamedTuple):
    """A law: its number in telecommands, its aim, its forms in ACQUIRE and POINT, and its own parameters.

    The parameters are a class, a frozen dataclass of floats with defaults, or None for a law with none. A law
    that plans pulses has no use for a continuous driver. One that is ``open_loop`` is flown in DETUMBLE too.
    """

    number: int
    aim: Aim
    acquire: Law
    point: Law
    gains: type | None = None
    plans_pulses: bool = False
    open_loop: bool = False
