"""Rows that an earlier run has flown, from its faults.json: a long campaign may be flown in parts."""

import json
from pathlib import Path
from typing import Any

from sim.harness.errors import HarnessError
from sim.harness.faults.render import injected
from sim.harness.faults.row import CaseResult, Outcome, RowResult, Verdict
from sim.harness.faults.rows import ROWS


def read(path: Path) -> dict[str, RowResult]:
    """The rows of a faults.json by name, those that the table no longer has left out.

    Raises:
        HarnessError: it is none, or a row was flown with another fault than the table has now.
    """
    by_name = {row.name: row for row in ROWS}
    try:
        flown = {one["row"]: one for one in json.loads(path.read_text(encoding="utf-8"))["rows"]}
        cases = {name: tuple(map(_case, one["cases"])) for name, one in flown.items() if name in by_name}
        other = [name for name in cases if flown[name]["injected"] != injected(by_name[name])]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise HarnessError(f"--keep {path}: not the faults.json of a campaign ({error!r})") from None
    if other:
        raise HarnessError(f"--keep {path}: row {other[0]} was flown with another fault than it has now")
    return {name: RowResult(by_name[name], own, kept=True) for name, own in cases.items()}


def _case(told: dict[str, Any]) -> CaseResult:
    outcomes = tuple(Outcome(one["check"], Verdict(one["verdict"]), one["said"]) for one in told["outcomes"])
    return CaseResult(
        told["row"], told["phase"], told["seed"], outcomes, dict(told["measured"]), told["wall_s"]
    )
