"""The decode gate: from raw frames to the messages of one tick.

A frame is taken whole or not at all: known identifier, right length and CRC, a counter that moved, values
in range. Everything else is counted and dropped, and so is a telecommand in the midst of noise.
"""

from dataclasses import dataclass, field
from typing import Final, final
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
from fsw.wire.value import Value

INBOX_LIMIT: Final = 64
"""Frames read in one tick; a babbling node cannot cost more than that.

After skipped ticks these are the latest, and before them as many telecommands.
"""

NOISE_LIMIT: Final = 8
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

INPUT_MESSAGES: Final[dict[int, type[InputMessage]]] = {
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

TELECOMMANDS: Final[dict[int, type[Telecommand]]] = {
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

_SLOT: Final = {can_id: slot for slot, can_id in enumerate({**INPUT_MESSAGES, **TELECOMMANDS})}
_IN_ANY_PLACE: Final = frozenset({*TELECOMMANDS, PlantEnd.ID})
"""Identifiers of messages that other nodes may send between those of the boards."""
_OWN: Final = frozenset([can_id for can_id, sender in SENDERS.items() if sender == "FSW"])
"""Identifiers of fsw: no other node is to use them."""
_COIL_SLOTS: Final = [slot for can_id, slot in _SLOT.items() if SENDERS[can_id] == "COIL"]


@final
class Readings(Value):
    """The last accepted message of each kind in this tick, as it was sent; None where there was none.

    Refusals and telecommands are all taken, in order of reception; ``repeated`` are telecommands with the
    counter of the one before. ``under_own_id`` is the lowest identifier of fsw itself under which an intact
    frame came, 0 if none did. ``end`` is a PLANT_END after which the flight has gone on. Filled by ``admit``.
    """

    FIELDS = (
        *("field", "sun", "coil", "refused", "ref_attitude", "ref_rate", "dipole", "coil_boot", "end"),
        *("cells", "wheel", "telecommands", "repeated", "under_own_id"),
    )
    __slots__ = FIELDS

    def __init__(
        self,
        field: MagField | None = None,
        sun: SunVector | None = None,
        coil: CoilStatus | None = None,
        refused: tuple[CoilRefused, ...] = (),
        ref_attitude: RefAttitude | None = None,
        ref_rate: RefRate | None = None,
        dipole: CoilDipoleStatus | None = None,
        coil_boot: CoilBoot | None = None,
        end: PlantEnd | None = None,
        cells: SunCells | None = None,
        wheel: WheelStatus | None = None,
        telecommands: tuple[Telecommand, ...] = (),
        repeated: tuple[Telecommand, ...] = (),
        under_own_id: int = 0,
    ) -> None:
        self.field = field
        self.sun = sun
        self.coil = coil
        self.refused = refused
        self.ref_attitude = ref_attitude
        self.ref_rate = ref_rate
        self.dipole = dipole
        self.coil_boot = coil_boot
        self.end = end
        self.cells = cells
        self.wheel = wheel
        self.telecommands = telecommands
        self.repeated = repeated
        self.under_own_id = under_own_id


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

    counters: list[int] = field(default_factory=lambda: [-1] * len(_SLOT))
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
    readings, inputs, commands = Readings(), b"", b""
    read = _latest(frames) if skipped else frames[:INBOX_LIMIT]
    state.overrun += len(frames) - len(read)
    whole = [intact(frame) for frame in read]
    noisy = whole.count(False) > NOISE_LIMIT
    for place, frame in enumerate(read):
        can_id = frame.can_id
        slot = _SLOT.get(can_id, -1)
        if not whole[place] or (noisy and can_id in TELECOMMANDS):
            state.rejected += 1
        elif slot >= 0:
            if not _judge(readings, frame, state, slot):
                state.rejected += 1
            elif can_id in _IN_ANY_PLACE:
                commands += frame.data
            else:
                inputs += frame.data
        elif can_id in _OWN:
            readings.under_own_id = min(readings.under_own_id or can_id, can_id)
    state.input_crc = crc32(inputs, state.input_crc)
    if commands:
        state.command_crc = crc32(commands, state.command_crc)
    return readings


def _judge(readings: Readings, frame: Frame, state: GateState, slot: int) -> bool:
    """Whether an intact frame that is listened to is accepted, by its counter and its values."""
    can_id, data, counters = frame.can_id, frame.data, state.counters
    if can_id == CoilBoot.ID:  # a board that boots counts anew
        for coil_slot in _COIL_SLOTS:
            counters[coil_slot] = -1
    counter, before = data[0] & 0xF, counters[slot]
    if not _take(readings, can_id, data, repeated=counter == before):
        return False
    if before >= 0:
        state.missed += (counter - before & 0xF) - 1
    counters[slot] = counter
    return True


def _take(readings: Readings, can_id: int, data: bytes, repeated: bool) -> bool:
    """Whether a message is accepted: it is no repetition, and its values are possible.

    It is then kept, in the place of an earlier one of its kind; refusals and telecommands are all kept,
    telecommands that are repeated apart. ``commands`` judges and answers their values.
    """
    if can_id in TELECOMMANDS:
        telecommand = TELECOMMANDS[can_id].decode(data)
        if repeated:
            readings.repeated = (*readings.repeated, telecommand)
        else:
            readings.telecommands = (*readings.telecommands, telecommand)
    elif repeated:
        return False
    elif can_id == MagField.ID:
        readings.field = MagField.decode(data)
    elif can_id == SunVector.ID:
        sun = SunVector.decode(data)
        if sun.valid and not 0.8 < sun.s_x**2 + sun.s_y**2 + sun.s_z**2 < 1.2:
            return False
        readings.sun = sun
    elif can_id == CoilStatus.ID:
        coil = CoilStatus.decode(data)
        if not -3 <= coil.level <= 3 or coil.coil > 2:
            return False
        readings.coil = coil
    elif can_id == RefAttitude.ID:
        attitude = RefAttitude.decode(data)
        if not attitude.q_x**2 + attitude.q_y**2 + attitude.q_z**2 < 1.0001:  # 1, and the wire's rounding
            return False
        readings.ref_attitude = attitude
    else:
        _keep(readings, can_id, data)
    return not repeated


def _keep(readings: Readings, can_id: int, data: bytes) -> None:
    """Keep a message of a board of which any values are possible."""
    if can_id == SunCells.ID:
        readings.cells = SunCells.decode(data)
    elif can_id == CoilDipoleStatus.ID:
        readings.dipole = CoilDipoleStatus.decode(data)
    elif can_id == WheelStatus.ID:
        readings.wheel = WheelStatus.decode(data)
    elif can_id == CoilRefused.ID:
        readings.refused = (*readings.refused, CoilRefused.decode(data))
    elif can_id == RefRate.ID:
        readings.ref_rate = RefRate.decode(data)
    elif can_id == CoilBoot.ID:
        readings.coil_boot = CoilBoot.decode(data)
    elif can_id == PlantEnd.ID:
        readings.end = PlantEnd.decode(data)


def _latest(frames: tuple[Frame, ...]) -> tuple[Frame, ...]:
    """What is read of the frames of several ticks: what the boards say now, and what they say once."""
    before = [frame for frame in frames[:-INBOX_LIMIT] if frame.can_id in _IN_ANY_PLACE]
    return (*before[:INBOX_LIMIT], *frames[-INBOX_LIMIT:])
