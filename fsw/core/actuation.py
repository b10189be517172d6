"""The scheduler joined to what the coil driver says: a pulse goes out only when both clocks agree."""

from dataclasses import dataclass, replace

from fsw.core import pulses
from fsw.core.pulses import AXES, Pulse, PulseConfig, PulseState
from fsw.core.readings import Readings
from fsw.core.vector import ZERO, Vec3, cross, scale
from fsw.wire.messages import CoilFire, Mode

NO_PULSE = Pulse(0, 0)


@dataclass(frozen=True, slots=True)
class CoilView:
    """What the coil driver last said, and what was last asked of it.

    ``lockout_ms`` by coil, -1 where the board has not told yet; ``driven_level`` over the tick that just
    ended; ``fired_tick`` is -1 before the first request.
    """

    lockout_ms: tuple[int, int, int] = (-1, -1, -1)
    driven_coil: int = 0
    driven_level: int = 0
    seq: int = 0
    refusals: int = 0
    fired_tick: int = -1
    fired: Pulse = NO_PULSE


def hear(view: CoilView, readings: Readings) -> CoilView:
    """The view after this tick's COIL_STATUS and COIL_REFUSED; without a status nothing counts as driven."""
    refusals = view.refusals + (readings.refused is not None)
    status = readings.coil
    if status is None:
        return replace(view, driven_level=0, refusals=refusals)
    lockout = list(view.lockout_ms)
    lockout[status.coil] = status.lockout_ms
    return CoilView(
        lockout_ms=(lockout[0], lockout[1], lockout[2]),
        driven_coil=status.coil,
        driven_level=status.level,
        seq=status.seq,
        refusals=refusals,
        fired_tick=view.fired_tick,
        fired=view.fired,
    )


def driven_dipole(view: CoilView, config: PulseConfig) -> Vec3:
    """The dipole driven over the tick that just ended, body axes, A m^2."""
    return scale(pulses.dipole_am2(view.driven_level, config.levels_am2), AXES[view.driven_coil])


def unexpected(view: CoilView, tick: int, config: PulseConfig) -> bool:
    """Whether the board drove something that was not asked for."""
    if view.driven_level == 0:
        return False
    asked = view.fired_tick >= 0 and view.fired_tick < tick <= view.fired_tick + config.pulse_ticks
    return not asked or (view.driven_coil, view.driven_level) != view.fired


def actuate(
    state: PulseState,
    view: CoilView,
    mode: Mode,
    m_body_am2: Vec3,
    b_body_t: Vec3,
    status_fresh: bool,
    tick: int,
    config: PulseConfig,
) -> tuple[PulseState, CoilView, CoilFire | None]:
    """Turn the dipole the law asks for into at most one pulse.

    The best pulse is chosen among the coils whose own timer has run out, and goes out only if the board's
    last word on that coil is a lockout of zero; else it waits.

    Returns:
        Scheduler state, view, and the request to send or None. In SAFE nothing is owed and nothing fires.
    """
    if mode is Mode.SAFE:
        return replace(state, owed_impulse_body_nms=ZERO), view, None
    state = pulses.owe(state, cross(m_body_am2, b_body_t), b_body_t, config)
    pulse = pulses.choose(state, tick, b_body_t, config)
    if pulse is None or not status_fresh or view.lockout_ms[pulse.coil] != 0:
        return state, view, None
    seq = (view.seq + 1) & 0xFF
    request = CoilFire(pulse.level, pulse.coil, seq, tick, config.duration_ms)
    view = replace(view, fired_tick=tick, fired=pulse)
    return pulses.fire(state, pulse, tick, b_body_t, config), view, request
