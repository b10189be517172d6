"""Write fsw/wire/messages.py from fsw/wire/torquer.dbc; with --check, exit 1 when the file is stale.

A signal without unit is a code (counter, sequence, tick, CRC) and wraps at its width; a signal with a
unit is a quantity and saturates at its range.
"""

import subprocess
import sys
from pathlib import Path

import cantools
from cantools.database.can import Message, Signal

WIRE = Path(__file__).resolve().parent.parent / "fsw" / "wire"
TARGET = WIRE / "messages.py"
WHOLE_UNITS = (None, "", "ms", "s", "mA")
ENUM_SIGNALS = ("mode", "severity", "reason", "result", "gain", "element", "component")
NAMED_BY_MESSAGE = ("reason", "result")
"""Signals whose enum bears the name of the message too."""

MODULE = '''"""Messages of the bus: generated from torquer.dbc by tools/generate_messages.py. Do not edit.

Each message is a named tuple of physical values. ``encode`` saturates quantities at the range of their
signal, takes codes modulo their width, and seals the frame with its CRC. ``decode`` only unpacks: length
and CRC are judged by ``intact``.
"""

from enum import IntEnum
from typing import Final, NamedTuple

from fsw.wire.frame import Frame, crc8, id_register, raw, seal

{enums}

{registers}

{messages}

CountedMessage = {counted}

AnyMessage = CountedMessage | {uncounted}

CLASSES: dict[int, type[AnyMessage]] = {{{classes}}}
"""Class of each message."""

NAMES: dict[int, str] = {{{names}}}
"""Name of each message in the DBC."""

SENDERS: dict[int, str] = {{{senders}}}
"""Node that sends each message."""

_SHAPES: dict[int, tuple[int, int | None]] = {{{shapes}}}


def intact(frame: Frame) -> bool:
    """Whether the frame is a known message of the right length whose CRC, if it has one, is right."""
    shape = _SHAPES.get(frame.can_id)
    if shape is None:
        return False
    length, register = shape
    data = frame.data
    if len(data) != length:
        return False
    return register is None or crc8(data[:-1], register) == data[-1]
'''

ENUM = '''
class {name}(IntEnum):
    """Values of ``{signal}``."""

{members}
'''

MESSAGE = '''
class _{name}(NamedTuple):
{fields}


class {name}(_{name}):
    """{comment}"""

    __slots__ = ()

    ID: Final = {can_id:#05x}
    LENGTH: Final = {length}

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            {word}
        )
        return {frame}

    @classmethod
    def decode(cls, data: bytes) -> "{name}":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls({values})
'''


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def is_sealed(message: Message) -> bool:
    return any(signal.name == "crc" for signal in message.signals)


def python_type(signal: Signal) -> str:
    return "int" if signal.unit in WHOLE_UNITS else "float"


def fields_of(message: Message) -> list[Signal]:
    """The signals a message holds: in the order of their bits, the counter last, the CRC left out."""
    fields = [signal for signal in message.signals if signal.name != "crc"]
    return sorted(fields, key=lambda signal: (signal.name == "counter", signal.start))


def field_line(signal: Signal) -> str:
    if signal.name == "counter":
        return "    counter: int = 0"
    notes = [f"[{signal.unit}]"] if signal.unit else []
    notes += [signal.comment] if signal.comment else []
    return f"    {signal.name}: {python_type(signal)}" + (f"  # {'; '.join(notes)}" if notes else "")


def encode_term(signal: Signal) -> str:
    mask, shift = hex((1 << signal.length) - 1), f" << {signal.start}" if signal.start else ""
    if not signal.unit:
        return f"(self.{signal.name} & {mask}){shift}"
    half = 1 << (signal.length - 1)
    low, high = (-half, half - 1) if signal.is_signed else (0, 2 * half - 1)
    code = f"raw(self.{signal.name}, {signal.scale!r}, {low}, {high})"
    return f"({code} & {mask}){shift}" if signal.is_signed else f"{code}{shift}"


def decode_term(signal: Signal) -> str:
    shifted = f"word >> {signal.start}" if signal.start else "word"
    bits = f"{shifted} & {(1 << signal.length) - 1:#x}"
    if signal.is_signed:
        half = 1 << (signal.length - 1)
        bits = f"(({bits} ^ {half:#x}) - {half:#x})"
    else:
        bits = f"({bits})"
    if python_type(signal) == "float":
        return f"{bits} * {float(signal.scale)!r}"
    return bits if signal.scale == 1 else f"{bits} * {signal.scale!r}"


def message_text(message: Message) -> str:
    fields, name, can_id = fields_of(message), camel(message.name), message.frame_id
    by_start = sorted(fields, key=lambda signal: signal.start)
    sealed = f"seal({can_id:#05x}, word, {message.length}, _{message.name})"
    plain = f'Frame({can_id:#05x}, word.to_bytes({message.length}, "little"))'
    return MESSAGE.format(
        name=name,
        fields="\n".join(map(field_line, fields)),
        comment=message.comment,
        can_id=can_id,
        length=message.length,
        word="\n            | ".join(map(encode_term, by_start)),
        frame=sealed if is_sealed(message) else plain,
        values=", ".join(map(decode_term, fields)) + ",",
    )


def enum_texts(messages: list[Message]) -> list[str]:
    texts: dict[str, str] = {}
    for message in messages:
        for signal in message.signals:
            if signal.name not in ENUM_SIGNALS or not signal.choices or message.name.endswith("_BOOT"):
                continue
            owner = camel(message.name) if signal.name in NAMED_BY_MESSAGE else ""
            name = owner + camel(signal.name)
            members = (
                f"    {str(label).upper()} = {value}" for value, label in sorted(signal.choices.items())
            )
            text = ENUM.format(name=name, signal=signal.name, members="\n".join(members))
            texts.setdefault(name, text)
    return list(texts.values())


def table(messages: list[Message], cell: str) -> str:
    rows = (
        cell.format(
            id=f"{message.frame_id:#05x}",
            cls=camel(message.name),
            name=message.name,
            sender=message.senders[0],
            length=message.length,
            register=f"_{message.name}" if is_sealed(message) else None,
        )
        for message in messages
    )
    return "".join(f"\n    {row}," for row in rows) + "\n"


def module_text() -> str:
    database = cantools.database.load_file(WIRE / "torquer.dbc")
    messages = sorted(database.messages, key=lambda message: message.frame_id)
    sealed = [message for message in messages if is_sealed(message)]
    unsealed = [message for message in messages if not is_sealed(message)]
    return MODULE.format(
        enums="\n".join(enum_texts(messages)),
        registers="\n".join(f"_{m.name} = id_register({m.frame_id:#05x})" for m in sealed),
        messages="\n".join(map(message_text, messages)),
        counted=" | ".join(camel(m.name) for m in sealed),
        uncounted=" | ".join(camel(m.name) for m in unsealed),
        classes=table(messages, "{id}: {cls}"),
        names=table(messages, '{id}: "{name}"'),
        senders=table(messages, '{id}: "{sender}"'),
        shapes=table(messages, "{id}: ({length}, {register})"),
    )


def formatted(text: str) -> str:
    command = [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(TARGET), "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def main() -> int:
    text = formatted(module_text())
    if "--check" in sys.argv:
        stale = not TARGET.exists() or TARGET.read_text() != text
        print(f"{TARGET.name} is {'stale: run tools/generate_messages.py' if stale else 'as the DBC says'}")
        return int(stale)
    TARGET.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
