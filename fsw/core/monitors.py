"""Monitors: each a name and a limit of what is true in one tick. A violation trips to SAFE.

A rate beyond its bound is looked at last: named, it is the only violation. It trips ACQUIRE and POINT
alone. DETUMBLE is how it ends, by B-dot, which needs no estimate: SAFE, in which nothing is driven, would
keep it.

The purpose of each is in ``docs/requirements.md``.
"""

from enum import IntEnum
from typing import Final, final

from fsw.core.algebra.vector import Vec3, is_finite
from fsw.core.estimation.attitude import Attitude, rate_bounded
from fsw.wire.messages import Mode
from fsw.wire.value import Value


class Monitor(IntEnum):
    """Numbers of the monitors, as reported on the bus."""

    ATTITUDE_FINITE = 1
    QUATERNION_UNIT = 2
    RATE_BOUNDED = 3
    OWED_FINITE = 4
    FIELD_FRESH = 5
    COIL_STATUS_FRESH = 6
    COIL_AS_COMMANDED = 7
    ORBIT_KNOWN = 8
    NO_SECOND_SENDER = 9
    TIME_AGREES = 10


@final
class MonitorInput(Value):
    """The inputs of the monitors in one tick."""

    FIELDS = (
        "attitude",
        "pending_impulse_body_nms",
        "field_age_ticks",
        "status_age_ticks",
        "time_age_ticks",
        "unexpected_drive",
        "orbit_available",
        "second_sender",
        "stale_after_ticks",
    )
    __slots__ = FIELDS

    def __init__(
        self,
        attitude: Attitude,
        pending_impulse_body_nms: Vec3,
        field_age_ticks: int,
        status_age_ticks: int,
        time_age_ticks: int,
        unexpected_drive: bool,
        orbit_available: bool,
        second_sender: bool,
        stale_after_ticks: int,
    ) -> None:
        self.attitude = attitude
        self.pending_impulse_body_nms = pending_impulse_body_nms
        self.field_age_ticks = field_age_ticks
        self.status_age_ticks = status_age_ticks
        self.time_age_ticks = time_age_ticks
        self.unexpected_drive = unexpected_drive
        self.orbit_available = orbit_available
        self.second_sender = second_sender
        self.stale_after_ticks = stale_after_ticks


UNIT_TOLERANCE: Final = 1e-6
"""How far the square of the quaternion's norm may be off."""


MOST_TIME_ERROR_S: Final = 60
"""By which the time of a SYNC may differ from the table's: in it the satellite flies 4 deg of its orbit."""
TIME_STALE: Final = 2
"""Times as long as a sample may be old, no SYNC may have had the right time: one jump is no other clock."""


def trips(violated: Monitor | None, mode: Mode) -> bool:
    """Whether a violation, the first that is found, leads to SAFE and keeps it."""
    if violated is Monitor.RATE_BOUNDED:
        return mode in (Mode.ACQUIRE, Mode.POINT)
    return violated is not None


def first_violation(watched: MonitorInput) -> Monitor | None:
    """The first monitor that is violated, or None."""
    attitude = watched.attitude
    violated: Monitor | None = None
    q0, q1, q2, q3 = attitude.q_body_from_orbit
    w1, w2, w3 = attitude.omega_body_orbit_radps
    owed1, owed2, owed3 = watched.pending_impulse_body_nms
    if not is_finite(w1 + w2 + w3 + q0 + q1 + q2 + q3):
        violated = Monitor.ATTITUDE_FINITE
    elif not abs(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3 - 1.0) < UNIT_TOLERANCE:
        violated = Monitor.QUATERNION_UNIT
    elif not is_finite(owed1 + owed2 + owed3):
        violated = Monitor.OWED_FINITE
    elif watched.field_age_ticks >= watched.stale_after_ticks:
        violated = Monitor.FIELD_FRESH
    elif watched.status_age_ticks >= watched.stale_after_ticks:
        violated = Monitor.COIL_STATUS_FRESH
    elif watched.unexpected_drive:
        violated = Monitor.COIL_AS_COMMANDED
    elif not watched.orbit_available:
        violated = Monitor.ORBIT_KNOWN
    elif watched.second_sender:
        violated = Monitor.NO_SECOND_SENDER
    elif watched.time_age_ticks >= TIME_STALE * watched.stale_after_ticks:
        violated = Monitor.TIME_AGREES
    elif not rate_bounded(attitude):
        violated = Monitor.RATE_BOUNDED
    return violated
