"""The order of telecommands from the bus in the log: each is in the tick in whose inbox it was.

The plant may receive a telecommand after it has sent SYNC, and the flight software the same one before.
TC_ACK decides: it names the command and the tick.
"""

from collections import Counter

from fsw.wire.frame import Frame
from fsw.wire.messages import SENDERS, TcAck, intact

FROM_GROUND = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "GROUND")


def has_from_ground(frames: list[Frame]) -> bool:
    """Whether a frame under an identifier of the ground is among them."""
    ground = False
    for frame in frames:
        ground = ground or frame.can_id in FROM_GROUND
    return ground


def split_at_sync(inbox: list[Frame], after: list[Frame], tick: int) -> tuple[list[Frame], list[Frame]]:
    """Separate the telecommands that were in this tick's inbox from the later frames.

    Args:
        inbox: frames that were in this tick's inbox in any case.
        after: frames that the plant received after it had sent SYNC.
        tick: of that SYNC.

    Returns:
        The telecommands of ``after`` that the flight software acknowledges in this tick, beyond those of
        ``inbox``, and the rest of ``after``.
    """
    acks = [TcAck.decode(frame.data) for frame in after if frame.can_id == TcAck.ID and intact(frame)]
    answered = Counter((ack.command, ack.command_counter) for ack in acks if ack.tick == tick)
    answered.subtract(map(_key, filter(_is_telecommand, inbox)))
    before, later = [], []
    for frame in after:
        if _is_telecommand(frame) and answered[_key(frame)] > 0:
            answered[_key(frame)] -= 1
            before.append(frame)
        else:
            later.append(frame)
    return before, later


def _is_telecommand(frame: Frame) -> bool:
    return frame.can_id in FROM_GROUND and intact(frame)


def _key(frame: Frame) -> tuple[int, int]:
    """Identifier and counter, by which TC_ACK refers to a telecommand."""
    return frame.can_id, frame.data[0] & 0xF
