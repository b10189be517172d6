"""The decode gate: from raw frames to the readings of one tick.

A frame is taken whole or not at all: known identifier, right length and CRC, a counter that moved, values
in range. Everything else is counted and dropped, and so is a telecommand in the midst of noise.
"""

from typing import NamedTuple
from zlib import crc32

from fsw.core.algebra.vector import Vec3
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
_OPTIONAL_SLOTS = (_SLOT[SunCells.ID], _SLOT[WheelStatus.ID])
"""Of messages that few satellites have."""
_COIL_SLOTS = [slot for can_id, slot in _SLOT.items() if SENDERS[can_id] == "COIL"]


class Readings(NamedTuple):
    """The last accepted message of each kind in this tick; None where there was none.

    Telecommands are all taken, in order of reception; ``repeated`` are those with the counter of the one
    before. ``under_own_id`` is the lowest identifier of fsw itself under which an intact frame came, 0 if
    none did. ``end`` is a PLANT_END after which the flight has gone on. ``quiet``: no coil has been driven
    for as long as a field sample may be old. ``unusable_cells``: those of ``cells`` not to be trusted.
    ``settled``: what the coils add to the field sample is known, and has been subtracted. ``saturated``: for
    each axis of the magnetometer that is at the end of its range, the direction of ``field``, body axes, that
    follows from its reading.
    """

    field: MagField | None
    sun: SunVector | None
    coil: CoilStatus | None
    refused: CoilRefused | None
    ref_attitude: RefAttitude | None
    ref_rate: RefRate | None
    dipole: CoilDipoleStatus | None = None
    coil_boot: CoilBoot | None = None
    end: PlantEnd | None = None
    cells: SunCells | None = None
    wheel: WheelStatus | None = None
    telecommands: tuple[Telecommand, ...] = ()
    repeated: tuple[Telecommand, ...] = ()
    under_own_id: int = 0
    quiet: bool = True
    unusable_cells: tuple[int, ...] = ()
    settled: bool = False
    saturated: tuple[Vec3, ...] = ()


NOTHING = Readings(None, None, None, None, None, None)


class GateState(NamedTuple):
    """Last counter of each message listened to (-1: none yet), and counts and CRCs since boot.

    ``input_crc`` is the CRC-32 of the data of all accepted messages: no accepted frame can be altered in a
    log without a change of the state CRC, not even an unused sample. ``command_crc`` is the same for
    telecommands and PLANT_END, which may come between the boards' messages in any order.
    """

    counters: tuple[int, ...] = (-1,) * len(_ACCEPTED)
    rejected: int = 0
    missed: int = 0
    overrun: int = 0
    input_crc: int = 0
    command_crc: int = 0


def admit(frames: tuple[Frame, ...], state: GateState, skipped: bool = False) -> tuple[Readings, GateState]:
    """Judge the frames of one tick.

    Args:
        frames: in the order of reception.
        state: of the tick before.
        skipped: the frames are those of several ticks.

    Returns:
        The readings, and the gate's state with ``rejected`` (broken, unknown, repeated, out of range, or a
        telecommand in noise), ``missed`` (jumps of a counter), ``overrun`` (frames beyond the limit, unread),
        ``input_crc`` and ``command_crc`` updated.
    """
    slots: list[object] = [None] * len(INPUT_MESSAGES)
    telecommands: list[Telecommand] = []
    repeated: list[Telecommand] = []
    counters = list(state.counters)
    rejected, missed = state.rejected, state.missed
    digests = [state.input_crc, state.command_crc]
    under_own_id = 0
    read = _latest(frames) if skipped else frames[:INBOX_LIMIT]
    heard = [(frame, intact(frame)) for frame in read]
    noisy = sum(not whole for _, whole in heard) > NOISE_LIMIT
    for frame, whole in heard:
        message_class = _ACCEPTED.get(frame.can_id)
        if message_class is None:
            if not whole:
                rejected += 1
            elif frame.can_id in _OWN:
                under_own_id = min(under_own_id or frame.can_id, frame.can_id)
            continue
        if not whole or (noisy and frame.can_id in TELECOMMANDS):
            rejected += 1
            continue
        message = message_class.decode(frame.data)
        slot = _SLOT[frame.can_id]
        step = (message.counter - counters[slot]) & 0xF
        if message_class is CoilBoot:  # a board that boots counts anew
            for coil_slot in _COIL_SLOTS:
                counters[coil_slot] = -1
        has_counter = counters[slot] >= 0
        if (has_counter and step == 0) or not _in_range(message):
            rejected += 1
            if isinstance(message, Telecommand):
                repeated.append(message)
            continue
        if has_counter:
            missed += step - 1
        counters[slot] = message.counter
        if isinstance(message, Telecommand):
            telecommands.append(message)
        else:
            slots[slot] = message
        digest = frame.can_id in _IN_ANY_PLACE
        digests[digest] = crc32(frame.data, digests[digest])
    overrun = state.overrun + len(frames) - len(read)
    rest = (tuple(telecommands), tuple(repeated), under_own_id)
    readings = Readings(*slots, *rest)  # type: ignore[arg-type, call-arg]  # each slot is of its field's kind
    return readings, GateState(tuple(counters), rejected, missed, overrun, *digests)


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
