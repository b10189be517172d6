"""A reaction wheel seen from the controller: which reports of its speed count, and what is requested of it.

A report counts if it is valid, within the wheel's range, and no further from the last one than motor and
friction can have driven the wheel since. Any other is refused and counted, and the last one stands until it
is too old; then the wheel is not driven, and the next report within range counts again.

The filter gets the measured momentum, and the torque on the body from its change: so lag, friction and a
refused request need no model there. Where a report is missing, the change comes with the next.
"""

from dataclasses import dataclass
from math import sqrt
from typing import Final, final

from fsw.core.algebra.vector import is_finite, scale
from fsw.core.estimation.mekf_config import WheelMotion
from fsw.core.gate.measurements import Measurements
from fsw.core.laws.interface import Demand, Wheel
from fsw.wire.messages import WheelTorque

MARGIN: Final = 1.25
"""A report may exceed range and reach by this factor."""
CHANGE_SIGMA: Final = 0.005
"""Standard deviation of a measured momentum change, as a fraction of it: that of the wheel's inertia."""
BODY_RADPS: Final = 0.2
"""The speed relative to the body also changes with the body's rate: by at most this between two reports."""
SMOOTH_RADPS: Final = 1.0
"""Below about this speed the Coulomb friction is smoothed towards zero."""
UNIT_NM: Final = 2.0**-24
"""One unit of the torque on the wire; at most the limit less this is requested."""
MOST_REFUSED: Final = 1_000_000


@final
@dataclass(slots=True)
class WheelView:
    """The last report that was accepted, at ``tick`` (-1: none counts), and the number refused.

    ``change_nms``: change of momentum from the last report to this tick's, zero without a report;
    ``requested_nm``: the motor torque of the last request, zero without one in the last tick.
    """

    speed_radps: float = 0.0
    tick: int = -1
    change_nms: float = 0.0
    requested_nm: float = 0.0
    refused: int = 0
    has_speed: bool = False
    """Whether there has been a report since boot."""


def update_view(view: WheelView, measurements: Measurements, tick: int, wheel: Wheel) -> None:
    """Take the report of this tick, if it counts."""
    if view.tick >= 0 and tick - view.tick > wheel.stale_ticks:
        view.tick = -1
    view.change_nms = 0.0
    status = measurements.wheel
    if status is None:
        return
    if not status.valid or not _possible(status.speed_radps, view, tick, wheel):
        view.refused = min(view.refused + 1, MOST_REFUSED)
        return
    if view.has_speed:
        view.change_nms = wheel.inertia_kgm2 * (status.speed_radps - view.speed_radps)
    view.speed_radps, view.tick, view.has_speed = status.speed_radps, tick, True


def _possible(speed_radps: float, view: WheelView, tick: int, wheel: Wheel) -> bool:
    """Whether the wheel can have this speed: within its range, and within reach since the last report."""
    most_radps = wheel.max_momentum_nms / wheel.inertia_kgm2
    if not abs(speed_radps) <= MARGIN * most_radps:
        return False
    if view.tick < 0:
        return True
    torque_nm = wheel.max_torque_nm + wheel.viscous_nms * most_radps + wheel.coulomb_nm
    reach_radps = MARGIN * torque_nm * (tick - view.tick) * wheel.tick_s / wheel.inertia_kgm2 + BODY_RADPS
    return abs(speed_radps - view.speed_radps) <= reach_radps


def momentum_nms(view: WheelView | None, wheel: Wheel | None) -> float | None:
    """Its momentum relative to the body, along its axis; None: there is none, or it is not known."""
    if view is None or wheel is None or view.tick < 0:
        return None
    return wheel.inertia_kgm2 * view.speed_radps


def wheel_motion(view: WheelView | None, tick: int, ticks: int, wheel: Wheel | None) -> WheelMotion | None:
    """How the wheel moves over the ticks that end now, for the filter; None: there is none.

    Args:
        view: of this tick.
        tick: this one.
        ticks: how many since the last step.
        wheel: None: there is none.
    """
    if view is None or wheel is None:
        return None
    middle_nms = wheel.inertia_kgm2 * view.speed_radps - 0.5 * view.change_nms
    rate_nm = view.change_nms / (max(ticks, 1) * wheel.tick_s)
    reported = view.tick == tick
    doubted_nms = CHANGE_SIGMA * abs(view.change_nms) if reported else abs(view.requested_nm) * wheel.tick_s
    axis = wheel.axis_body
    return WheelMotion(scale(middle_nms, axis), scale(-rate_nm, axis), scale(doubted_nms, axis))


def request(view: WheelView, demand: Demand | None, tick: int, wheel: Wheel) -> WheelTorque | None:
    """The request of this tick, friction added, within the limits; none where nothing is demanded.

    Args:
        view: of this tick.
        demand: of the law.
        tick: that is answered.
        wheel: as the table has it.
    """
    wanted_nm = None if demand is None else demand.wheel_torque_nm
    view.requested_nm = 0.0
    if wanted_nm is None or view.tick < 0 or not is_finite(wanted_nm):
        return None
    torque_nm = wanted_nm + friction_nm(view.speed_radps, wheel)
    limit_nm = wheel.max_torque_nm - UNIT_NM
    torque_nm = min(max(torque_nm, -limit_nm), limit_nm)
    full = abs(view.speed_radps) * wheel.inertia_kgm2 >= wheel.max_momentum_nms
    if full and torque_nm * view.speed_radps > 0.0:
        torque_nm = 0.0
    view.requested_nm = torque_nm
    return WheelTorque(torque_nm, tick)


def friction_nm(speed_radps: float, wheel: Wheel) -> float:
    """The torque that keeps the wheel at its speed, as the table knows it."""
    smooth = speed_radps / sqrt(speed_radps * speed_radps + SMOOTH_RADPS * SMOOTH_RADPS)
    return wheel.viscous_nms * speed_radps + wheel.coulomb_nm * smooth
