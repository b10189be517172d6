"""What a user needs to write a control law of their own; docs/own-law.md shows one.

A law is a function of the form ``Law``: called once a tick in ACQUIRE and POINT, pure, with whatever it must
remember in ``Demand.memory``. Without gains of its own the function is all that a file needs; with gains, or
with another form in ACQUIRE, a ``ControlLaw`` names it. Its gains are in ``config.gains[setpoint.law]``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from fsw.core.algebra.vector import ZERO
from fsw.core.laws import interface
from fsw.core.laws.entry import Aim
from fsw.core.laws.interface import ControlConfig, FieldSample, LawInput, Memory, Setpoint
from fsw.input.quantities import quantity

GROUP = "torquer.laws"
"""Group of the entry points by which installed packages offer laws."""

__all__ = [
    "GROUP",
    "NO_PULSE",
    "Aim",
    "ControlConfig",
    "ControlLaw",
    "Demand",
    "FieldSample",
    "Law",
    "LawInput",
    "Memory",
    "Pulse",
    "Setpoint",
    "quantity",
]


class Pulse(NamedTuple):
    """A pulse to fire: coil 0..2, level -3..3; level 0 is none."""

    coil: int
    level: int


NO_PULSE = Pulse(0, 0)


class Demand(NamedTuple):
    """What a law demands, of numbers and sequences of any kind; what it means is said in ``interface``."""

    m_body_am2: Any = ZERO
    impulse_body_nms: Any = None
    memory: Any = ()
    pulse: Any = None
    wheel_torque_nm: Any = None


Law = Callable[[LawInput, Memory, Setpoint, ControlConfig], Demand | interface.Demand]
"""One control law: pure, called once a tick. It may return what a shipped one has answered."""


@dataclass(frozen=True)
class ControlLaw:
    """A law with what belongs to it.

    Attributes:
        point: its form in POINT.
        acquire: its form in ACQUIRE; None: the same.
        gains: its own parameters, a frozen dataclass of numbers with defaults, or None. ``quantity`` gives a
            number its unit and its range.
        aim: what it is for; laws with the same aim are compared.
    """

    point: Law
    acquire: Law | None = None
    gains: type | None = None
    aim: Aim = Aim.THREE_AXIS
