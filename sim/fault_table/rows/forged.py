"""Rows of the fault table with forged SYNC, PLANT_END and TICK_DONE, and the checks of each."""

from sim.fault_table.row import FaultRow, When

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
