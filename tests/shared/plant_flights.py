"""Flights of the plant alone: what it says on the bus, and the truth."""

from fsw.wire import messages
from fsw.wire.messages import (
    CLASSES,
    CoilFire,
)


def decode(frames):
    assert all(messages.intact(frame) for frame in frames)
    return [CLASSES[frame.can_id].decode(frame.data) for frame in frames]


def only(kind, said):
    (message,) = (message for message in said if isinstance(message, kind))
    return message


def fire(plant, coil=1, level=2, duration_ms=3000, seq=1):
    plant.receive(CoilFire(level, coil, seq, plant.tick & 0xFF, duration_ms).encode())


def fly(plant, ticks, commands=None):
    """Messages and truth of some ticks; ``commands`` are called with the plant at their ticks."""
    history = []
    for _ in range(ticks):
        said, truth = decode(plant.begin_tick()), plant.truth()
        (commands or {}).get(plant.tick, lambda plant: None)(plant)
        history.append((said, truth))
        plant.end_tick()
    return history
