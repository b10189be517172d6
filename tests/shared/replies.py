"""What the controller answered, message by message."""

from fsw.wire.messages import (
    FswEvent,
)


def of(kind, messages):
    return [message for message in messages if isinstance(message, kind)]


def events_of(ticks):
    """(tick, event, argument) of every FSW_EVENT, by the tick in which it was sent."""
    return [(tick, m.event, m.argument) for tick, replies in enumerate(ticks) for m in of(FswEvent, replies)]
