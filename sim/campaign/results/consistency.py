"""Whether the rows of results.sqlite can be what a campaign wrote: files are edited and damaged."""

import math
import re
import sqlite3
from collections.abc import Mapping, Sequence

from sim.campaign.definition.campaign_file import MOST_RUNS
from sim.campaign.definition.requirements import FigureRequirement
from sim.report.requirements.judge import Outcome
from sim.statistics.indices import INDICES, POINTS

_VERDICT = re.compile(r"requirements_\d+_verdict")
_OUTCOMES = ", ".join(f"'{outcome}'" for outcome in Outcome)
_INDICES = ", ".join(f"'{name}'" for name in INDICES)
_ROWS = {
    "run < 0": "its number is less than 0",
    f"run >= {MOST_RUNS}": f"its number is over {MOST_RUNS - 1}",
    "ifnull(status, '') NOT IN ('done', 'failed')": "it is neither done nor failed",
    "success NOT IN (0, 1)": "it is neither a success nor none",
    "status = 'done' AND ifnull(failure, 'none') <> ''": "it is done, and it failed",
    "status = 'failed' AND ifnull(failure, '') = ''": "it failed, and nothing says why",
    "status = 'failed' AND success": "it failed, and is a success",
    "status = 'done' AND (limits_ok IS NULL OR limits_ok NOT IN (0, 1))": (
        "it is done, and nothing says whether the limits of the coils were kept"
    ),
    "success AND NOT limits_ok": "it is a success that broke the limits of the coils",
    "success AND ifnull(missed, 'none') <> ''": "it is a success that misses a requirement",
    "status = 'done' AND NOT success AND ifnull(missed, '') = ''": "it is no success, and misses nothing",
    f"status = 'done' AND (SELECT count(*) FROM profiles WHERE profiles.run = runs.run "
    f"AND name IN ({_INDICES})) <> {len(INDICES)}": "it is done, and lacks a profile of a pointing index",
}
"""What no row of ``runs`` is, as a condition in SQL, and how that is said."""
_CELLS = {
    "INTEGER": ("whole number", "'integer'"),
    "REAL": ("number", "'real', 'null'"),
    "NUMERIC": ("number", "'integer', 'real', 'null'"),
    "TEXT": ("text", "'text', 'null'"),
}
"""What a column of a type holds: in words, and as SQLite names it."""
_UNKNOWN = ("value of a known type", "''")
_PROFILES = {
    "runs.status IS NOT 'done'": "it has a history and was not flown",
    "typeof(f4) <> 'blob'": "its history is no array",
    f"length(f4) <> {4 * POINTS} AND name IN ({_INDICES})": f"its profile does not have {POINTS} points",
    "length(f4) % 4 <> 0 OR length(f4) = 0": "its history does not hold whole numbers of 4 bytes",
}
"""The same of ``profiles``."""


def find_contradiction(
    connection: sqlite3.Connection, kinds: Mapping[str, str], requirements: Sequence[FigureRequirement] = ()
) -> str:
    """The first run whose row contradicts itself, and how; empty if there is none.

    Args:
        connection: to results.sqlite.
        kinds: the columns of ``runs``, each with its type in SQLite.
        requirements: that a run which is a success meets.
    """
    conditions = {}
    for name, kind in kinds.items():
        words, allowed = _CELLS.get(kind, _UNKNOWN)
        conditions[f"typeof({quoted(name)}) NOT IN ({allowed})"] = f"its {name} is no {words}"
    verdicts = [name for name in kinds if _VERDICT.fullmatch(name)]
    conditions |= {f"{quoted(name)} NOT IN ({_OUTCOMES})": f"its {name} is no verdict" for name in verdicts}
    conditions |= _ROWS | {_missed(entry): f"it is a success, and misses {entry}" for entry in requirements}
    return _first(connection, "runs", conditions) or _first(
        connection, "profiles LEFT JOIN runs USING (run)", _PROFILES
    )


def _missed(entry: FigureRequirement) -> str:
    figure = quoted(entry.figure)
    sides = [f"{figure} < {entry.at_least!r}"] * (entry.at_least > -math.inf)
    sides += [f"{figure} > {entry.at_most!r}"] * (entry.at_most < math.inf)
    return " OR ".join(f"success AND {side}" for side in (f"{figure} IS NULL", *sides))


def _first(connection: sqlite3.Connection, tables: str, conditions: Mapping[str, str]) -> str:
    cases = " ".join(f"WHEN {condition} THEN ?" for condition in conditions)
    query = f"SELECT run, CASE {cases} END AS why FROM {tables} WHERE why IS NOT NULL LIMIT 1"
    found = connection.execute(query, tuple(conditions.values())).fetchone()
    return "" if found is None else f"the row of run {found[0]} contradicts itself: {found[1]}"


def quoted(name: str) -> str:
    """A name as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'
