"""Telecommands of a scenario: what the ground sends, at which time and as which frames.

``[[telecommand]]`` gives the message and, in readable units, its content. Ranges are those of the wire, not
those that the flight software accepts: a scenario may show a rejection.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from decimal import Decimal
from math import ceil
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, Strict, field_validator

from fsw.core.laws.table import LAWS, number_of
from fsw.core.orbit.propagation import sgp4_orbit
from fsw.core.orbit.tle import plain_line, tle_elements
from fsw.input.schema import Section
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    Component,
    CountedMessage,
    Element,
    Gain,
    Mode,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
)

Uplink = Callable[[int], list[Frame]]
"""The frames that the ground sends before the SYNC of a tick."""

MOST_DIGITS = 2**31 - 1


def _that_fits(value: float) -> float:
    digits_of(Decimal(repr(value)))
    return value


DecimalValue = Annotated[float, AfterValidator(_that_fits)]
"""A number that has a mantissa and an exponent on the wire."""


class TelecommandSection(Section):
    """A telecommand and its time: sent before the first SYNC at or after ``at_s`` since the epoch."""

    at_s: float = Field(ge=0.0)

    def messages(self) -> list[CountedMessage]:
        """The messages to send, with counters 0."""
        raise NotImplementedError


class SendMode(TelecommandSection):
    """TC_MODE."""

    message: Literal["TC_MODE"]
    mode: Literal[tuple(Mode.__members__)]  # type: ignore[valid-type]  # those of the table

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [TcMode(Mode[self.mode])]


class SendClear(TelecommandSection):
    """TC_CLEAR."""

    message: Literal["TC_CLEAR"]

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [TcClear()]


class SendLaw(TelecommandSection):
    """TC_LAW: the law by its name, or ``own`` for the scenario's own law, which is not in the table."""

    message: Literal["TC_LAW"]
    law: Literal[(*LAWS, "own")]  # type: ignore[valid-type]  # those of the table

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [TcLaw(number_of(self.law))]


class SendSpin(TelecommandSection):
    """TC_SPIN."""

    message: Literal["TC_SPIN"]
    spin_radps: float = Field(ge=-0.125, lt=0.125)

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [TcSpin(self.spin_radps)]


class SendGain(TelecommandSection):
    """TC_GAIN, in the units of the control table."""

    message: Literal["TC_GAIN"]
    gain: Literal["k_w", "k_a", "k_i"]
    value: DecimalValue

    def messages(self) -> list[CountedMessage]:
        """One message."""
        mantissa, exponent = digits_of(Decimal(repr(self.value)))
        return [TcGain(Gain[self.gain.upper()], exponent, mantissa)]


class SendElement(TelecommandSection):
    """TC_ORBIT_ELEMENT."""

    message: Literal["TC_ORBIT_ELEMENT"]
    element: Literal[tuple(name.lower() for name in Element.__members__)]  # type: ignore[valid-type]  # those of the table
    value: DecimalValue

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [_element(Element[self.element.upper()], Decimal(repr(self.value)))]


class SendOrbit(TelecommandSection):
    """TC_ORBIT_LOAD; where ``tle`` is given, preceded by all its elements."""

    message: Literal["TC_ORBIT_LOAD"]
    tle: Annotated[tuple[str, str] | None, Strict(False)] = None

    @field_validator("tle")
    @classmethod
    def _is_one(cls, value: tuple[str, str] | None) -> tuple[str, str] | None:
        if value is None:
            return None
        value = plain_line(value[0]), plain_line(value[1])
        sgp4_orbit(*value)
        return value

    def messages(self) -> list[CountedMessage]:
        """One message, or nine elements and it."""
        elements = [] if self.tle is None else [_element(*pair) for pair in elements_of(*self.tle).items()]
        return [*elements, TcOrbitLoad()]


class SendParameter(TelecommandSection):
    """TC_PARAMETER: a number that the filter estimates, by its name in the DBC, SI units."""

    message: Literal["TC_PARAMETER"]
    component: Literal[tuple(name.lower() for name in Component.__members__)]  # type: ignore[valid-type]  # those of the table
    value: DecimalValue

    def messages(self) -> list[CountedMessage]:
        """One message."""
        mantissa, exponent = digits_of(Decimal(repr(self.value)))
        return [TcParameter(Component[self.component.upper()], exponent, mantissa)]


class SendFreeze(TelecommandSection):
    """TC_FREEZE: whether the parameters of the filter stay as they are."""

    message: Literal["TC_FREEZE"]
    frozen: bool

    def messages(self) -> list[CountedMessage]:
        """One message."""
        return [TcFreeze(int(self.frozen))]


Telecommand = Annotated[
    SendMode
    | SendClear
    | SendLaw
    | SendSpin
    | SendGain
    | SendElement
    | SendOrbit
    | SendParameter
    | SendFreeze,
    Field(discriminator="message"),
]
Telecommands = Annotated[tuple[Telecommand, ...], Strict(False)]


def first_tick(telecommand: TelecommandSection, tick_hz: int) -> int:
    """The tick in which it is sent, the first at or after its time."""
    return ceil(telecommand.at_s * tick_hz - 1e-9)


def uplink(telecommands: Sequence[TelecommandSection], tick_hz: int) -> Uplink:
    """The frames of each tick, with a counter for each kind of message."""
    frames: dict[int, list[Frame]] = {}
    counters: Counter[int] = Counter()
    for telecommand in sorted(telecommands, key=lambda telecommand: telecommand.at_s):
        tick = first_tick(telecommand, tick_hz)
        for message in telecommand.messages():
            message.counter = counters[message.ID] & 0xF
            frames.setdefault(tick, []).append(message.encode())
            counters[message.ID] += 1
    return lambda tick: frames.get(tick, [])


def unsent_telecommands(telecommands: Sequence[Telecommand], tick_hz: int, ticks: int) -> list[str]:
    """A sentence for each telecommand that ``uplink`` does not send in so many ticks: it comes after them."""
    return [
        f"telecommand[{place}], {telecommand.message} at {telecommand.at_s:g} s, will not be sent: "
        f"the last tick is at {(ticks - 1) / tick_hz:g} s"
        for place, telecommand in enumerate(telecommands)
        if first_tick(telecommand, tick_hz) >= ticks
    ]


def digits_of(value: Decimal) -> tuple[int, int]:
    """Mantissa and exponent of a decimal number, as on the wire.

    Raises:
        ValueError: it has more digits than 32 bits hold, or is too large or too small.
    """
    sign, digits, exponent = value.normalize().as_tuple()
    mantissa = int("".join(map(str, digits)))
    if not isinstance(exponent, int) or mantissa > MOST_DIGITS or not -128 <= exponent <= 127:
        raise ValueError(f"{value} does not fit: at most {MOST_DIGITS} times a power of ten from -128 to 127")
    return -mantissa if sign else mantissa, exponent


def elements_of(line1: str, line2: str) -> dict[Element, Decimal]:
    """The numbers of a two-line element set, digit by digit.

    Raises:
        ValueError: the lines are not an element set.
    """
    elements = tle_elements(line1, line2)
    return {element: Decimal(repr(getattr(elements, element.name.lower()))) for element in Element}


def _element(element: Element, value: Decimal) -> CountedMessage:
    mantissa, exponent = digits_of(value)
    return TcOrbitElement(element, exponent, mantissa)
