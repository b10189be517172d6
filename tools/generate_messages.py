"""Write fsw/wire/messages.py from fsw/wire/torquer.dbc; with --check, exit 1 when the file is stale.

A signal without unit is a code (counter, sequence, tick, CRC) and wraps at its width; a signal with a
unit is a quantity and saturates at its range.
"""

import sys
from pathlib import Path

import cantools
from cantools.database.can import Message, Signal

WIRE = Path(__file__).resolve().parent.parent / "fsw" / "wire"

HEADER = '''"""Messages of the bus: generated from torquer.dbc by tools/generate_messages.py. Do not edit.

Each message is a named tuple of physical values. ``encode`` saturates quantities at the range of their
signal, takes codes modulo their width, and seals the frame with its CRC. ``decode`` only unpacks: length
and CRC are judged by ``intact``.
"""

from enum import IntEnum
from typing import Final, NamedTuple

from fsw.wire.frame import Frame, crc8, id_register, raw, seal
'''

FOOTER = '''

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


def class_name(message_name: str) -> str:
    return "".join(part.capitalize() for part in message_name.split("_"))


def enum_name(message: Message, signal: Signal) -> str:
    return class_name(signal.name) if signal.name in ("mode", "severity") else class_name(message.name) + class_name(signal.name)


def is_quantity(signal: Signal) -> bool:
    return bool(signal.unit)


def python_type(signal: Signal) -> str:
    return "int" if signal.unit in (None, "", "ms", "s", "mA") else "float"


def payload_signals(message: Message) -> list[Signal]:
    return sorted((s for s in message.signals if s.name not in ("crc", "counter")), key=lambda s: s.start)


def raw_limits(signal: Signal) -> tuple[int, int]:
    if signal.is_signed:
        return -(1 << (signal.length - 1)), (1 << (signal.length - 1)) - 1
    return 0, (1 << signal.length) - 1


def encode_term(signal: Signal) -> str:
    mask = hex((1 << signal.length) - 1)
    if is_quantity(signal):
        low, high = raw_limits(signal)
        code = f"raw(self.{signal.name}, {signal.scale!r}, {low}, {high})"
    else:
        code = f"self.{signal.name}"
    if is_quantity(signal) and not signal.is_signed:
        term = code
    else:
        term = f"{code} & {mask}"
    return f"({term}) << {signal.start}" if signal.start else f"({term})"


def decode_term(signal: Signal) -> str:
    mask = (1 << signal.length) - 1
    shifted = f"word >> {signal.start}" if signal.start else "word"
    bits = f"({shifted} & {mask:#x})"
    if signal.is_signed:
        sign = 1 << (signal.length - 1)
        bits = f"(({shifted} & {mask:#x} ^ {sign:#x}) - {sign:#x})"
    if signal.scale == 1:
        return bits
    return f"{bits} * {float(signal.scale) if python_type(signal) == 'float' else signal.scale!r}"


def message_class(message: Message) -> str:
    sealed = any(s.name == "crc" for s in message.signals)
    fields = payload_signals(message) + [s for s in message.signals if s.name == "counter"]
    name = class_name(message.name)
    lines = ["", "", f"class _{name}(NamedTuple):"]
    for signal in fields:
        default = " = 0" if signal.name == "counter" else ""
        note = "; ".join(part for part in (f"[{signal.unit}]" if signal.unit else "", signal.comment or "") if part)
        comment = f"  # {note}" if note and signal.name != "counter" else ""
        lines.append(f"    {signal.name}: {python_type(signal)}{default}{comment}")
    lines += ["", "", f"class {name}(_{name}):", f'    """{message.comment}"""', "", "    __slots__ = ()"]
    lines += ["", f"    ID: Final = {message.frame_id:#05x}", f"    LENGTH: Final = {message.length}"]
    word = "\n            | ".join(encode_term(s) for s in sorted(fields, key=lambda s: s.start))
    lines += ["", "    def encode(self) -> Frame:", '        """The frame on the bus."""', "        word = (", f"            {word}", "        )"]
    if sealed:
        lines.append(f"        return seal({message.frame_id:#05x}, word, {message.length}, _{message.name})")
    else:
        lines.append(f'        return Frame({message.frame_id:#05x}, word.to_bytes({message.length}, "little"))')
    values = "\n".join(f"            {decode_term(s)}," for s in fields)
    lines += ["", "    @classmethod", f'    def decode(cls, data: bytes) -> "{class_name(message.name)}":', '        """The values in the data bytes, unjudged."""', '        word = int.from_bytes(data, "little")', "        return cls(", values, "        )"]
    return "\n".join(lines)


def enum_class(name: str, signal: Signal) -> str:
    members = "\n".join(f"    {str(label).upper()} = {value}" for value, label in sorted((signal.choices or {}).items()))
    return f'\n\nclass {name}(IntEnum):\n    """Values of ``{signal.name}``."""\n\n{members}'


def generate() -> str:
    database = cantools.database.load_file(WIRE / "torquer.dbc")
    messages = sorted(database.messages, key=lambda m: m.frame_id)
    parts = [HEADER]
    enums: dict[str, str] = {}
    for message in messages:
        for signal in message.signals:
            if signal.choices and signal.name in ("mode", "severity", "reason") and not message.name.endswith("_BOOT"):
                name = enum_name(message, signal)
                enums.setdefault(name, enum_class(name, signal))
    parts += enums.values()
    sealed = [m for m in messages if any(s.name == "crc" for s in m.signals)]
    parts.append("\n\n" + "\n".join(f"_{m.name} = id_register({m.frame_id:#05x})" for m in sealed))
    parts += [message_class(m) for m in messages]
    rows = [f"    {m.frame_id:#05x}: ({m.length}, {'_' + m.name if m in sealed else 'None'})," for m in messages]
    parts.append("\n\n_SHAPES: dict[int, tuple[int, int | None]] = {\n" + "\n".join(rows) + "\n}\n")
    names = [f"    {m.frame_id:#05x}: {class_name(m.name)}," for m in messages]
    parts.append("\nNAMES: dict[int, str] = {\n" + "\n".join(f'    {m.frame_id:#05x}: "{m.name}",' for m in messages) + '\n}\n"""Name of each message in the DBC."""\n')
    parts.append("\nSENDERS: dict[int, str] = {\n" + "\n".join(f'    {m.frame_id:#05x}: "{m.senders[0]}",' for m in messages) + '\n}\n"""Node that sends each message."""\n')
    counted = " | ".join(class_name(m.name) for m in sealed)
    parts.append(f"\nCountedMessage = {counted}\n")
    parts.append("\nAnyMessage = CountedMessage | Sync | TickDone\n")
    parts.append("\nCLASSES: dict[int, type[AnyMessage]] = {\n" + "\n".join(names) + '\n}\n"""Class of each message."""\n')
    parts.append(FOOTER)
    return "".join(part if part.startswith(("\n", '"""')) else "\n" + part for part in parts)


def formatted(text: str) -> str:
    import subprocess

    return subprocess.run(["ruff", "format", "--stdin-filename", str(WIRE / "messages.py"), "-"], input=text, capture_output=True, text=True, check=True).stdout


def main() -> int:
    target = WIRE / "messages.py"
    text = formatted(generate())
    if "--check" in sys.argv:
        stale = not target.exists() or target.read_text() != text
        print(f"{target.name} is {'stale: run tools/generate_messages.py' if stale else 'as the DBC says'}")
        return int(stale)
    target.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
