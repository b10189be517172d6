"""Whether a bus is in use by another flight: listen to it, and request FSW_BOOT of idle flight software."""

import time

from fsw.bus.interface import Bus, BusError
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, PlantBoot, Sync, TickDone, intact

LISTEN_S = 1.3
"""A plant that waits for its flight software sends more often."""
ASK_S = 0.5
"""Flight software that waits for its plant answers PLANT_BOOT at once."""

FLIGHT_NODES = frozenset({"PLANT", "FSW"})
"""Nodes that must not be on the bus yet where boards may be."""
ALL_NODES = FLIGHT_NODES | {"COIL", "MAG", "SUN", "WHEEL"}


def refuse_bus_in_use(bus: Bus, spec: str, senders: frozenset[str] = ALL_NODES) -> None:
    """Raise an error if one of the senders is on the bus.

    Args:
        bus: to listen to.
        spec: the bus as the user wrote it.
        senders: nodes that must not be on the bus.

    Raises:
        BusError: a frame of one of them was received.
    """
    frame = _first_frame(bus, LISTEN_S, senders)
    if frame is None:
        bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
        frame = _first_frame(bus, ASK_S, senders)
    if frame is not None:
        raise BusError(f"{spec} is in use: {_describe(frame)} was received before the flight began")


def _first_frame(bus: Bus, seconds: float, senders: frozenset[str]) -> Frame | None:
    """The first whole frame of one of the senders."""
    deadline = time.monotonic() + seconds
    while (left_s := deadline - time.monotonic()) > 0.0:
        frame = bus.receive(left_s)
        if frame is not None and intact(frame) and SENDERS[frame.can_id] in senders:
            return frame
    return None


def _describe(frame: Frame) -> str:
    name = f"{NAMES[frame.can_id]} ({frame.can_id:03X})"
    for message in (Sync, TickDone):
        if frame.can_id == message.ID:
            return f"{name} of tick {message.decode(frame.data).tick}"
    return name
