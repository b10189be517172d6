"""Each coil by its current: in a pulse, against that of the level; and any without a request.

The coils share one supply, which shows a current but not the coil in which it flows.
"""

from typing import Final

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import ZERO, dot
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig, isolate_coil, with_item
from fsw.core.fdir.evidence import weigh
from fsw.core.fdir.faults import CoilFault, coil_fault
from fsw.core.gate.measurements import CoilReport, Measurements

WHOLE_MS: Final = 1e-6
"""Rounding of a duration, ms."""


def judge_current(
    health: CoilHealth,
    view: CoilView,
    measurements: Measurements,
    unasked: bool,
    tick: int,
    config: CoilHealthConfig,
) -> None:
    """Compare what the coil driver reports with what was requested of it.

    A current reading is beyond doubt, but may be of another moment: it takes two to isolate a coil.

    Args:
        health: of the tick before.
        view: after what was received in this tick.
        measurements: what was received.
        unasked: whether the driver reports a level that was not requested.
        tick: this one.
        config: limits.
    """
    status = measurements.coil
    if status is None:
        return
    stray_ma = _beyond_requested(status, view, tick, config) if status.level == 0 else 0
    if unasked or abs(stray_ma) > config.stuck_ma:
        _judge_unrequested(health, status.coil, stray_ma, unasked, config)
        return
    if health.unrequested_ticks:
        health.unrequested_ticks, health.stray_ma, health.stuck, health.stray_parts = 0, 0, False, ZERO
    fired = view.fired
    if tick != view.fired_tick + _judged_after(config.pulses):
        return
    if status.coil != fired.coil or status.level != fired.level:
        return
    if not status.level or not (status.remaining_ms or config.pulses.pulse_ticks == 1):
        return
    nominal_ma = config.current_ma[abs(status.level) - 1]
    part = status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma)
    kind, threshold = coil_fault(part, config.weak.weak_part), config.weak.threshold
    nats = weigh(health.nats[fired.coil], 0.5 * threshold if kind else -threshold, threshold)
    health.nats = with_item(health.nats, fired.coil, nats)
    if nats >= threshold:
        isolate_coil(health, fired.coil, kind, config)


def _judged_after(pulses: PulseConfig) -> int:
    """The last tick of a pulse at which the coil is certainly on; -1 if there is none.

    At the tick with which a pulse ends the reading may be of before or after it; and the duration is in whole
    ms, which may end it before the tick does. Of a pulse of one whole tick the board reads its current first.
    """
    if pulses.pulse_ticks > 1:
        return pulses.pulse_ticks - 1
    return 1 if pulses.duration_ms >= 1000.0 * pulses.tick_s - WHOLE_MS else -1


def _beyond_requested(status: CoilReport, view: CoilView, tick: int, config: CoilHealthConfig) -> int:
    """What of a current without a level no request explains, mA.

    The coils of a continuous driver may be on until the tick: between no current and all that was requested,
    any may flow.
    """
    left_ma = round(dot(config.left_ma_per_am2, view.requested.over(tick)))
    explained_ma = max(min(0, left_ma), min(status.current_ma, max(0, left_ma)))
    return status.current_ma - explained_ma


def _judge_unrequested(
    health: CoilHealth, coil: int, stray_ma: int, unasked: bool, config: CoilHealthConfig
) -> None:
    """Judge what flows without a request; a level that lasts for ``stuck_ticks`` isolates its coil.

    Of a pulse longer than a tick one report proves nothing: it may be one that was delayed.
    """
    health.unrequested_ticks = ticks = health.unrequested_ticks + 1
    health.stray_ma = stray_ma
    lasts = ticks >= config.stuck_ticks
    health.stuck = lasts or (unasked and ticks >= min(2, config.pulses.pulse_ticks))
    if unasked and lasts:
        isolate_coil(health, coil, CoilFault.STUCK, config)
