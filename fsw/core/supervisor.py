"""Monitors and mode table joined: is all well, and which mode follows."""

from typing import NamedTuple

from fsw.core import modes
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import Attitude
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor, Watched, first_violation
from fsw.core.state import FlightState


class Verdict(NamedTuple):
    """The mode of this tick, and the monitor that was violated, if any."""

    modes: ModeState
    violated: Monitor | None


def supervise(state: FlightState, attitude: Attitude, tick: int, config: FlightConfig) -> Verdict:
    """Judge this tick. ``state`` already holds what was heard in it, and the modes of the tick before."""
    watched = Watched(
        attitude=attitude,
        owed_impulse_body_nms=state.pulses.owed_impulse_body_nms,
        field_age_ticks=tick - state.field_tick,
        status_age_ticks=tick - state.status_tick,
        unexpected_drive=state.coils.stuck,
        orbit_known=state.ephemeris is not None,
        second_sender=state.second_sender.named,
        stale_after_ticks=config.stale_after_ticks,
    )
    violated = first_violation(watched)
    situation = modes.judge(
        attitude, state.setpoint.spin_radps, violated is not None, state.modes, config.modes
    )
    return Verdict(modes.advance(state.modes, situation, tick, config.modes), violated)
