"""Write fsw/wire/messages.py from fsw/wire/torquer.dbc; with --check, exit 1 when the file is stale.

A signal without unit is a code (counter, sequence, tick, CRC) and wraps at its width; a signal with a
unit is a quantity and saturates at its range.
"""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import cantools
from cantools.database.can import Message, Signal

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the tree in which this stands, not the one that is installed

from fsw.wire.frame import id_register
from sim.record.whole_file import replace_text

WIRE = ROOT / "fsw" / "wire"
TARGET = WIRE / "messages.py"
WHOLE_UNITS = (None, "", "ms", "s", "mA")
ENUM_SIGNALS = ("mode", "severity", "reason", "result", "gain", "element", "component")
WIDEST = 110
"""Characters of a line."""
NAMED_BY_MESSAGE = ("reason", "result")
"""Signals whose enum bears the name of the message too."""

MODULE = '''"""Messages of the bus: generated from torquer.dbc by tools/generate_messages.py. Do not edit.

Each message is a value of physical quantities. ``encode`` saturates quantities at the range of their
signal, takes codes modulo their width, and seals the frame with its CRC. ``decode`` only unpacks: length
and CRC are judged by ``intact``.
"""

from enum import IntEnum
from typing import Final, Self, final

from fsw.wire.frame import REMAINDER, Frame, crc8, raw, seal, word_of
from fsw.wire.value import Value

{enums}

{messages}

CountedMessage = {counted}

AnyMessage = CountedMessage | {uncounted}

CLASSES: dict[int, type[AnyMessage]] = {{{classes}}}
"""Class of each message."""

NAMES: dict[int, str] = {{{names}}}
"""Name of each message in the DBC."""

SENDERS: dict[int, str] = {{{senders}}}
"""Node that sends each message."""

_SHAPES: Final[dict[int, tuple[int, int]]] = {{{shapes}}}
"""Length of each message, and the CRC register after its identifier; -1: it has no CRC."""


def intact(frame: Frame) -> bool:
    """Whether the frame is a known message of the right length whose CRC, if it has one, is right."""
    shape = _SHAPES.get(frame.can_id)
    if shape is None:
        return False
    length, register = shape
    data = frame.data
    if len(data) != length:
        return False
    return register < 0 or crc8(data, register) == REMAINDER
'''

ENUM = '''
class {name}(IntEnum):
    """Values of ``{signal}``."""

{members}
'''

MESSAGE = '''
@final
class {name}(Value):
    """{comment}"""

{constants}
    FIELDS = {fields}
    __slots__ = FIELDS

    def __init__(self, {parameters}) -> None:
{assignments}

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = {word}
        return {frame}

    @staticmethod
    def decode(data: bytes) -> "{name}":
        """The values in the data bytes, unjudged."""
        word = {data}
        return {name}({values})
'''

LAYOUT = '''
class _{name}(Value):
    FIELDS = {fields}
    __slots__ = FIELDS

    def __init__(self, {parameters}) -> None:
{assignments}

    def word(self) -> int:
        """The bits of the frame, but for its CRC."""
        return {word}

    @classmethod
    def decode(cls, data: bytes) -> Self:
        """The values in the data bytes, unjudged."""
        word = {data}
        return cls({values})
'''
"""What messages of several nodes share."""

OF_LAYOUT = '''
@final
class {name}(_{layout}):
    """{comment}"""

{constants}
    __slots__ = ()

    def encode(self) -> Frame:
        """The frame on the bus."""
        return {frame}
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


def parameter(signal: Signal) -> str:
    return f"{signal.name}: {python_type(signal)}" + (" = 0" if signal.name == "counter" else "")


def assignment(signal: Signal) -> str:
    notes = [f"[{signal.unit}]"] if signal.unit else []
    notes += [signal.comment] if signal.comment else []
    line, note = f"        self.{signal.name} = {signal.name}", f"# {'; '.join(notes)}"
    if not notes or signal.name == "counter":
        return line
    return f"{line}  {note}" if len(line) + len(note) < WIDEST - 1 else f"        {note}\n{line}"


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


def register(message: Message) -> int:
    """The CRC register after the identifier; -1 if the message has no CRC."""
    return id_register(message.frame_id) if is_sealed(message) else -1


def layout(message: Message) -> str:
    """The form of a message, without its identifier: what is the same for messages of several nodes."""
    return LAYOUT.format(name=camel(message.name.split("_")[-1]), **parts(message))


def parts(message: Message) -> dict[str, str]:
    fields = fields_of(message)
    by_start = sorted(fields, key=lambda signal: signal.start)
    names = ", ".join(f'"{signal.name}"' for signal in fields)
    return {
        "fields": f"({names},)" if len(fields) == 1 else f"({names})",
        "parameters": ", ".join(map(parameter, fields)),
        "assignments": "\n".join(map(assignment, fields)),
        "word": "(" + " | ".join(map(encode_term, by_start)) + ")",
        "data": "word_of(data)" if is_sealed(message) else 'int.from_bytes(data, "little")',
        "values": decode_term(fields[0])[1:-1] if len(fields) == 1 else ", ".join(map(decode_term, fields)),
    }


def message_text(message: Message, shared: bool) -> str:
    can_id, length = message.frame_id, message.length
    word = "self.word()" if shared else "word"
    plain = f'Frame({can_id:#05x}, {word}.to_bytes({length}, "little"))'
    sealed = f"seal({can_id:#05x}, {word}, {length}, {register(message):#04x})"
    return (OF_LAYOUT if shared else MESSAGE).format(
        name=camel(message.name),
        layout=camel(message.name.split("_")[-1]),
        comment=message.comment,
        constants=f"    ID: Final = {can_id:#05x}\n    LENGTH: Final = {length}",
        frame=sealed if is_sealed(message) else plain,
        **parts(message),
    )


def message_texts(messages: list[Message]) -> list[str]:
    """The classes: the layouts that several messages share come before the first of these."""
    counts = Counter(map(layout, messages))
    texts: dict[str, None] = {}
    for message in messages:
        form = layout(message)
        if counts[form] > 1:
            texts[form] = None
        texts[message_text(message, counts[form] > 1)] = None
    return list(texts)


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
            register=f"{register(message):#04x}" if is_sealed(message) else -1,
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
        messages="\n".join(message_texts(messages)),
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
    replace_text(TARGET, text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
