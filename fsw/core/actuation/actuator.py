"""From the demand of a law to a request to the coil driver, and the view of the driver's reports."""

from dataclasses import dataclass, field
from math import ceil
from typing import Final, final

from fsw.core.actuation import dipoles, pulses
from fsw.core.actuation.dipoles import DipoleConfig, RequestedDipole
from fsw.core.actuation.pulses import PulseConfig, PulseState
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, row, scale
from fsw.core.gate.measurements import CoilReport, Measurements, Refusal
from fsw.core.laws.interface import Demand
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE, Pulse
from fsw.wire.messages import CoilDipole, CoilFire, CoilRefusedReason

LOCKOUT_UNKNOWN = (-1, -1, -1)
LATE_TICKS: Final = 2
"""So late a report of a pulse may come after its end."""
OF_ANY_FRAME = (CoilRefusedReason.MALFORMED, CoilRefusedReason.REPEATED_SEQ)
"""Refusals of a broken or repeated frame, which may stand beside the very request that is driven."""
MOST_IDLE_TICKS: Final = 10_000
"""The count of idle ticks stops here: longer than any sample is late."""


@final
@dataclass(slots=True)
class CoilView:
    """The last reports of the coil driver, and the last request to it.

    ``lockout_ms`` by coil, -1 where the board has not reported it yet; ``driven_coil`` and ``driven_level``
    over the tick that just ended, ``driven_am2`` the mean dipole over it, body axes; ``fired_tick`` is -1
    before the first request; ``paid_body_nms`` is the impulse of the last request; ``idle_ticks``: reports
    in a row of no level and no current. ``past_am2``: the nominal dipoles driven over the last ticks, the
    newest first, where the coils' own field is known. ``requested``: the last request to a continuous driver.
    """

    lockout_ms: tuple[int, int, int] = LOCKOUT_UNKNOWN
    driven_coil: int = 0
    driven_level: int = 0
    driven_am2: Vec3 = ZERO
    seq: int = 0
    refusals: int = 0
    fired_tick: int = -1
    fired: Pulse = NO_PULSE
    paid_body_nms: Vec3 = ZERO
    idle_ticks: int = 0
    past_am2: tuple[Vec3, ...] = ()
    requested: RequestedDipole = field(default_factory=RequestedDipole)

    @property
    def as_fired(self) -> bool:
        """Whether what is driven is the last pulse that was requested."""
        return self.driven_coil == self.fired.coil and self.driven_level == self.fired.level


@dataclass(frozen=True, slots=True)
class ActuatorConfig:
    """The limits of the pulses, and the continuous driver that is there instead, if any."""

    pulses: PulseConfig
    dipoles: DipoleConfig | None


def update_view(view: CoilView, measurements: Measurements, tick: int, config: ActuatorConfig) -> None:
    """Take the reports of the coil driver in this tick.

    A board that has just booted has not reported its lockouts. Without a status, the last request counts as
    driven while it is under way.
    """
    if measurements.coil_booted:
        view.lockout_ms = LOCKOUT_UNKNOWN
    view.refusals += len(measurements.refused)
    status = measurements.coil
    if status is not None:
        a, b, c = view.lockout_ms
        view.lockout_ms = (
            status.lockout_ms if status.coil == 0 else a,
            status.lockout_ms if status.coil == 1 else b,
            status.lockout_ms if status.coil == 2 else c,
        )
        view.driven_coil, view.driven_level, view.seq = status.coil, status.level, status.seq
    else:
        view.driven_coil = view.fired.coil
        view.driven_level = requested_level(view, tick, config.pulses)
    idle = status is not None and status.level == 0 and status.current_ma == 0
    view.idle_ticks = min(view.idle_ticks + 1, MOST_IDLE_TICKS) if idle else 0
    if config.dipoles is None:
        level_am2 = pulses.dipole_am2(view.driven_level, config.pulses.levels_am2)
        view.driven_am2 = scale(level_am2, row(config.pulses.coil_axes, view.driven_coil))
        return
    view.requested.reported = measurements.dipole is not None
    if measurements.dipole is not None:
        view.driven_am2 = dipoles.dipole_am2(measurements.dipole, config.dipoles)
    else:
        view.driven_am2 = view.requested.over(tick)


def requested_level(view: CoilView, tick: int, config: PulseConfig) -> int:
    """The level that the last request drives over the tick that just ended; 0 if it is not under way."""
    under_way = view.fired_tick < tick <= view.fired_tick + config.pulse_ticks
    return view.fired.level if under_way else 0


def wait_ticks(
    state: PulseState,
    view: CoilView,
    measurements: Measurements,
    tick: int,
    config: PulseConfig,
    faults: tuple[int, int, int],
) -> tuple[int, int, int]:
    """By coil, ticks until its own timer and the board let it fire, as far as known; ``NEVER`` with a fault.

    A board that has not reported a coil since its boot is taken to hold it for a full back-off.
    """
    own = pulses.wait_ticks(state, tick, faults)
    if 0 not in own:
        return own
    soonest = 0 if measurements.coil is not None else 1
    (a, b, c), (of_a, of_b, of_c) = own, view.lockout_ms
    return (
        _longer_wait(a, soonest, of_a, config),
        _longer_wait(b, soonest, of_b, config),
        _longer_wait(c, soonest, of_c, config),
    )


def _longer_wait(own: int, soonest: int, lockout_ms: int, config: PulseConfig) -> int:
    """Of the coil's own timer and the lockout that the board has reported."""
    if own == NEVER:
        return own
    lockout_ticks = config.backoff_ticks if lockout_ms < 0 else ceil(lockout_ms / (1000.0 * config.tick_s))
    return max(own, soonest, lockout_ticks)


def unexpected(view: CoilView, tick: int, config: PulseConfig) -> bool:
    """Whether the board drove something that was not requested; a report of a pulse may come late."""
    if view.driven_level == 0:
        return False
    under_way = view.fired_tick < tick <= view.fired_tick + config.pulse_ticks + LATE_TICKS
    return not under_way or not view.as_fired


def actuate(
    state: PulseState,
    view: CoilView,
    demand: Demand | None,
    b_body_t: Vec3,
    measurements: Measurements,
    tick: int,
    config: ActuatorConfig,
    faults: tuple[int, int, int] = (0, 0, 0),
) -> CoilFire | CoilDipole | None:
    """Turn the demand of the law into at most one request.

    Args:
        state: of the scheduler, updated.
        view: after ``update_view``; the request is remembered there.
        demand: of the law; None: nothing is owed and nothing is sent.
        b_body_t: field, body axes, T.
        measurements: of this tick; without a status of the coil driver nothing is sent.
        tick: tick that is answered.
        config: the coils.
        faults: by coil; one with a fault is not fired.
    """
    if demand is None:
        state.pending_impulse_body_nms = state.held_am2 = ZERO
        return None
    if config.dipoles is not None:
        request = dipoles.request(state, demand, b_body_t, tick, config.dipoles, config.pulses)
        if measurements.dipole is None:
            return None
        dipoles.remember(view.requested, request, tick, config.dipoles)
        return request
    if any([_refuses(refused, view, measurements.coil, tick) for refused in measurements.refused]):
        state.pending_impulse_body_nms = add(state.pending_impulse_body_nms, view.paid_body_nms)
        view.fired, view.paid_body_nms = NO_PULSE, ZERO
    return _pulse(state, view, demand, b_body_t, measurements.coil is not None, tick, config.pulses, faults)


def _refuses(refused: Refusal, view: CoilView, status: CoilReport | None, tick: int) -> bool:
    """Whether this is the refusal of the request of the tick before, or of the one before that.

    Not if the board reports that it is driven: then another frame of that tick was refused.
    """
    if tick > view.fired_tick + 2 or refused.tick != view.fired_tick & 0xFF:
        return False
    fired = view.fired
    if status is not None and status.level and status.coil == fired.coil and status.level == fired.level:
        return False
    if refused.reason in OF_ANY_FRAME:
        return status is not None
    return refused.coil == fired.coil and refused.seq != view.seq


def _pulse(
    state: PulseState,
    view: CoilView,
    demand: Demand,
    b_body_t: Vec3,
    status_fresh: bool,
    tick: int,
    config: PulseConfig,
    faults: tuple[int, int, int],
) -> CoilFire | None:
    """At most one pulse, and only when the coil's own timer and the board's last report of it agree."""
    owing = demand.impulse_body_nms is None and demand.pulse is None
    if owing:
        pulses.owe(state, cross(demand.m_body_am2, b_body_t), b_body_t, config)
    else:
        state.pending_impulse_body_nms = ZERO
    pulse = _chosen(state, demand, b_body_t, tick, config, faults)
    if pulse is None or not status_fresh or view.lockout_ms[pulse.coil] != 0:
        return None
    view.fired_tick, view.fired = tick, pulse
    view.paid_body_nms = pulses.impulse(pulse, b_body_t, config) if owing else ZERO
    pulses.fire(state, pulse, view.paid_body_nms, tick, config)
    return CoilFire(pulse.level, pulse.coil, (view.seq + 1) & 0xFF, tick, config.duration_ms)


def _chosen(
    state: PulseState,
    demand: Demand,
    b_body_t: Vec3,
    tick: int,
    config: PulseConfig,
    faults: tuple[int, int, int],
) -> Pulse | None:
    """The pulse a law asks for, if that coil's own timer has run out; if it asks for none, the best one."""
    if demand.pulse is not None:
        may_fire = demand.pulse.level != 0 and pulses.wait_ticks(state, tick, faults)[demand.pulse.coil] == 0
        return demand.pulse if may_fire else None
    if demand.impulse_body_nms is not None:
        wanted, metric = demand.impulse_body_nms, config.energy_metric
    else:
        torque_body_nm = cross(demand.m_body_am2, b_body_t)
        wanted, metric = pulses.due(state, torque_body_nm, b_body_t, config), config.rate_metric
    return pulses.choose(state, wanted, metric, tick, b_body_t, config, faults)
