"""Requirements on fault detection: each with its limit, what monitors it and the event that reports it.

``docs/requirements.md`` is written from this list, every id is cited by a test, and every number that an
event can have as its argument is in it.
"""

from enum import IntEnum
from typing import NamedTuple

from fsw.core.estimation.attitude import RATE_LIMIT_RADPS
from fsw.core.events import Event
from fsw.core.fdir.evidence import PAIR_NUMBERS, SIGMAS
from fsw.core.fdir.faults import CoilFault, SensorFault
from fsw.core.fdir.sensors.plausibility import SHADOW_M
from fsw.core.gate.second_sender import SIGNS
from fsw.core.gate.sync_watch import LEAP_S
from fsw.core.monitors import MOST_TIME_ERROR_S, TIME_STALE, UNIT_TOLERANCE, Monitor
from fsw.core.orbit.earth import RADIUS_M
from sim.fault_table.wrong_estimates import ALONE_DEG, WRONG_DEG, WRONG_S


class Requirement(NamedTuple):
    """A requirement; ``watch`` is the number in the event's argument, ``limit`` the threshold.

    ``event``: None where no event reports it.
    """

    id: str
    text: str
    limit: str
    watch: IntEnum | None
    event: Event | None


def _trip(number: int, watch: Monitor, text: str, limit: str) -> Requirement:
    return Requirement(f"REQ-TRIP-{number:02}", text, limit, watch, Event.MONITOR_TRIPPED)


def _sensor(number: int, watch: SensorFault, text: str, limit: str) -> Requirement:
    return Requirement(f"REQ-SENSOR-{number:02}", text, limit, watch, Event.SENSOR_ISOLATED)


def _coil(number: int, watch: CoilFault, text: str) -> Requirement:
    limit = "`fdir.weak_coil_part`; evidence of two pulses for `fdir.false_alarm_days`"
    return Requirement(f"REQ-COIL-{number:02}", text, limit, watch, Event.COIL_FAULT)


ISOLATES = "evidence for `fdir.false_alarm_days`"

REQUIREMENTS: tuple[Requirement, ...] = (
    Requirement(
        "REQ-FDIR-01",
        "No healthy unit is isolated, whatever else fails, and however the satellite differs from its table.",
        "none",
        None,
        None,
    ),
    Requirement(
        "REQ-FDIR-02",
        "No attitude is called valid that is wrong for long, unless both sensors agree on what is wrong.",
        f"{WRONG_DEG:g} deg for {WRONG_S:g} s on end; {ALONE_DEG:g} deg where only one sensor is "
        "left, and in the orbit after an estimate has begun from Sun cells",
        None,
        None,
    ),
    _trip(1, Monitor.ATTITUDE_FINITE, "Attitude and rate that control uses are numbers.", "finite"),
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
    _trip(5, Monitor.FIELD_FRESH, "The magnetometer sends.", "an intact MAG_FIELD in `modes.stale_after_s`"),
    _trip(
        6,
        Monitor.COIL_STATUS_FRESH,
        "The coil driver sends.",
        "an intact COIL_STATUS in `modes.stale_after_s`",
    ),
    _trip(
        7,
        Monitor.COIL_AS_COMMANDED,
        "The coil driver drives what was requested and nothing else.",
        "coil and level of the own request, for the time of a pulse",
    ),
    _trip(8, Monitor.ORBIT_KNOWN, "The orbit has a position at this tick.", "the ephemeris has one"),
    _trip(
        9,
        Monitor.NO_SECOND_SENDER,
        "No other node sends in the place of the flight software; while one does, no pulse is requested.",
        "until `fdir.second_sender_s` after the last sign",
    ),
    _trip(
        10,
        Monitor.TIME_AGREES,
        "The time on the bus is that of the onboard table, by which field, Sun and orbit are computed.",
        f"a SYNC within {MOST_TIME_ERROR_S} s of it in {TIME_STALE} times `modes.stale_after_s`",
    ),
    _sensor(
        1,
        SensorFault.SATURATED,
        "A magnetometer that marks its samples as not valid while no coil drives is isolated, unless an axis "
        "is at the end of its range in a field that may be beyond it.",
        ISOLATES,
    ),
    _sensor(
        2,
        SensorFault.STRENGTH,
        "A sensor is isolated if its field has the wrong strength or its Sun vector the wrong length.",
        f"by more than `[uncertainty]` and noise allow; {ISOLATES}",
    ),
    _sensor(
        3,
        SensorFault.FROZEN,
        "A sensor whose sample stands still while the other's moves or is missing is isolated.",
        "for longer than `uncertainty.latency_s`, and a quantised one until what it measures has moved by "
        f"more than its step hides; {ISOLATES}",
    ),
    _sensor(
        4,
        SensorFault.REFUSED,
        "A sensor that the filter refuses while it accepts the other, or has no other, is isolated if the "
        "filter has accepted both before.",
        f"a filter that is proven; {ISOLATES}",
    ),
    _sensor(
        5,
        SensorFault.SILENT,
        "A sensor without acceptable samples is isolated.",
        f"in twice the time; {ISOLATES}",
    ),
    Requirement(
        "REQ-SENSOR-06",
        "An isolated sensor is readmitted once it is consistent with the estimate, or, where that cannot "
        "tell, with the other sensor, in which case the filter restarts.",
        f"{ISOLATES}, of a sample that fits; of a pair that agrees, {PAIR_NUMBERS} times as long",
        None,
        Event.SENSOR_READMITTED,
    ),
    Requirement(
        "REQ-SENSOR-07",
        "A contradiction between the sensors that does not show which is wrong isolates nothing: it is "
        "reported, the filter ends, and does not begin before they have agreed for longer; until it is "
        "proven no attitude is valid. Likewise innovations that are too large, and impossible parameters; a "
        "proven filter is eased before, once.",
        f"{ISOLATES}; parameters: {SIGMAS:g} standard deviations of their priors",
        None,
        Event.SENSORS_DISAGREE,
    ),
    Requirement(
        "REQ-SENSOR-08",
        "Noise, eclipse, a driven coil, field and Sun nearly parallel, or a tumble isolate no sensor.",
        "`fdir.false_alarm_days`",
        None,
        Event.SENSOR_ISOLATED,
    ),
    _sensor(
        9,
        SensorFault.UNLIT,
        "A Sun vector in the Earth's shadow is not used, and a sensor that continues so is isolated.",
        f"{(RADIUS_M - SHADOW_M) / 1000.0:g} km inside the shadow's edge; {ISOLATES}",
    ),
    _coil(1, CoilFault.OPEN, "A coil without current, or whose pulses have no effect, is isolated."),
    _coil(2, CoilFault.WEAK, "A coil of too small a current or effect is isolated."),
    _coil(3, CoilFault.REVERSED, "A coil whose current or effect is reversed is isolated."),
    Requirement(
        "REQ-COIL-04",
        "A level or current that was not requested leads to SAFE; if it persists its coil is isolated, by "
        "the report of the driver or, in sunlight, by the torque.",
        "level: at once, of pulses longer than a tick in the second tick; "
        "more than half of the least level's current, and isolation: 1 s beyond a pulse",
        CoilFault.STUCK,
        Event.COIL_FAULT,
    ),
    Requirement(
        "REQ-COIL-05",
        "An isolated coil is not fired until it is tried again or the ground sends TC_CLEAR; sound coils are "
        "not isolated.",
        "no pulse",
        None,
        Event.COIL_FAULT,
    ),
    Requirement(
        "REQ-COIL-06",
        "An isolated coil, but for one that conducts by itself, is tried again once the estimate can tell; "
        "one bad pulse isolates it anew.",
        "`fdir.coil_retest_s`",
        None,
        Event.COIL_READMITTED,
    ),
    Requirement(
        "REQ-BUS-01",
        "Another node that sends under an identifier of the flight software, or whose requests the coil "
        "driver refuses, is identified by it.",
        f"{SIGNS} ticks with a whole frame or a refusal, `fdir.second_sender_s` apart at most, or 10 s where "
        "no pulse was requested",
        None,
        Event.SECOND_SENDER,
    ),
    Requirement(
        "REQ-BUS-02",
        "Own requests refused, late or repeated, broken frames, and restarts are no second sender.",
        "fewer signs",
        None,
        Event.SECOND_SENDER,
    ),
    Requirement(
        "REQ-BUS-03",
        "A SYNC of neither the tick that was answered nor one near ahead has no effect but an event.",
        f"up to {LEAP_S} s ahead",
        None,
        Event.STRANGE_SYNC,
    ),
    Requirement(
        "REQ-BUS-04",
        "Two of them, the second with the tick of the first or the next one, mean that the plant has "
        "restarted: the estimate is lost, all timers start in full, and SYNC is answered again.",
        "two in a row: no settled count advances by a tick between them",
        None,
        Event.PLANT_RESTARTED,
    ),
    Requirement(
        "REQ-BUS-05",
        "A PLANT_END that does not fit the ticks that were answered has no effect but an event.",
        f"the ticks answered; up to {LEAP_S} s more where silence follows",
        None,
        Event.FALSE_END,
    ),
    Requirement(
        "REQ-EVENT-01",
        "No event floods the bus: events of one kind keep a least distance; those held back are counted.",
        "`fdir.event_spacing_s`",
        None,
        Event.TIME_MISMATCH,
    ),
)


def document() -> str:
    """The text of ``docs/requirements.md``."""
    rows = "\n".join(f"| {r.id} | {r.text} | {r.limit} | {_watch(r)} | {_event(r)} |" for r in REQUIREMENTS)
    return f"{_HEAD}\n{rows}\n"


def _event(requirement: Requirement) -> str:
    event = requirement.event
    return "" if event is None else f"`{event.name}`"


def _watch(requirement: Requirement) -> str:
    watch = requirement.watch
    return "" if watch is None else f"`{watch.name}` ({watch.value})"


_HEAD = """# Requirements on fault detection

Written from `sim/fault_table/requirements.py` by `python tools/write_pages.py`; a test fails when it
is stale or when no test cites one of its requirements. The number in parentheses is the argument of the
event. A violated `REQ-TRIP` requirement leads to SAFE in the same tick; `REQ-TRIP-03` alone does from ACQUIRE
and POINT, and is otherwise left to DETUMBLE. For a sensor the argument is 100 times its number
(1: magnetometer, 2: Sun sensor) plus the number of the fault; for a coil likewise, by its axis. An isolated
unit is left out of estimation and control.

| id | requirement | limit | monitored by | event |
|---|---|---|---|---|"""
