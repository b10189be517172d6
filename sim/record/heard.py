"""Where telecommands of others stand in the log: with the tick whose inbox they were in.

A command that meets the plant's own frames on the bus comes to the plant after it has sent SYNC, though the
flight software may have heard it before. Its TC_ACK tells: it names command and tick.
"""

from collections import Counter

from fsw.wire.frame import Frame
from fsw.wire.messages import SENDERS, TcAck, intact

FROM_GROUND = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "GROUND")


def heard_before_sync(known: list[Frame], after: list[Frame], tick: int) -> tuple[list[Frame], list[Frame]]:
    """Tell the telecommands that were in this tick's inbox from what came later.

    Args:
        known: frames that were in this tick's inbox in any case.
        after: frames that came to the plant after it had sent SYNC.
        tick: of that SYNC.

    Returns:
        The telecommands of ``after`` that the flight software acknowledges in this tick beyond those known,
        and the rest of ``after``.
    """
    if not any(frame.can_id in FROM_GROUND for frame in after):
        return [], after
    acks = [TcAck.decode(frame.data) for frame in after if frame.can_id == TcAck.ID and intact(frame)]
    answered = Counter((ack.command, ack.command_counter) for ack in acks if ack.tick == tick)
    answered.subtract(map(_name, filter(_is_telecommand, known)))
    heard, later = [], []
    for frame in after:
        if _is_telecommand(frame) and answered[_name(frame)] > 0:
            answered[_name(frame)] -= 1
            heard.append(frame)
        else:
            later.append(frame)
    return heard, later


def _is_telecommand(frame: Frame) -> bool:
    return frame.can_id in FROM_GROUND and intact(frame)


def _name(frame: Frame) -> tuple[int, int]:
    """As TC_ACK names it: identifier and counter."""
    return frame.can_id, frame.data[0] & 0xF
