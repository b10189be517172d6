"""What a fault campaign found: for the terminal, as JSON, JUnit XML, one HTML page and docs/faults.md."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from itertools import groupby
from math import inf

from sim.console import counted
from sim.drawing.pages import page
from sim.fault_table.checks import checks_of
from sim.fault_table.row import CaseResult, CheckVerdict, FaultRow, RowFault, RowResult
from sim.faults.kinds import KINDS
from sim.junit import JunitCase
from sim.value_types import Json

_COLUMNS = ("row", "injected", "expected", "cases", "measured", "verdict")
_REPEATABLE = ("pulses", "refused", "rejected", "worst error deg", "recovered s", "named s")
"""Figures that are the same on every run; wall-clock times are not."""
_HEAD = """# Faults

Written by `torquer faults --write-docs`; do not edit. That command injects the fault of each row, by a seeded
man in the middle between the nodes, or in boards, plant or process. Every case must keep the limits (pulse at
most 3 s, 100 s of back-off, one coil, three levels: judged from COIL_STATUS and, by other code, from the
current that the plant drove), raise no exception in a step, have no NaN in the flight state, answer every
SYNC, isolate no healthy unit, call no attitude valid that is more than 5 deg wrong for over 120 s (unless
nothing aboard can tell, as the row says; with one sensor left 15 deg), and meet what its row expects. `only
UNIT named`: it may be isolated. `named or doubted`: it is isolated, or both sensors are said to disagree.
`not yet`: nothing could identify the unit in the time of the row. A Sun sensor shows most faults in the light
alone, a lamp in the shadow alone, and there was none; a coil can only be judged by pulses that it fires in
the light while the sensors are not in dispute, and there it has fired fewer than five; one that is stuck on
only by an attitude that was valid before. Every second case
flies a satellite of the population `50kg` (`sim/campaign/population.py`), each another. Figures are the worst
over all cases. Phases that are counted from a pulse need one: a case without it fails. Where a real
process is killed or stopped, its steps and its state are not seen: there it is judged by what is on the bus.
"""


_FILES = """## Faults of files and processes

Faults that need no flight are tests: the plant killed (`tests/integration/test_sil_ended.py`), a full disk
and logs that are cut, altered or of another version (`tests/integration/test_altered_runs.py`), wrong tables
and scenarios (`tests/integration/test_sil_refuses.py`). `torquer faults --slow` adds two rows, which kill and
stop a real process.
"""

_KINDS_HEAD = """# Faults in a scenario

Written by `tools/write_pages.py`; do not edit.

A scenario schedules faults of its own; without `lasts_s` a fault is permanent. The log holds the frames on
the bus of the flight software, so that such a run replays to the last bit. `torquer check` judges the log: a
COIL_STATUS that was corrupted on its way is a violation there, as is a forged SYNC, and the silence of a coil
driver in which a pulse may have gone unreported fails ([runs.md](runs.md#the-audit)). A scheduled fault alone
does not make `torquer sil` fail: with such a scenario it counts neither broken frames nor forged SYNCs, and
no stranger of the fault as a second sender, but limits, replay and completeness must hold.

    [[fault]]
    kind = "mag_bias"
    at_s = 600.0
    lasts_s = 300.0
    parameters = {axis = 1, nt = 10000}

A fault of a sensor that the satellite does not have, or of a cell that is not there, is refused.

`per_s` is the change of `nt`, `scale` or `deg` in each second after the onset: `nt = 0, per_s = 0.2` is a
bias that drifts by 0.2 nT/s. A kind that ends in `_late` delays the samples of one sensor.

| kind | parameters: default (range) | in a scenario |
|---|---|---|"""


def tally(results: Sequence[RowResult]) -> str:
    """How many rows and cases there were, and how many failed."""
    cases = [case for result in results for case in result.cases]
    rows = {verdict: sum(result.verdict is verdict for result in results) for verdict in CheckVerdict}
    broken = sum(not _holds(case, "limits") for case in cases)
    passed, failed = rows[CheckVerdict.PASS], rows[CheckVerdict.FAIL]
    flown = f"{counted(len(results), 'row')}, {counted(len(cases), 'case')}"
    text = f"{flown}: {counted(passed, 'row')} passed, {failed} failed"
    if rows[CheckVerdict.OPEN]:
        text += f", {rows[CheckVerdict.OPEN]} not yet"
    return f"{text}; {counted(broken, 'violation')} of the coil limits"


def line(result: RowResult) -> str:
    """One row for the terminal."""
    return f"{result.verdict.value:<9} {result.row.name:<24} {len(result.cases):>4} cases  {_found(result)}"


def listed(row: FaultRow) -> str:
    """One row for ``--list``."""
    return f"{row.name:<24} {fault_words(row)}; expected: {expected(row)}"


def listed_json(row: FaultRow) -> Json:
    """One row for ``--list --json``."""
    return {"row": row.name, "group": row.group, "injected": injected(row), "expected": expected(row)}


def as_json(results: Sequence[RowResult]) -> str:
    """Everything, for programs: a line for each row, since indentation would nearly double the size."""
    values = json_values(results)
    rows = ",\n".join(json.dumps(row, separators=(",", ":")) for row in values["rows"])
    return f'{{"tally": {json.dumps(values["tally"])},\n"rows": [\n{rows}\n]}}\n'


def json_values(results: Sequence[RowResult]) -> Json:
    """The same as values of JSON."""
    rows = [
        {
            "row": result.row.name,
            "group": result.row.group,
            "injected": injected(result.row),
            "expected": list(checks_of(result.row)),
            "verdict": result.verdict.value,
            "measured": result.measured,
            "cases": [asdict(case) for case in result.cases],
        }
        for result in results
    ]
    return {"tally": tally(results), "rows": rows}


def suites(results: Sequence[RowResult]) -> dict[str, list[JunitCase]]:
    """For JUnit XML, a suite for each row and a test for each case; an open verdict counts as skipped."""
    return {result.row.name: [_test(case) for case in result.cases] for result in results}


def _test(case: CaseResult) -> JunitCase:
    failed, waiting = _with(case, CheckVerdict.FAIL), _with(case, CheckVerdict.OPEN)
    return JunitCase(
        f"faults.{case.row}",
        f"phase {case.phase} seed {case.seed}",
        case.wall_s,
        failure="; ".join(failed),
        skipped="" if failed else "; ".join(waiting),
    )


def html(results: Sequence[RowResult]) -> str:
    """One self-contained page."""
    bad = any(result.verdict is CheckVerdict.FAIL for result in results)
    return page(
        "sim.fault_table",
        "faults.html",
        badge="bad" if bad else "good",
        tally=tally(results),
        head=_COLUMNS,
        groups=[(group, [_html_row(result) for result in rows]) for group, rows in _groups(results)],
    )


def _html_row(result: RowResult) -> tuple[tuple[str, ...], str, str]:
    """The cells of a row without its verdict, then the style class of the verdict, and the verdict."""
    row, colour = result.row, {CheckVerdict.PASS: "good", CheckVerdict.FAIL: "bad", CheckVerdict.OPEN: "note"}
    cells = (row.name, fault_words(row), expected(row), str(len(result.cases)), _found(result))
    return cells, colour[result.verdict], result.verdict.value


def markdown(results: Sequence[RowResult], phases: int, seeds: int) -> str:
    """docs/faults.md."""
    lines = [_HEAD, f"{tally(results)}. Phases {phases}, seeds {seeds} each.", ""]
    for group, rows in _groups(results):
        lines += [f"## {group}", "", f"| {' | '.join(_COLUMNS)} |"]
        lines.append("|---|---|---|---|---|---|")
        for result in rows:
            cells = (
                f"`{result.row.name}`",
                fault_words(result.row),
                expected(result.row),
                str(len(result.cases)),
                _found(result),
                result.verdict.value,
            )
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return "\n".join([*lines, _FILES])


def kinds_page() -> str:
    """docs/scenario-faults.md: the kinds of faults that a scenario can schedule."""
    return "\n".join([_KINDS_HEAD, *map(_kind_row, KINDS), ""])


_THERE = {"": "yes", "sun": "with a Sun sensor", "cells": "with Sun cells"}


def _kind_row(name: str) -> str:
    kind = KINDS[name]
    parameters = ", ".join(
        f"{parameter} = {default:g} ({low:g} to {high:g})"
        for parameter, (default, low, high) in kind.parameters.items()
    )
    there = _THERE[kind.sensor] if kind.in_plant else "no"
    return f"| `{name}` | {parameters} | {there} |"


def injected(row: FaultRow) -> str:
    """What is injected, in words."""
    return "; ".join([*map(_fault, row.faults), *row.settings])


def fault_words(row: FaultRow) -> str:
    """The same for a reader: a fault that only names a unit is left out beside others."""
    acting = [fault for fault in row.faults if fault.kind != "none"] or row.faults[:1]
    return "; ".join([*map(_fault, acting), *row.settings])


def expected(row: FaultRow) -> str:
    """What is expected in addition to what every row must meet."""
    units = " and ".join(fault.unit for fault in row.faults if fault.unit)
    within = "" if row.within_s == inf else f", within {row.within_s:g} s"
    names = [f"{name} ({units}{within})" if "named" in name else name for name in row.expect]
    may = [f"only {units} named"] if units and not any("named" in name for name in row.expect) else []
    return ", ".join([*names, *may, *filter(None, [row.unseen])]) or "the limits"


def _fault(fault: RowFault) -> str:
    defaults = {name: parameter.default for name, parameter in KINDS[fault.kind].parameters.items()}
    parameters = [f"{name} {value:g}" for name, value in (defaults | fault.parameters).items()]
    lasts = "stays" if fault.lasts_s == inf else f"{fault.lasts_s:g} s"
    after = f"after {fault.after_s:g} s " if fault.after_s else ""
    return ", ".join([after + fault.kind.replace("_", " "), *parameters, lasts])


def _found(result: RowResult) -> str:
    for verdict in (CheckVerdict.FAIL, CheckVerdict.OPEN):
        worst = result.first(verdict)
        if worst is not None:
            case, outcome = worst
            count = sum(bool(_with(case, verdict)) for case in result.cases)
            where = f"phase {case.phase} seed {case.seed}" if verdict is CheckVerdict.FAIL else ""
            parts = [f"{count} of {len(result.cases)}: {outcome.check}", outcome.said, where]
            return "; ".join([", ".join(part for part in parts if part), _figures(result)])
    return _figures(result)


def _figures(result: RowResult) -> str:
    """The worst of each figure; of one that not every case has, with how many have it."""
    said = []
    for name in [name for name in result.measured if name in _REPEATABLE]:
        count = sum(name in case.measured for case in result.cases)
        part = f" in {count} of {len(result.cases)}" if count < len(result.cases) else ""
        said.append(f"{name} {result.measured[name]:.4g}{part}")
    return ", ".join(said)


def _with(case: CaseResult, verdict: CheckVerdict) -> list[str]:
    return [
        f"{outcome.check}: {outcome.said}" if outcome.said else outcome.check
        for outcome in case.outcomes
        if outcome.verdict is verdict
    ]


def _holds(case: CaseResult, check: str) -> bool:
    return all(outcome.verdict is CheckVerdict.PASS for outcome in case.outcomes if outcome.check == check)


def _groups(results: Sequence[RowResult]) -> list[tuple[str, list[RowResult]]]:
    return [(group, list(rows)) for group, rows in groupby(results, lambda result: result.row.group)]
