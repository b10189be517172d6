"""What the flight software has to notice, each with its limit, who watches it and what it says then.

The one list of requirements on fault detection. ``docs/requirements.md`` is written from it, every id is
cited by a test, and every number that an event can name stands in it.
"""

from enum import IntEnum
from typing import NamedTuple

from fsw.core.monitors import RATE_LIMIT_RADPS, UNIT_TOLERANCE, Monitor
from fsw.core.telemetry import Event


class Requirement(NamedTuple):
    """A requirement; ``watch`` is the number that the event's argument names, ``limit`` says from when on."""

    id: str
    text: str
    limit: str
    watch: IntEnum | None
    event: Event


def _trip(number: int, watch: Monitor, text: str, limit: str) -> Requirement:
    return Requirement(f"REQ-TRIP-{number:02}", text, limit, watch, Event.MONITOR_TRIPPED)


REQUIREMENTS: tuple[Requirement, ...] = (
    _trip(1, Monitor.ATTITUDE_FINITE, "Attitude and rate that control works with are numbers.", "finite"),
    _trip(
        2,
        Monitor.QUATERNION_UNIT,
        "The quaternion of the attitude has unit norm.",
        f"square of the norm within {UNIT_TOLERANCE:g} of 1",
    ),
    _trip(
        3,
        Monitor.RATE_BOUNDED,
        "The rate is one that the satellite can have.",
        f"below {RATE_LIMIT_RADPS:g} rad/s about each axis",
    ),
    _trip(4, Monitor.OWED_FINITE, "The impulse that is still owed is a number.", "finite"),
    _trip(5, Monitor.FIELD_FRESH, "The magnetometer speaks.", "an intact MAG_FIELD in `modes.stale_after_s`"),
    _trip(
        6,
        Monitor.COIL_STATUS_FRESH,
        "The coil driver speaks.",
        "an intact COIL_STATUS in `modes.stale_after_s`",
    ),
    _trip(
        7,
        Monitor.COIL_AS_COMMANDED,
        "The coil driver drives what was asked for and nothing else.",
        "coil and level of the own request, for the time of a pulse",
    ),
    _trip(8, Monitor.ORBIT_KNOWN, "The orbit has a position at this tick.", "the ephemeris has one"),
)


def document() -> str:
    """The text of ``docs/requirements.md``."""
    rows = "\n".join(
        f"| {r.id} | {r.text} | {r.limit} | {_watch(r)} | `{r.event.name}` |" for r in REQUIREMENTS
    )
    return f"{_HEAD}\n{rows}\n"


def _watch(requirement: Requirement) -> str:
    watch = requirement.watch
    return "" if watch is None else f"`{watch.name}` ({watch.value})"


_HEAD = """# Requirements on fault detection

Written from `fsw/core/requirements.py` by `python tools/write_requirements.py`; a test fails when it is stale
or when no test cites one of its requirements. The number after what watches is the one that the event's
argument names. A violated `REQ-TRIP` requirement leads to SAFE in the same tick.

| id | requirement | limit | watched by | event |
|---|---|---|---|---|"""
