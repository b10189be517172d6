"""The decode gate: from raw frames to the messages of one tick.

A frame is taken whole or not at all: known identifier, right length and CRC, a counter that moved, values
in range. Everything else is counted and dropped, and so is a telecommand in the midst of noise.
"""

from dataclasses import dataclass, field
from typing import final
from zlib import crc32

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    SENDERS,
    CoilBoot,
    CoilDipoleStatus,
    CoilRefused,
    CoilStatus,
    MagField,
    PlantEnd,
    RefAttitude,
    RefRate,
    SunCells,
    SunVector,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
    WheelStatus,
    intact,
)

INBOX_LIMIT = 64
"""Frames read in one tick; a babbling node cannot cost more than that.

After skipped ticks these are the latest, and before them as many telecommands.
"""

NOISE_LIMIT = 8
"""Broken frames in one tick beyond which no telecommand is believed.

One frame of noise in 256 passes the CRC by chance. A faulty line breaks no more than the few that nodes send.
"""

InputMessage = (
    MagField
    | SunVector
    | CoilStatus
    | CoilRefused
    | RefAttitude
    | RefRate
    | CoilDipoleStatus
    | CoilBoot
    | PlantEnd
    | SunCells
    | WheelStatus
)

INPUT_MESSAGES: dict[int, type[InputMessage]] = {
    MagField.ID: MagField,
    SunVector.ID: SunVector,
    CoilStatus.ID: CoilStatus,
    CoilRefused.ID: CoilRefused,
    RefAttitude.ID: RefAttitude,
    RefRate.ID: RefRate,
    CoilDipoleStatus.ID: CoilDipoleStatus,
    CoilBoot.ID: CoilBoot,
    PlantEnd.ID: PlantEnd,
    SunCells.ID: SunCells,
    WheelStatus.ID: WheelStatus,
}

Telecommand = (
    TcMode | TcClear | TcLaw | TcSpin | TcGain | TcOrbitElement | TcOrbitLoad | TcParameter | TcFreeze
)

TELECOMMANDS: dict[int, type[Telecommand]] = {
    TcMode.ID: TcMode,
    TcClear.ID: TcClear,
    TcLaw.ID: TcLaw,
    TcSpin.ID: TcSpin,
    TcGain.ID: TcGain,
    TcOrbitElement.ID: TcOrbitElement,
    TcOrbitLoad.ID: TcOrbitLoad,
    TcParameter.ID: TcParameter,
    TcFreeze.ID: TcFreeze,
}

_ACCEPTED: dict[int, type[InputMessage | Telecommand]] = {**INPUT_MESSAGES, **TELECOMMANDS}
_SLOT = {can_id: slot for slot, can_id in enumerate(_ACCEPTED)}
_IN_ANY_PLACE = frozenset({*TELECOMMANDS, PlantEnd.ID})
"""Identifiers of messages that other nodes may send between those of the boards."""
_OWN = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
"""Identifiers of fsw: no other node is to use them."""
_COIL_SLOTS = [slot for can_id, slot in _SLOT.items() if SENDERS[can_id] == "COIL"]


@final
@dataclass(slots=True)
class Readings:
    """The last accepted message of each kind in this tick, as it was sent; None where there was none.

    Telecommands are all taken, in order of reception; ``repeated`` are those with the counter of the one
    before. ``under_own_id`` is the lowest identifier of fsw itself under which an intact frame came, 0 if
    none did. ``end`` is a PLANT_END after which the flight has gone on.
    """

    field: MagField | None = None
    sun: SunVector | None = None
    coil: CoilStatus | None = None
    refused: CoilRefused | None = None
    ref_attitude: RefAttitude | None = None
    ref_rate: RefRate | None = None
    dipole: CoilDipoleStatus | None = None
    coil_boot: CoilBoot | None = None
    end: PlantEnd | None = None
    cells: SunCells | None = None
    wheel: WheelStatus | None = None
    telecommands: tuple[Telecommand, ...] = ()
    repeated: tuple[Telecommand, ...] = ()
    under_own_id: int = 0

    def take(self, message: InputMessage | Telecommand) -> None:
        """Keep an accepted message, in the place of an earlier one of its kind if it is not a telecommand."""
        if isinstance(message, MagField):
            self.field = message
        elif isinstance(message, SunVector):
            self.sun = message
        elif isinstance(message, CoilStatus):
            self.coil = message
        elif isinstance(message, CoilRefused):
            self.refused = message
        elif isinstance(message, RefAttitude):
            self.ref_attitude = message
        elif isinstance(message, RefRate):
            self.ref_rate = message
        elif isinstance(message, CoilDipoleStatus):
            self.dipole = message
        elif isinstance(message, CoilBoot):
            self.coil_boot = message
        elif isinstance(message, PlantEnd):
            self.end = message
        elif isinstance(message, SunCells):
            self.cells = message
        elif isinstance(message, WheelStatus):
            self.wheel = message
        else:
            self.telecommands = (*self.telecommands, message)


@final
@dataclass(slots=True)
class GateState:
    """Last counter of each message listened to (-1: none yet), and counts and CRCs since boot.

    ``rejected``: broken, unknown, repeated, out of range, or a telecommand in noise; ``missed``: jumps of a
    counter; ``overrun``: frames beyond the limit, unread. ``input_crc`` is the CRC-32 of the data of all
    accepted messages: no accepted frame can be altered in a log without a change of the state CRC, not even
    an unused sample. ``command_crc`` is the same for telecommands and PLANT_END, which may come between the
    boards' messages in any order.
    """

    counters: list[int] = field(default_factory=lambda: [-1] * len(_ACCEPTED))
    rejected: int = 0
    missed: int = 0
    overrun: int = 0
    input_crc: int = 0
    command_crc: int = 0


def admit(frames: tuple[Frame, ...], state: GateState, skipped: bool = False) -> Readings:
    """Judge the frames of one tick.

    Args:
        frames: in the order of reception.
        state: of the tick before; it becomes that of this one.
        skipped: the frames are those of several ticks.
    """
    readings, counters = Readings(), state.counters
    read = _latest(frames) if skipped else frames[:INBOX_LIMIT]
    state.overrun += len(frames) - len(read)
    whole = [intact(frame) for frame in read]
    noisy = whole.count(False) > NOISE_LIMIT
    for place, frame in enumerate(read):
        can_id = frame.can_id
        message_class = _ACCEPTED.get(can_id)
        if message_class is None:
            if not whole[place]:
                state.rejected += 1
            elif can_id in _OWN:
                readings.under_own_id = min(readings.under_own_id or can_id, can_id)
            continue
        if not whole[place] or (noisy and can_id in TELECOMMANDS):
            state.rejected += 1
            continue
        message = message_class.decode(frame.data)
        slot = _SLOT[can_id]
        step = (message.counter - counters[slot]) & 0xF
        if can_id == CoilBoot.ID:  # a board that boots counts anew
            for coil_slot in _COIL_SLOTS:
                counters[coil_slot] = -1
        has_counter = counters[slot] >= 0
        if (has_counter and step == 0) or not _in_range(message):
            state.rejected += 1
            if isinstance(message, Telecommand):
                readings.repeated = (*readings.repeated, message)
            continue
        if has_counter:
            state.missed += step - 1
        counters[slot] = message.counter
        readings.take(message)
        if can_id in _IN_ANY_PLACE:
            state.command_crc = crc32(frame.data, state.command_crc)
        else:
            state.input_crc = crc32(frame.data, state.input_crc)
    return readings


def _latest(frames: tuple[Frame, ...]) -> tuple[Frame, ...]:
    """What is read of the frames of several ticks: what the boards say now, and what they are told once."""
    before = [frame for frame in frames[:-INBOX_LIMIT] if frame.can_id in _IN_ANY_PLACE]
    return (*before[:INBOX_LIMIT], *frames[-INBOX_LIMIT:])


def _in_range(message: InputMessage | Telecommand) -> bool:
    """Whether the values are possible; ``commands`` judges and answers those of telecommands."""
    if isinstance(message, CoilStatus):
        return -3 <= message.level <= 3 and message.coil <= 2
    if isinstance(message, SunVector) and message.valid:
        square = message.s_x**2 + message.s_y**2 + message.s_z**2
        return 0.8 < square < 1.2
    if isinstance(message, RefAttitude):
        return message.q_x**2 + message.q_y**2 + message.q_z**2 < 1.0001  # 1, and the wire's rounding
    return True
