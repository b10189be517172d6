"""Monitors and mode table together: whether all is well, and which mode follows."""

from fsw.core import modes
from fsw.core.config import FlightConfig
from fsw.core.laws.table import open_loop
from fsw.core.monitors import Monitor, MonitorInput, first_violation, trips
from fsw.core.state import FlightState


def supervise(state: FlightState, config: FlightConfig) -> Monitor | None:
    """Judge this tick, and take the transition of the mode table that is due.

    Args:
        state: of this tick except for its mode, which is that of the tick before.
        config: the onboard tables.

    Returns:
        The monitor that is violated, if any.
    """
    watched = MonitorInput(
        attitude=state.attitude,
        pending_impulse_body_nms=state.pulses.pending_impulse_body_nms,
        field_age_ticks=state.tick - state.field_tick,
        status_age_ticks=state.tick - state.status_tick,
        time_age_ticks=state.tick - state.time_tick,
        unexpected_drive=state.health.coils.stuck,
        orbit_available=state.ephemeris is not None,
        second_sender=state.second_sender.detected,
        stale_after_ticks=config.stale_after_ticks,
    )
    violated = first_violation(watched)
    can_act = not state.health.sensors.field.fault or open_loop(state.setpoint)
    tripped = trips(violated, state.modes.mode)
    axes = config.control.axes
    attitude = state.attitude if axes is None else axes.attitude(state.attitude)
    conditions = modes.judge_conditions(
        attitude, state.setpoint.spin_radps, tripped, can_act, state.modes, config.modes
    )
    modes.advance(state.modes, conditions, state.tick, config.modes)
    state.violated = 0 if violated is None else int(violated)
    return violated
