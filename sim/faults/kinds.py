"""The table of kinds of faults: what each is called, what it takes, and who makes it."""

from collections.abc import Callable, Mapping
from random import Random
from typing import NamedTuple

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG
from sim.faults import bus_kinds as bus
from sim.faults import forged_kinds as forged
from sim.faults import node_kinds as node
from sim.faults import plant_kinds as plant
from sim.faults.fault import Fault, Parameters


class Parameter(NamedTuple):
    """Default and range."""

    default: float
    low: float
    high: float


class Kind(NamedTuple):
    """A kind of fault.

    ``in_plant``: the plant's process can inject it by itself, so that a scenario may schedule it.
    ``by_signal``: it needs the flight software as a process of its own.
    ``by_clock``: it needs a coil board with a clock of its own.
    ``breaks``: COIL_STATUS may come broken, though the board keeps its limits.
    ``forges``: a stranger sends whole frames under identifiers of the flight software.
    """

    make: Callable[[Random, Parameters], Fault]
    parameters: Mapping[str, Parameter] = {}
    in_plant: bool = True
    by_signal: bool = False
    by_clock: bool = False
    breaks: bool = False
    forges: bool = False


PART = {"part": Parameter(0.1, 0.0, 1.0)}
ALWAYS = {"part": Parameter(1.0, 0.0, 1.0)}
AXIS = {"axis": Parameter(0.0, 0.0, 2.0)}
STRIKES = Parameter(5.0, 1.0, 1000.0)
A_FEW = Parameter(3.0, 1.0, 1000.0)
HELD = {"seconds": Parameter(4.9, 0.0, 1000.0), "rushed": Parameter(0.0, 0.0, 1000.0)}

KINDS: dict[str, Kind] = {
    "none": Kind(Fault),
    "loss": Kind(bus.on_frames(bus.lost), PART),
    "bursts": Kind(bus.Bursts, {"ticks": Parameter(10.0, 1.0, 1000.0)}),
    "duplicates": Kind(bus.on_frames(bus.duplicated), PART),
    "reordering": Kind(bus.on_frames(bus.reordered)),
    "delay": Kind(bus.Late, {"ticks": A_FEW, "jitter": Parameter(0.0, 0.0, 1.0)}),
    "corruption": Kind(bus.on_frames(bus.corrupted), PART, breaks=True),
    "wrong_length": Kind(bus.on_frames(bus.resized), PART, breaks=True),
    "unknown_id": Kind(bus.on_frames(bus.readdressed), PART),
    "rtr": Kind(bus.on_flag(REMOTE_FLAG), PART),
    "extended_id": Kind(bus.on_flag(EXTENDED_FLAG), PART),
    "error_frames": Kind(bus.on_flag(ERROR_FLAG), PART),
    "random_frames": Kind(
        bus.RandomFrames,
        {"frames": Parameter(100.0, 0.0, 10_000.0), "as_fsw": Parameter(1.0, 0.0, 1.0)},
        breaks=True,
        forges=True,
    ),
    "flood": Kind(bus.Flood, {"frames": Parameter(500.0, 0.0, 10_000.0)}),
    "second_sender": Kind(bus.SecondSender, {"frames": Parameter(1.0, 0.0, 1000.0)}, forges=True),
    "sync_forged": Kind(
        forged.SyncForged,
        {
            **ALWAYS,
            "ticks": Parameter(0.0, -1e9, 1e9),
            "count": Parameter(1.0, 1.0, 10.0),
            "step": Parameter(1.0, 0.0, 1.0),
        },
    ),
    "end_forged": Kind(forged.EndForged),
    "done_forged": Kind(forged.DoneForged, ALWAYS, forges=True),
    "link_down": Kind(bus.LinkDown, in_plant=False),
    "queue_full": Kind(bus.QueueFull),
    "mag_nan": Kind(plant.field_reads(plant.not_a_number), AXIS),
    "mag_infinite": Kind(plant.field_reads(plant.infinite), AXIS),
    "mag_saturated": Kind(plant.field_reads(plant.clipped), {"nt": Parameter(15_000.0, 0.0, 65_000.0)}),
    "mag_frozen": Kind(plant.FieldFrozen),
    "mag_bias": Kind(
        plant.field_reads(plant.shifted), {**AXIS, "nt": Parameter(10_000.0, -60_000.0, 60_000.0)}
    ),
    "mag_scale": Kind(plant.field_reads(plant.scaled), {**AXIS, "scale": Parameter(1.5, -10.0, 10.0)}),
    "mag_swapped": Kind(plant.field_reads(plant.swapped), AXIS),
    "sun_nan": Kind(plant.sun_reads(plant.not_a_number), AXIS),
    "sun_frozen": Kind(plant.SunFrozen),
    "sun_scale": Kind(plant.sun_reads(plant.scaled), {**AXIS, "scale": Parameter(-1.0, -10.0, 10.0)}),
    "sun_swapped": Kind(plant.sun_reads(plant.swapped), AXIS),
    "sun_unseen": Kind(plant.SunUnseen),
    "albedo": Kind(plant.SunTilted, {"part": Parameter(0.4, 0.0, 1.0)}),
    "extreme_codes": Kind(plant.ExtremeCodes, {"sun": Parameter(0.0, 0.0, 1.0)}),
    "coil_open": Kind(plant.CoilOpen, AXIS),
    "coil_wired": Kind(plant.CoilWired, {**AXIS, "scale": Parameter(-1.0, -2.0, 2.0)}),
    "coil_stuck_on": Kind(plant.StuckOn, {**AXIS, "ampere": Parameter(0.4, -10.0, 10.0)}),
    "coil_board_restarts": Kind(plant.board(plant.BoardRestarts, "coil")),
    "coil_board_storm": Kind(plant.board(plant.BoardStorm, "coil"), {"ticks": Parameter(150.0, 1.0, 1e6)}),
    "coil_board_dead": Kind(plant.board(plant.BoardDead, "coil")),
    "mag_board_restarts": Kind(plant.board(plant.BoardRestarts, "magnetometer")),
    "mag_board_dead": Kind(plant.board(plant.BoardDead, "magnetometer")),
    "sun_board_restarts": Kind(plant.board(plant.BoardRestarts, "sun")),
    "sun_board_dead": Kind(plant.board(plant.BoardDead, "sun")),
    "killed": Kind(node.Killed, in_plant=False),
    "stopped": Kind(node.Stopped, in_plant=False),
    "storm": Kind(
        node.Storm, {"up": Parameter(150.0, 1.0, 1e6), "down": Parameter(20.0, 1.0, 1e6)}, in_plant=False
    ),
    "all_restart": Kind(node.AllRestart, in_plant=False),
    "sync_lost": Kind(node.SyncLost, PART, in_plant=False),
    "sync_repeated": Kind(node.SyncRepeated, {"times": A_FEW}, in_plant=False),
    "ticks_held": Kind(node.TicksHeld, HELD, in_plant=False, by_clock=True),
    "ticks_repeated": Kind(node.TicksRepeated, HELD, in_plant=False, by_clock=True),
    "tick_jumps": Kind(
        node.TickJumps,
        {"ticks": Parameter(1000.0, -1e9, 1e9), "with_time": Parameter(1.0, 0.0, 1.0)},
        in_plant=False,
    ),
    "time_jumps": Kind(node.TimeJumps, {"seconds": Parameter(3600.0, -1e9, 1e9)}, in_plant=False),
    "bit_flip": Kind(node.BitFlip, in_plant=False),
    "sigkill": Kind(Fault, {"times": STRIKES}, in_plant=False, by_signal=True),
    "sigstop": Kind(Fault, {"times": STRIKES}, in_plant=False, by_signal=True),
}


def make(kind: str, parameters: Parameters, rng: Random) -> Fault:
    """A fault of a kind; parameters that are not given are the table's."""
    entry = KINDS[kind]
    defaults = {name: parameter.default for name, parameter in entry.parameters.items()}
    return entry.make(rng, {**defaults, **parameters})
