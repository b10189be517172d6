"""Each coil by its current: in a pulse, against that of the level; and any without a request.

The coils share one supply, which shows a current but not the coil in which it flows.
"""

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import ZERO
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig, with_fault, with_item
from fsw.core.fdir.evidence import weigh
from fsw.core.fdir.faults import CoilFault, coil_fault
from fsw.core.gate.measurements import CoilReport, Measurements

WHOLE_MS = 1e-6
"""Rounding of a duration, ms."""


def judge_current(
    health: CoilHealth,
    view: CoilView,
    measurements: Measurements,
    unasked: bool,
    tick: int,
    config: CoilHealthConfig,
) -> CoilHealth:
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
        return health
    if unasked or (status.level == 0 and abs(status.current_ma) > config.stuck_ma):
        return _strange(health, status, unasked, config)
    if health.strange_ticks:
        health = health._replace(strange_ticks=0, stray_ma=0, stuck=False, conducts=ZERO)
    fired = view.fired
    if tick != view.fired_tick + _judged_after(config.pulses):
        return health
    if status.coil != fired.coil or status.level != fired.level:
        return health
    if not status.level or not (status.remaining_ms or config.pulses.pulse_ticks == 1):
        return health
    nominal_ma = config.current_ma[abs(status.level) - 1]
    part = status.current_ma / (nominal_ma if status.level > 0 else -nominal_ma)
    kind, threshold = coil_fault(part, config.weak.weak_part), config.weak.threshold
    nats = weigh(health.nats[fired.coil], 0.5 * threshold if kind else -threshold, threshold)
    health = health._replace(nats=with_item(health.nats, fired.coil, nats))
    return with_fault(health, fired.coil, kind, config) if nats >= threshold else health


def _judged_after(pulses: PulseConfig) -> int:
    """The last tick of a pulse at which the coil is certainly on; -1 if there is none.

    At the tick with which a pulse ends the reading may be of before or after it; and the duration is in whole
    ms, which may end it before the tick does. Of a pulse of one whole tick the board reads its current first.
    """
    if pulses.pulse_ticks > 1:
        return pulses.pulse_ticks - 1
    return 1 if pulses.duration_ms >= 1000.0 * pulses.tick_s - WHOLE_MS else -1


def _strange(health: CoilHealth, status: CoilReport, unasked: bool, config: CoilHealthConfig) -> CoilHealth:
    """Something flows without a request; a level that lasts for ``stuck_ticks`` isolates its coil.

    Of a pulse longer than a tick one report proves nothing: it may be one that was delayed.
    """
    ticks = health.strange_ticks + 1
    lasts = ticks >= config.stuck_ticks
    stray_ma = 0 if status.level else status.current_ma
    stuck = lasts or (unasked and ticks >= min(2, config.pulses.pulse_ticks))
    health = health._replace(strange_ticks=ticks, stray_ma=stray_ma, stuck=stuck)
    return with_fault(health, status.coil, CoilFault.STUCK, config) if unasked and lasts else health
