"""Monitors and mode table together: whether all is well, and which mode follows."""

from fsw.core import modes
from fsw.core.config import FlightConfig
from fsw.core.laws.table import open_loop
from fsw.core.monitors import Monitor, MonitorInput, first_violation, trips
from fsw.core.state import FlightState


def supervise(state: FlightState, config: FlightConfig) -> tuple[FlightState, Monitor | None]:
    """Judge this tick.

    Args:
        state: of this tick except for its mode, which is that of the tick before.
        config: the onboard tables.

    Returns:
        The state in the mode of this tick, and the monitor that is violated, if any.
    """
    watched = MonitorInput(
        attitude=state.attitude,
        owed_impulse_body_nms=state.pulses.owed_impulse_body_nms,
        field_age_ticks=state.tick - state.field_tick,
        status_age_ticks=state.tick - state.status_tick,
        unexpected_drive=state.health.coils.stuck,
        orbit_known=state.ephemeris is not None,
        second_sender=state.second_sender.detected,
        stale_after_ticks=config.stale_after_ticks,
    )
    violated = first_violation(watched)
    can_act = not state.health.sensors.field.fault or open_loop(state.setpoint)
    tripped = trips(violated, state.modes.mode)
    situation = modes.judge(
        state.attitude, state.setpoint.spin_radps, tripped, can_act, state.modes, config.modes
    )
    after = modes.advance(state.modes, situation, state.tick, config.modes)
    number = 0 if violated is None else violated
    if after is state.modes and number == state.violated:
        return state, violated
    return state._replace(modes=after, violated=number), violated
