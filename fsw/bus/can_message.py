"""Frames as python-can's messages, and back."""

import can

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame

_FLAGS = EXTENDED_FLAG | REMOTE_FLAG | ERROR_FLAG


def message_of(frame: Frame, timestamp_s: float = 0.0, channel: str | None = None) -> can.Message:
    """The frame as python-can's message."""
    can_id, data = frame.can_id, frame.data
    remote = bool(can_id & REMOTE_FLAG)
    return can.Message(
        timestamp=timestamp_s,
        channel=channel,
        arbitration_id=can_id & ~_FLAGS,
        is_extended_id=bool(can_id & EXTENDED_FLAG),
        is_remote_frame=remote,
        is_error_frame=bool(can_id & ERROR_FLAG),
        dlc=len(data),
        data=None if remote else data,
    )


def frame_of(message: can.Message) -> Frame:
    """The message as a frame; a remote one holds as many zeros as it asks for."""
    can_id = message.arbitration_id
    if message.is_extended_id:
        can_id |= EXTENDED_FLAG
    if message.is_error_frame:
        can_id |= ERROR_FLAG
    if message.is_remote_frame:
        return Frame(can_id | REMOTE_FLAG, bytes(message.dlc))
    return Frame(can_id, bytes(message.data))
