"""Monitors: each a name, a limit and a predicate over one tick. A violation trips to SAFE.

A rate beyond its bound is the last of the list: named, it is the only violation. It trips ACQUIRE and POINT
alone. DETUMBLE is how it ends, by B-dot, which needs no estimate: SAFE, in which nothing is driven, would
keep it.

The purpose of each is in ``docs/requirements.md``.
"""

from collections.abc import Callable
from enum import IntEnum
from math import isfinite
from typing import final

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import Vec3
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


@final
class MonitorInput(Value):
    """The inputs of the monitors in one tick."""

    FIELDS = (
        "attitude",
        "owed_impulse_body_nms",
        "field_age_ticks",
        "status_age_ticks",
        "unexpected_drive",
        "orbit_known",
        "second_sender",
        "stale_after_ticks",
    )
    __slots__ = FIELDS

    def __init__(
        self,
        attitude: Attitude,
        owed_impulse_body_nms: Vec3,
        field_age_ticks: int,
        status_age_ticks: int,
        unexpected_drive: bool,
        orbit_known: bool,
        second_sender: bool,
        stale_after_ticks: int,
    ) -> None:
        self.attitude = attitude
        self.owed_impulse_body_nms = owed_impulse_body_nms
        self.field_age_ticks = field_age_ticks
        self.status_age_ticks = status_age_ticks
        self.unexpected_drive = unexpected_drive
        self.orbit_known = orbit_known
        self.second_sender = second_sender
        self.stale_after_ticks = stale_after_ticks


UNIT_TOLERANCE = 1e-6
"""How far the square of the quaternion's norm may be off."""


def _square(q: Quaternion) -> float:
    q0, q1, q2, q3 = q
    return q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3


MONITORS: tuple[tuple[Monitor, Callable[[MonitorInput], bool]], ...] = (
    (
        Monitor.ATTITUDE_FINITE,
        lambda w: isfinite(sum(w.attitude.q_body_from_orbit, sum(w.attitude.omega_body_orbit_radps, 0.0))),
    ),
    (
        Monitor.QUATERNION_UNIT,
        lambda w: abs(_square(w.attitude.q_body_from_orbit) - 1.0) < UNIT_TOLERANCE,
    ),
    (Monitor.OWED_FINITE, lambda w: isfinite(sum(w.owed_impulse_body_nms, 0.0))),
    (Monitor.FIELD_FRESH, lambda w: w.field_age_ticks < w.stale_after_ticks),
    (Monitor.COIL_STATUS_FRESH, lambda w: w.status_age_ticks < w.stale_after_ticks),
    (Monitor.COIL_AS_COMMANDED, lambda w: not w.unexpected_drive),
    (Monitor.ORBIT_KNOWN, lambda w: w.orbit_known),
    (Monitor.NO_SECOND_SENDER, lambda w: not w.second_sender),
    (Monitor.RATE_BOUNDED, lambda w: rate_bounded(w.attitude)),
)


def trips(violated: Monitor | None, mode: Mode) -> bool:
    """Whether a violation, the first of the list, leads to SAFE and keeps it."""
    if violated is Monitor.RATE_BOUNDED:
        return mode in (Mode.ACQUIRE, Mode.POINT)
    return violated is not None


def first_violation(watched: MonitorInput) -> Monitor | None:
    """The first monitor that is violated, in the order of the list, or None."""
    for monitor, holds in MONITORS:
        if not holds(watched):
            return monitor
    return None
