"""The table of the kinds of faults: name, parameters, and the class that injects it."""

from collections.abc import Callable, Mapping
from random import Random
from typing import Literal, NamedTuple

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG
from fsw.wire.messages import MagField, SunCells, SunVector
from sim.faults import bus_kinds as bus
from sim.faults import bus_kinds as forged
from sim.faults import node_kinds as node
from sim.faults import plant_kinds as cell
from sim.faults import plant_kinds as plant
from sim.faults.fault import Fault, Parameters


class Parameter(NamedTuple):
    """Default and range."""

    default: float
    low: float
    high: float


class FaultKind(NamedTuple):
    """A kind of fault.

    ``in_plant``: the plant's process can inject it, so that a scenario may schedule it.
    ``by_signal``: it needs the flight software as a process of its own.
    ``by_clock``: it needs a coil board with a clock of its own.
    ``breaks``: COIL_STATUS may arrive corrupt, though the board keeps its limits.
    ``forges_sync``: a stranger sends SYNC, of other ticks or times than the plant's.
    ``forges``: a stranger sends intact frames under identifiers of the flight software.
    ``sensor``: what it acts on, "sun" or "cells", of which a satellite has one; empty: on anything else.
    """

    make: Callable[[Random, Parameters], Fault]
    parameters: Mapping[str, Parameter] = {}
    in_plant: bool = True
    by_signal: bool = False
    by_clock: bool = False
    breaks: bool = False
    forges_sync: bool = False
    forges: bool = False
    sensor: Literal["", "sun", "cells"] = ""


PART = {"part": Parameter(0.1, 0.0, 1.0)}
ALWAYS = {"part": Parameter(1.0, 0.0, 1.0)}
CELL = {"cell": Parameter(1.0, 1.0, 6.0)}
AXIS = {"axis": Parameter(0.0, 0.0, 2.0)}
PER_S = {"per_s": Parameter(0.0, -1000.0, 1000.0)}
TURN = {**AXIS, "deg": Parameter(10.0, -180.0, 180.0), **PER_S}
LATE = {"ticks": Parameter(30.0, 1.0, 1000.0), "jitter": Parameter(0.0, 0.0, 1.0)}
STRIKES = Parameter(5.0, 1.0, 1000.0)
A_FEW = Parameter(3.0, 1.0, 1000.0)
HELD = {"seconds": Parameter(4.9, 0.0, 1000.0), "rushed": Parameter(0.0, 0.0, 1000.0)}

KINDS: dict[str, FaultKind] = {
    "none": FaultKind(Fault),
    "loss": FaultKind(bus.frame_fault(bus.lose), PART),
    "bursts": FaultKind(bus.Bursts, {"ticks": Parameter(10.0, 1.0, 1000.0)}),
    "duplicates": FaultKind(bus.frame_fault(bus.duplicate), PART),
    "reordering": FaultKind(bus.frame_fault(bus.reorder)),
    "delay": FaultKind(bus.FrameDelay, {"ticks": A_FEW, "jitter": Parameter(0.0, 0.0, 1.0)}),
    "corruption": FaultKind(bus.frame_fault(bus.corrupt), PART, breaks=True),
    "wrong_length": FaultKind(bus.frame_fault(bus.resize), PART, breaks=True),
    "unknown_id": FaultKind(bus.frame_fault(bus.readdress), PART),
    "rtr": FaultKind(bus.flag_fault(REMOTE_FLAG), PART),
    "extended_id": FaultKind(bus.flag_fault(EXTENDED_FLAG), PART),
    "error_frames": FaultKind(bus.flag_fault(ERROR_FLAG), PART),
    "random_frames": FaultKind(
        bus.RandomFrames,
        {"frames": Parameter(100.0, 0.0, 10_000.0), "as_fsw": Parameter(1.0, 0.0, 1.0)},
        breaks=True,
        forges=True,
    ),
    "flood": FaultKind(bus.Flood, {"frames": Parameter(500.0, 0.0, 10_000.0)}),
    "second_sender": FaultKind(bus.ForgedRequests, {"frames": Parameter(1.0, 0.0, 1000.0)}, forges=True),
    "sync_forged": FaultKind(
        forged.ForgedSync,
        {
            **ALWAYS,
            "ticks": Parameter(0.0, -1e9, 1e9),
            "count": Parameter(1.0, 1.0, 10.0),
            "step": Parameter(1.0, 0.0, 1.0),
        },
        forges_sync=True,
    ),
    "end_forged": FaultKind(forged.ForgedEnd),
    "done_forged": FaultKind(forged.ForgedTickDone, ALWAYS, forges=True),
    "link_down": FaultKind(bus.LinkDown, in_plant=False),
    "queue_full": FaultKind(bus.QueueFull),
    "mag_nan": FaultKind(plant.field_fault(plant.set_nan), AXIS),
    "mag_infinite": FaultKind(plant.field_fault(plant.set_infinity), AXIS),
    "mag_saturated": FaultKind(plant.field_fault(plant.clip), {"nt": Parameter(15_000.0, 0.0, 65_000.0)}),
    "mag_frozen": FaultKind(plant.FieldFrozen),
    "mag_bias": FaultKind(
        plant.field_fault(plant.shift, "nt"),
        {**AXIS, "nt": Parameter(10_000.0, -60_000.0, 60_000.0), **PER_S},
    ),
    "mag_scale": FaultKind(
        plant.field_fault(plant.scale, "scale"), {**AXIS, "scale": Parameter(1.5, -10.0, 10.0), **PER_S}
    ),
    "mag_turned": FaultKind(plant.field_fault(plant.turn, "deg"), TURN),
    "mag_swapped": FaultKind(plant.field_fault(plant.swap_axes), AXIS),
    "mag_late": FaultKind(bus.sample_delay(MagField.ID), LATE),
    "sun_nan": FaultKind(plant.sun_fault(plant.set_nan), AXIS, sensor="sun"),
    "sun_frozen": FaultKind(plant.SunFrozen, sensor="sun"),
    "sun_scale": FaultKind(
        plant.sun_fault(plant.scale, "scale"),
        {**AXIS, "scale": Parameter(-1.0, -10.0, 10.0), **PER_S},
        sensor="sun",
    ),
    "sun_turned": FaultKind(plant.sun_fault(plant.turn, "deg"), TURN, sensor="sun"),
    "sun_swapped": FaultKind(plant.sun_fault(plant.swap_axes), AXIS, sensor="sun"),
    "sun_late": FaultKind(bus.sample_delay(SunVector.ID), LATE, sensor="sun"),
    "cells_late": FaultKind(bus.sample_delay(SunCells.ID), LATE, sensor="cells"),
    "sun_unseen": FaultKind(plant.SunBlindness, sensor="sun"),
    "albedo": FaultKind(plant.SunDeflection, {"part": Parameter(0.4, 0.0, 1.0)}, sensor="sun"),
    "cell_dead": FaultKind(cell.CellDead, CELL, sensor="cells"),
    "cell_scaled": FaultKind(cell.CellScaled, {**CELL, "scale": Parameter(0.5, 0.0, 10.0)}, sensor="cells"),
    "cell_stuck": FaultKind(cell.CellStuck, {**CELL, "percent": Parameter(0.0, 0.0, 199.0)}, sensor="cells"),
    "cells_random": FaultKind(cell.CellsRandom, {"percent": Parameter(60.0, 1.0, 199.0)}, sensor="cells"),
    "extreme_codes": FaultKind(plant.ExtremeCodes, {"sun": Parameter(0.0, 0.0, 1.0)}),
    "coil_open": FaultKind(plant.CoilOpen, AXIS),
    "coil_wired": FaultKind(plant.CoilRescaling, {**AXIS, "scale": Parameter(-1.0, -2.0, 2.0)}),
    "coil_stuck_on": FaultKind(plant.CoilStuckOn, {**AXIS, "ampere": Parameter(0.4, -10.0, 10.0)}),
    "coil_board_restarts": FaultKind(plant.board_fault(plant.BoardRestarts, "coil")),
    "coil_board_storm": FaultKind(
        plant.board_fault(plant.BoardStorm, "coil"), {"ticks": Parameter(150.0, 1.0, 1e6)}
    ),
    "coil_board_dead": FaultKind(plant.board_fault(plant.BoardDead, "coil")),
    "mag_board_restarts": FaultKind(plant.board_fault(plant.BoardRestarts, "magnetometer")),
    "mag_board_dead": FaultKind(plant.board_fault(plant.BoardDead, "magnetometer")),
    "sun_board_restarts": FaultKind(plant.board_fault(plant.BoardRestarts, "sun")),
    "sun_board_dead": FaultKind(plant.board_fault(plant.BoardDead, "sun")),
    "killed": FaultKind(node.FswKill, in_plant=False),
    "stopped": FaultKind(node.FswStop, in_plant=False),
    "storm": FaultKind(
        node.FswKillStorm,
        {"up": Parameter(150.0, 1.0, 1e6), "down": Parameter(20.0, 1.0, 1e6)},
        in_plant=False,
    ),
    "all_restart": FaultKind(node.AllRestart, in_plant=False),
    "sync_lost": FaultKind(node.SyncLoss, PART, in_plant=False),
    "sync_repeated": FaultKind(node.SyncRepetition, {"times": A_FEW}, in_plant=False),
    "ticks_held": FaultKind(node.TickHold, HELD, in_plant=False, by_clock=True),
    "ticks_repeated": FaultKind(node.TickRepetition, HELD, in_plant=False, by_clock=True),
    "tick_jumps": FaultKind(
        node.TickJumps,
        {"ticks": Parameter(1000.0, -1e9, 1e9), "with_time": Parameter(1.0, 0.0, 1.0)},
        in_plant=False,
    ),
    "time_jumps": FaultKind(node.TimeJumps, {"seconds": Parameter(3600.0, -1e9, 1e9)}, in_plant=False),
    "bit_flip": FaultKind(node.BitFlip, in_plant=False),
    "sigkill": FaultKind(Fault, {"times": STRIKES}, in_plant=False, by_signal=True),
    "sigstop": FaultKind(Fault, {"times": STRIKES}, in_plant=False, by_signal=True),
}


def make(kind: str, parameters: Parameters, rng: Random) -> Fault:
    """A fault of a kind, with the table's defaults for parameters that are not given."""
    entry = KINDS[kind]
    defaults = {name: parameter.default for name, parameter in entry.parameters.items()}
    return entry.make(rng, {**defaults, **parameters})
