"""Whether somebody flies on a bus already: it is listened to, and a silent flight software is asked."""

import time

from fsw.bus.interface import Bus, BusError
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, PlantBoot, Sync, TickDone, intact

LISTEN_S = 1.3
"""A plant that waits for its flight software speaks every second."""
ASK_S = 0.5
"""Flight software that waits for its plant answers PLANT_BOOT at once."""

FLYING = frozenset({"PLANT", "FSW"})
"""Who must not be there already; boards may."""
ANYBODY = FLYING | {"COIL", "MAG", "SUN"}


def refuse_taken(bus: Bus, spec: str, senders: frozenset[str] = ANYBODY) -> None:
    """Nothing, if none of the senders is on the bus.

    Args:
        bus: to listen on.
        spec: what people know it by.
        senders: nodes that must not be there.

    Raises:
        BusError: one of them speaks.
    """
    frame = _heard(bus, LISTEN_S, senders)
    if frame is None:
        bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
        frame = _heard(bus, ASK_S, senders)
    if frame is not None:
        raise BusError(f"{spec} is taken: {_named(frame)} was heard before the flight began")


def _heard(bus: Bus, seconds: float, senders: frozenset[str]) -> Frame | None:
    """The first whole frame of one of the senders."""
    deadline = time.monotonic() + seconds
    while (left_s := deadline - time.monotonic()) > 0.0:
        frame = bus.receive(left_s)
        if frame is not None and intact(frame) and SENDERS[frame.can_id] in senders:
            return frame
    return None


def _named(frame: Frame) -> str:
    name = f"{NAMES[frame.can_id]} ({frame.can_id:03X})"
    for message in (Sync, TickDone):
        if frame.can_id == message.ID:
            return f"{name} of tick {message.decode(frame.data).tick}"
    return name
