"""What came where a boot or an answer was awaited, and why it is neither, with the bytes that would be."""

from fsw.wire.candump_line import frame_text
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame, crc8
from fsw.wire.messages import CLASSES, NAMES, FswBoot, TickDone, intact
from sim.console import counted
from sim.judge.answers import crc_as_sent, tick_as_named
from sim.record.run_record import UnheardRecord

FLAGS = {
    EXTENDED_FLAG: "bit 31 of its identifier makes it an extended frame",
    REMOTE_FLAG: "bit 30 of its identifier makes it a remote frame",
    ERROR_FLAG: "bit 29 of its identifier makes it an error frame",
}
IDENTIFIER = 0x1FFF_FFFF
MOST_NAMED = 3
FIRST_BOOT = FswBoot(0, 1, 0).encode()


def tell_unheard(unheard: UnheardRecord | None) -> str:
    """What came instead of what was awaited, a clause; empty where that is not known.

    Args:
        unheard: of run.json, None if nothing was noted.
    """
    if unheard is None:
        return ""
    awaited = FIRST_BOOT if unheard["tick"] is None else TickDone(unheard["tick"], 0).encode()
    frames = [Frame(one["id"], bytes.fromhex(one["data"])) for one in unheard["frames"]]
    if not frames:
        return "nothing came"
    name = NAMES[awaited.can_id]
    found = list(dict.fromkeys(_why(frame, awaited, unheard["tick"]) for frame in frames))
    likely = [why for why in found if why.startswith(name)]
    named = (likely or found)[:MOST_NAMED]
    more = len(likely or found) - len(named)
    others = f", and {counted(more, 'other frame')}" if more else ""
    return f"{'' if likely else f'no {name} came, but '}{', '.join(named)}{others}"


def _why(frame: Frame, awaited: Frame, tick: int | None) -> str:
    """A frame and why it is not what was awaited."""
    number, text = frame.can_id & IDENTIFIER, frame_text(frame)
    name = NAMES.get(number, "")
    for flag, words in FLAGS.items():
        if frame.can_id & flag:
            return f"{name or 'a frame'} came as {text}: {words}, and the contract has 11 bits without flags"
    if not name:
        return _of_no_message(frame, text)
    length = CLASSES[number].LENGTH
    if len(frame.data) != length:
        expected = f", as in {frame_text(awaited)}" if number == awaited.can_id else ""
        return f"{name} came as {text}, of {counted(len(frame.data), 'byte')} and not of {length}{expected}"
    if not intact(frame):
        return f"{name} came as {text}, {_of_its_crc(frame)}"
    if number == TickDone.ID and tick is not None:
        return tick_as_named(tick, TickDone.decode(frame.data).tick)
    return f"{name} came as {text}"


def _of_its_crc(frame: Frame) -> str:
    body = frame.data[:-1]
    right = Frame(frame.can_id, body + bytes([crc8(frame.can_id.to_bytes(2, "big") + body)]))
    how = crc_as_sent(frame)
    return f"with a wrong CRC, expected {frame_text(right)}{f': {how}' if how else ''}"


def _of_no_message(frame: Frame, text: str) -> str:
    for size in (2, 4):
        if frame.can_id < 1 << 8 * size:
            number = int.from_bytes(frame.can_id.to_bytes(size, "little"), "big")
            if number in NAMES:
                return f"{NAMES[number]} came as {text}: its identifier has its bytes the other way round"
    return f"a frame of no message came as {text}"
