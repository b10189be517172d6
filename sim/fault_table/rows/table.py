"""The fault table: for every row the injected fault and the checks."""

from collections.abc import Sequence
from functools import partial
from math import inf

from fsw.input.near import did_you_mean
from sim.errors import HarnessError
from sim.fault_table.row import FaultRow, RowFault, Unseen, When
from sim.fault_table.rows.hidden import SLY_ROWS

# --- Rows of the fault table with forged SYNC, PLANT_END and TICK_DONE, and the checks of each

GROUP = "SYNC, PLANT_END and TICK_DONE forged"
STEADY = ("no extra pulse", "goes on", "hears", "recovers")


def _sync(name: str, *expect: str, when: When = When.PULSE, **parameters: float) -> FaultRow:
    """A row with forged SYNCs before the true one."""
    lasts_s = 1.0 if when is When.BOOT else 300.0
    expect = ("boots locked", *expect, *STEADY)
    return FaultRow(f"sync-forged-{name}", GROUP, "sync_forged", parameters, lasts_s, when, expect)


FORGED_ROWS: tuple[FaultRow, ...] = (
    _sync("any", "undisturbed", "told"),
    _sync("going-on", "undisturbed", "told", ticks=1e6),
    _sync("behind", "undisturbed", "told", ticks=-500.0),
    _sync("skip", "told", ticks=50.0, part=0.03),
    _sync("skips", "told", ticks=50.0),
    _sync("pair", "told", count=2.0, part=0.03),
    _sync("pairs", "told", count=2.0),
    _sync("pairs-back", "told", count=2.0, ticks=-100.0, part=0.05),
    _sync("pairs-equal", "told", count=2.0, step=0.0, part=0.05),
    _sync("rush", "told", count=10.0, part=0.2),
    _sync("first", when=When.BOOT, ticks=1e9),
    _sync("first-pair", when=When.BOOT, ticks=1e9, count=2.0),
    FaultRow("end-forged", GROUP, "end_forged", {}, 300.0, expect=("undisturbed", "told", *STEADY)),
    FaultRow(
        "done-forged-seldom",
        GROUP,
        "done_forged",
        {"part": 0.02},
        300.0,
        expect=STEADY,
        unit="second sender",
    ),
    FaultRow(
        "done-forged",
        GROUP,
        "done_forged",
        {},
        300.0,
        expect=("no request", "goes on", "hears", "named", "recovers"),
        unit="second sender",
        watch_s=480.0,
    ),
)


# --- Rows of the satellite with Sun cells: a faulty cell, more light from the Earth, a faulty message

CUBESAT = "cubesat-cells"
CELLS = "a Sun cell: dead, stuck, of half the current; more light from the Earth"
MESSAGE = "the message of the Sun cells: late, lost, corrupted, with extreme or random values"
CUBESAT_ORBIT_S = 5740.0
"""Period of the scenario's orbit."""
BRIGHT = ("sensors.cells.albedo=0.45", "sensors.cells.albedo_spread=0.4", "flight.cells.albedo=0.3")
"""1.5 times as much light from the Earth as the table assumes."""


def _cell(name: str, kind: str, cell: int, **parameters: float) -> FaultRow:
    """A fault of one cell that begins after a whole orbit, and stays."""
    return FaultRow(
        name,
        CELLS,
        kind,
        {"cell": float(cell), **parameters},
        inf,
        When.ORBIT,
        ("goes on", "bounded", "named"),
        f"cell {cell}",
        watch_s=1.5 * CUBESAT_ORBIT_S,
        unseen=Unseen.SETTLING,
        scenario=CUBESAT,
    )


def _table(name: str, settings: tuple[str, ...], *expect: str) -> FaultRow:
    """No fault: cells and table differ."""
    return FaultRow(
        name,
        CELLS,
        "none",
        {},
        1.0,
        When.ORBIT,
        expect,
        settings=settings,
        watch_s=CUBESAT_ORBIT_S,
        unseen=Unseen.SETTLING,
        scenario=CUBESAT,
    )


def _message(name: str, kind: str, *expect: str, **parameters: float) -> FaultRow:
    """A fault of ten minutes, after a whole orbit; control continues after it.

    The cells of a message that is wrong may be named one by one.
    """
    return FaultRow(
        name,
        MESSAGE,
        kind,
        parameters,
        600.0,
        When.ORBIT,
        ("goes on", "recovers", *expect),
        "sun sensor",
        then=tuple(RowFault("none", {}, 600.0, f"cell {cell}", shows=False) for cell in range(1, 7)),
        watch_s=1200.0,
        unseen=Unseen.SETTLING,
        scenario=CUBESAT,
    )


CELL_ROWS: tuple[FaultRow, ...] = (
    _table("cells-none", (), "goes on", "quiet"),
    _cell("cell-dead", "cell_dead", 1),
    _cell("cell-stuck", "cell_stuck", 4),
    _cell("cell-stuck-bright", "cell_stuck", 5, percent=90.0),
    _cell("cell-halved", "cell_scaled", 3, scale=0.5),
    _table("cells-albedo", BRIGHT, "goes on", "quiet"),
    _message("cells-late", "cells_late", "quiet", ticks=5.0),
    _message("cells-lost", "loss", part=0.5),
    _message("cells-board-dead", "sun_board_dead"),
    _message("cells-corrupted", "corruption", "dropped", part=0.3),
    _message("cells-extreme-codes", "extreme_codes", sun=1.0),
    _message("cells-random", "cells_random", percent=60.0),
)
"""All of them, in the order of the page."""


# --- The table

Rows = tuple[FaultRow, ...]
BUS = ("no extra pulse", "goes on")
TIMED = ("limits by time", *BUS, "quiet", "recovers")
BROKEN = (*BUS, "dropped", "recovers")
PASSING = ("goes on", "recovers")
UNNAMED = ("goes on", "bounded", "quiet")

NOTHING = "nothing: false alarms"
LOSS = "loss 1/10/50 %, bursts; duplicates; reordering; delay, jitter"
CORRUPT = "corrupt payload, wrong length, unknown id, RTR, extended id, error frames"
FLOOD = "flood by a babbling node"
SECOND = "a second sender on fsw's id"
INTERFACE = "interface down and up; ENOBUFS"
PROCESS = "fsw killed, stopped, restarted at every phase of a pulse; reboot storms"
BOARD = "board killed and restarted; both reset"
CLOCK = "clock jumps, tick going backwards, SYNC lost, held, repeated or forged; ticks in a rush"
SENSOR = "a sensor: NaN and infinity, saturation, frozen, bias, scale, swapped axis, wrong sign"
BOOT = "a sensor that is wrong from the first tick on"
LIGHT = "eclipse; Sun parallel to the field; Sun sensor blinded by albedo or without Sun"
COIL = "coil open, reversed, weak, stuck on"
UPSET = "bit flip in any double of the flight state"

NOON_ORBIT = (
    "orbit.altitude_km=800.0",
    "orbit.inclination_deg=98.7",
    "orbit.raan_deg=6.0",
    "orbit.u0_deg=20.0",
    'time.epoch_utc="2015-03-27T02:46:57Z"',
)
"""A noon orbit: from 200 to 430 s after its start the Sun is within 20 deg of the field's direction."""


def _field(name: str, kind: str, **parameters: float) -> tuple[FaultRow, FaultRow]:
    """A temporary and a permanent fault of the magnetometer."""
    return _sensor("magnetometer", name, kind, parameters)


def _sun(name: str, kind: str, **parameters: float) -> tuple[FaultRow, FaultRow]:
    return _sensor("sun sensor", name, kind, parameters)


def _sensor(unit: str, name: str, kind: str, parameters: dict[str, float]) -> tuple[FaultRow, FaultRow]:
    """The filter may follow a fault that shows late, such as a scale, until either sensor may be wrong."""
    row = partial(FaultRow, group=SENSOR, kind=kind, parameters=parameters, when=When.SUNLIT, unit=unit)
    named = ("goes on", "bounded", "named or doubted")
    return (
        row(f"{name}-passing", lasts_s=300.0, expect=PASSING, unseen=Unseen.ALONE),
        row(name, lasts_s=inf, expect=named, unseen=Unseen.ALONE, watch_s=1500.0),
    )


def _from_boot(name: str, kind: str, unit: str, **parameters: float) -> Rows:
    """Which sensor is faulty from boot on is not always observable."""
    return (
        FaultRow(f"{name}-boot-passing", BOOT, kind, parameters, 300.0, When.BOOT, PASSING, unit),
        FaultRow(f"{name}-boot", BOOT, kind, parameters, inf, When.BOOT, ("bounded",), unit, watch_s=1500.0),
    )


def _coils(name: str, kind: str, *expect: str, watch_s: float = 2e3, **parameters: float) -> Rows:
    """The same fault of each coil."""
    return tuple(
        FaultRow(
            f"{name}-{coil}",
            COIL,
            kind,
            {"axis": coil, **parameters},
            inf,
            expect=expect,
            unit=f"coil {coil}",
            watch_s=watch_s,
        )
        for coil in range(3)
    )


ROWS: Rows = (
    FaultRow("none", NOTHING, "none", {}, 1.0, expect=(*BUS, "quiet", "recovers"), watch_s=1500.0),
    FaultRow("loss-1", LOSS, "loss", {"part": 0.01}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("loss-10", LOSS, "loss", {"part": 0.1}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("loss-50", LOSS, "loss", {"part": 0.5}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("bursts", LOSS, "bursts", {"ticks": 30.0}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("duplicates", LOSS, "duplicates", {"part": 0.5}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("reordering", LOSS, "reordering", {}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("delay", LOSS, "delay", {"ticks": 2.0}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("jitter", LOSS, "delay", {"ticks": 3.0, "jitter": 1.0}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("corruption", CORRUPT, "corruption", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow("wrong-length", CORRUPT, "wrong_length", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow("unknown-id", CORRUPT, "unknown_id", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow("rtr", CORRUPT, "rtr", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow("extended-id", CORRUPT, "extended_id", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow("error-frames", CORRUPT, "error_frames", {"part": 0.3}, 300.0, expect=BROKEN),
    FaultRow(
        "random-frames",
        CORRUPT,
        "random_frames",
        {"frames": 100.0},
        200.0,
        expect=BROKEN,
        unit="second sender",
    ),
    FaultRow("flood", FLOOD, "flood", {"frames": 500.0}, 200.0, expect=(*BUS, "recovers")),
    FaultRow(
        "second-sender",
        SECOND,
        "second_sender",
        {"frames": 1.0},
        300.0,
        expect=("no request", "goes on", "named", "recovers"),
        unit="second sender",
        watch_s=480.0,
    ),
    FaultRow("link-down", INTERFACE, "link_down", {}, 90.0, expect=(*BUS, "recovers")),
    FaultRow("link-down-mid-pulse", INTERFACE, "link_down", {}, 2.0, expect=(*BUS, "recovers")),
    FaultRow("queue-full", INTERFACE, "queue_full", {}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("fsw-killed", PROCESS, "killed", {}, 1.0, expect=(*BUS, "boots locked", "recovers")),
    FaultRow("fsw-killed-long", PROCESS, "killed", {}, 40.0, expect=(*BUS, "boots locked", "recovers")),
    FaultRow("fsw-stopped", PROCESS, "stopped", {}, 4.0, expect=(*BUS, "recovers")),
    FaultRow("fsw-stopped-long", PROCESS, "stopped", {}, 256.0, expect=(*BUS, "recovers")),
    FaultRow(
        "fsw-storm",
        PROCESS,
        "storm",
        {"up": 150.0, "down": 20.0},
        900.0,
        expect=(*BUS, "boots locked", "recovers"),
    ),
    FaultRow(
        "fsw-storm-fast",
        PROCESS,
        "storm",
        {"up": 3.0, "down": 3.0},
        120.0,
        expect=(*BUS, "boots locked", "recovers"),
    ),
    FaultRow(
        "process-killed",
        PROCESS,
        "sigkill",
        {"times": 5.0},
        expect=("no extra pulse", "boots locked"),
        slow=True,
    ),
    FaultRow("process-stopped", PROCESS, "sigstop", {"times": 5.0}, expect=("no extra pulse",), slow=True),
    FaultRow("coil-board-restarts", BOARD, "coil_board_restarts", {}, 1.0, expect=(*BUS, "recovers")),
    FaultRow(
        "coil-board-storm", BOARD, "coil_board_storm", {"ticks": 150.0}, 900.0, expect=(*BUS, "recovers")
    ),
    FaultRow(
        "coil-board-storm-fast", BOARD, "coil_board_storm", {"ticks": 4.0}, 200.0, expect=(*BUS, "recovers")
    ),
    FaultRow(
        "coil-board-dead",
        BOARD,
        "coil_board_dead",
        {},
        90.0,
        expect=(*BUS, "recovers", "silence named"),
        unit="coil board",
    ),
    FaultRow("mag-board-restarts", BOARD, "mag_board_restarts", {}, 1.0, expect=(*BUS, "recovers")),
    FaultRow(
        "mag-board-dead",
        BOARD,
        "mag_board_dead",
        {},
        90.0,
        expect=(*BUS, "recovers", "silence named"),
        unit="magnetometer",
    ),
    FaultRow("sun-board-restarts", BOARD, "sun_board_restarts", {}, 1.0, expect=(*BUS, "recovers")),
    FaultRow(
        "sun-board-dead", BOARD, "sun_board_dead", {}, 90.0, expect=(*BUS, "recovers"), unit="sun sensor"
    ),
    FaultRow("all-restart", BOARD, "all_restart", {}, 5.0, expect=(*BUS, "boots locked", "recovers")),
    FaultRow("sync-lost", CLOCK, "sync_lost", {"part": 0.3}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("sync-repeated", CLOCK, "sync_repeated", {"times": 3.0}, 300.0, expect=(*BUS, "recovers")),
    FaultRow("ticks-held", CLOCK, "ticks_held", {}, 300.0, expect=TIMED),
    FaultRow("ticks-held-then-rushed", CLOCK, "ticks_held", {"rushed": 110.0}, 600.0, expect=TIMED),
    FaultRow("ticks-rushed", CLOCK, "ticks_held", {"seconds": 0.0}, 300.0, expect=TIMED),
    FaultRow("ticks-repeated", CLOCK, "ticks_repeated", {"seconds": 7.0}, 300.0, expect=TIMED),
    FaultRow(
        "ticks-repeated-then-rushed",
        CLOCK,
        "ticks_repeated",
        {"seconds": 7.0, "rushed": 110.0},
        600.0,
        expect=TIMED,
    ),
    FaultRow("tick-ahead", CLOCK, "tick_jumps", {"ticks": 1000.0}, 1.0, expect=(*BUS, "recovers")),
    FaultRow("tick-far-ahead", CLOCK, "tick_jumps", {"ticks": 1e9}, 1.0, expect=(*BUS, "recovers")),
    FaultRow("tick-ahead-lasting", CLOCK, "tick_jumps", {"ticks": 1000.0}, 20.0, expect=(*BUS, "recovers")),
    FaultRow("tick-back", CLOCK, "tick_jumps", {"ticks": -100.0}, 20.0, expect=(*BUS, "recovers")),
    FaultRow("time-jumps", CLOCK, "time_jumps", {"seconds": 3600.0}, 60.0, expect=(*BUS, "recovers")),
    FaultRow(
        "time-off",
        CLOCK,
        "time_jumps",
        {"seconds": 600.0},
        600.0,
        expect=("no extra pulse", "named", "recovers"),
        unit="clock",
        within_s=130.0,
    ),
    *FORGED_ROWS,
    *_field("mag-nan", "mag_nan"),
    *_field("mag-infinite", "mag_infinite", axis=1.0),
    *_field("mag-saturated", "mag_saturated", nt=15_000.0),
    *_field("mag-frozen", "mag_frozen"),
    *_field("mag-bias", "mag_bias", axis=1.0, nt=10_000.0),
    *_field("mag-scale", "mag_scale", axis=2.0, scale=1.5),
    *_field("mag-swapped", "mag_swapped", axis=1.0),
    *_field("mag-sign", "mag_scale", axis=2.0, scale=-1.0),
    *_field("mag-extreme-codes", "extreme_codes"),
    FaultRow("sun-nan-passing", SENSOR, "sun_nan", {}, 300.0, When.SUNLIT, PASSING),
    FaultRow("sun-nan", SENSOR, "sun_nan", {}, inf, When.SUNLIT, UNNAMED, "sun sensor", watch_s=900.0),
    *_sun("sun-extreme-codes", "extreme_codes", sun=1.0),
    *_sun("sun-frozen", "sun_frozen"),
    *_sun("sun-swapped", "sun_swapped"),
    *_sun("sun-sign", "sun_scale", axis=0.0, scale=-1.0),
    *_from_boot("mag-bias", "mag_bias", "magnetometer", axis=1.0, nt=10_000.0),
    *_from_boot("mag-swapped", "mag_swapped", "magnetometer", axis=1.0),
    *_from_boot("sun-swapped", "sun_swapped", "sun sensor"),
    *_from_boot("sun-sign", "sun_scale", "sun sensor", axis=0.0, scale=-1.0),
    FaultRow(
        "eclipse", LIGHT, "none", {}, 1.0, When.ECLIPSE, ("goes on", "quiet", "recovers"), watch_s=2400.0
    ),
    FaultRow(
        "sun-parallel",
        LIGHT,
        "killed",
        {},
        1.0,
        When.SUNLIT,
        ("boots locked", "recovers"),
        settings=NOON_ORBIT,
    ),
    FaultRow("sun-unseen", LIGHT, "sun_unseen", {}, 1200.0, When.SUNLIT, ("goes on", "quiet", "recovers")),
    FaultRow("albedo", LIGHT, "albedo", {"part": 0.4}, 600.0, When.SUNLIT, PASSING, "sun sensor"),
    FaultRow("albedo-eclipse", LIGHT, "albedo", {"part": 0.4}, 600.0, When.ECLIPSE, PASSING, "sun sensor"),
    FaultRow(
        "lamp-in-eclipse-passing", LIGHT, "albedo", {"part": 0.0}, 600.0, When.ECLIPSE, PASSING, "sun sensor"
    ),
    FaultRow(
        "lamp-in-eclipse",
        LIGHT,
        "albedo",
        {"part": 0.0},
        inf,
        When.ECLIPSE,
        ("goes on", "bounded", "named"),
        "sun sensor",
        watch_s=900.0,
    ),
    *_coils("coil-open", "coil_open", "named", "board names", watch_s=6000.0),
    *_coils("coil-reversed", "coil_wired", "named", watch_s=6000.0, scale=-1.0),
    *_coils("coil-weak", "coil_wired", "named", watch_s=12000.0, scale=0.1),
    # With a third of its effect: what it lacks may be within the bounds of gain, dipole and torque together.
    *_coils("coil-within-bounds", "coil_wired", "bounded", watch_s=12000.0, scale=0.3),
    *_coils("coil-stuck-on", "coil_stuck_on", "named", "bounded", "stuck", "board names", ampere=0.4),
    FaultRow(
        "coil-stuck-on-in-eclipse",
        COIL,
        "coil_stuck_on",
        {"axis": 2.0, "ampere": -0.4},
        inf,
        When.ECLIPSE,
        ("bounded", "stuck", "board names"),
        "coil 2",
    ),
    *SLY_ROWS,
    *CELL_ROWS,
    FaultRow("bit-flip", UPSET, "bit_flip", {}, 1.0, expect=(*BUS, "recovers")),
)
"""All rows, in the order of the page."""


def choose_rows(names: Sequence[str], slow: bool = False) -> list[FaultRow]:
    """The rows with these names, or whose names begin with them; without names all, slow ones on request.

    Raises:
        HarnessError: there is no such row.
    """
    for name in names:
        if not any(_matches(row, name) for row in ROWS):
            hint = did_you_mean(name, (row.name for row in ROWS))
            raise HarnessError(
                f"--only {name}: there is no such row{hint}; `torquer faults --list` names them"
            )
    if not names:
        return [row for row in ROWS if slow or not row.slow]
    return [row for row in ROWS if any(_matches(row, name) for name in names)]


def _matches(row: FaultRow, name: str) -> bool:
    return row.name == name or row.name.startswith(name + "-")
