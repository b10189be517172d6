"""The bus contract as data: messages and signals with units, enumerations and comments, from the DBC."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import fsw.wire
from sim.errors import needing

DBC = Path(fsw.wire.__file__).with_name("torquer.dbc")

SLUGS = {"nT": "nt", "rad": "rad", "rad/s": "radps", "ms": "ms", "s": "s", "mA": "ma", "N m": "nm"}
"""Ending of a name by the unit of the signal; a fraction has none."""


@dataclass(frozen=True, slots=True)
class Signal:
    """A signal of a message.

    Attributes:
        name: in the DBC.
        start: its lowest bit, counted from the lowest bit of the first byte.
        length: bits, the lowest first.
        signed: whether in two's complement.
        scale: physical value of one unit of the raw one.
        low: least physical value.
        high: greatest physical value.
        unit: as in the DBC, ``1`` for a fraction, empty for a code.
        choices: name by raw value.
        comment: in the DBC.
    """

    name: str
    start: int
    length: int
    signed: bool
    scale: float
    low: float
    high: float
    unit: str
    choices: dict[int, str]
    comment: str

    @property
    def field(self) -> str:
        """Its name with its unit."""
        slug = SLUGS.get(self.unit)
        return self.name if slug is None or self.name.endswith(f"_{slug}") else f"{self.name}_{slug}"

    @property
    def is_whole(self) -> bool:
        """Whether physical values are whole numbers."""
        return self.scale == int(self.scale)


@dataclass(frozen=True, slots=True)
class Message:
    """A message, its signals by their lowest bit.

    ``cycle_ms`` is its period at one tick a second, 0 where it comes as needed.
    """

    name: str
    can_id: int
    length: int
    sender: str
    comment: str
    cycle_ms: int
    signals: tuple[Signal, ...]


@cache
def messages() -> tuple[Message, ...]:
    """All messages, by identifier.

    Raises:
        HarnessError: the package cantools, which reads the DBC, is missing.
    """
    with needing("the DBC", "cantools", "export"):
        import cantools  # noqa: PLC0415  an extra
    database = cantools.database.load_file(DBC, database_format="dbc")
    return tuple(_message(found) for found in sorted(database.messages, key=lambda found: found.frame_id))


def _message(found: Any) -> Message:  # noqa: ANN401  of cantools, which may be missing
    signals = sorted(map(_signal, found.signals), key=lambda signal: signal.start)
    cycle_ms, sender = found.cycle_time or 0, found.senders[0]
    return Message(
        found.name, found.frame_id, found.length, sender, found.comment or "", cycle_ms, tuple(signals)
    )


def _signal(found: Any) -> Signal:  # noqa: ANN401  of cantools, which may be missing
    return Signal(
        found.name,
        found.start,
        found.length,
        found.is_signed,
        float(found.scale),
        float(found.minimum),
        float(found.maximum),
        found.unit or "",
        {number: str(label) for number, label in sorted((found.choices or {}).items())},
        found.comment or "",
    )


# --- The DBC for other tools, its cycle times at any tick rate

_CYCLE = re.compile(r'(?m)^(BA_ "GenMsgCycleTime" BO_ \d+ )1000;$')
"""The cycle time of a message that is sent every tick; the others are in seconds, whatever the tick rate."""


def dbc_text(tick_hz: int) -> str:
    """The DBC, messages of every tick being ``tick_hz`` times a second."""
    text = DBC.read_text(encoding="utf-8")
    return _CYCLE.sub(rf"\g<1>{round(1000 / tick_hz)};", text)
