"""validation.json: the figures of the claims as last measured, for what is written from them."""

import json
from collections.abc import Sequence
from pathlib import Path

from fsw.input.regular_file import read_regular
from fsw.input.toml_text import BoundsError
from sim.campaign.claim import ClaimOutcome, ClaimVerdict
from sim.errors import HarnessError
from sim.validate.page import figure_text

MOST_BYTES = 4_000_000
Outcomes = dict[str, dict[str, str]]
"""By the id of the claim: its figure with its unit, its limits, its verdict."""


def as_outcomes(outcomes: Sequence[ClaimOutcome]) -> Outcomes:
    """What the file holds; a claim without its data is left out."""
    return {
        outcome.claim.id: {
            "figure": figure_text(outcome),
            "limits": outcome.claim.limits,
            "verdict": outcome.verdict.value,
        }
        for outcome in outcomes
        if outcome.verdict is not ClaimVerdict.ABSENT
    }


def with_outcomes(before: Outcomes, now: Outcomes) -> Outcomes:
    """Those before, and those of now in their place, sorted."""
    return dict(sorted({**before, **now}.items()))


def as_text(outcomes: Outcomes) -> str:
    """The file: a claim a line."""
    rows = [f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in outcomes.items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def read_outcomes(path: Path) -> Outcomes:
    """The outcomes of a file; none if there is no file.

    Raises:
        HarnessError: it cannot be read, or holds something else.
    """
    if not path.exists():
        return {}
    try:
        found = json.loads(read_regular(path, MOST_BYTES).decode("utf-8"))
    except (OSError, BoundsError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise HarnessError(f"{path}: no outcomes of torquer validate: {error}") from None
    if not isinstance(found, dict) or not all(map(_is_row, found.values())):
        raise HarnessError(f"{path}: no outcomes of torquer validate: by claim figure, limits and verdict")
    return found


def _is_row(row: object) -> bool:
    keys = {"figure", "limits", "verdict"}
    return isinstance(row, dict) and row.keys() == keys and all(isinstance(v, str) for v in row.values())
