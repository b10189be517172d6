"""Rows of the satellite with Sun cells: a faulty cell, more light from the Earth, a faulty message."""

from math import inf

from sim.fault_table.row import FaultRow, RowFault, Unseen, When

CUBESAT = "cubesat-cells"
CELLS = "a Sun cell: dead, stuck, of half the current; more light from the Earth"
MESSAGE = "the message of the Sun cells: late, lost, corrupted, with extreme or random values"
ORBIT_S = 5740.0
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
        watch_s=1.5 * ORBIT_S,
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
        watch_s=ORBIT_S,
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
