"""What fsw reports: navigation, events, heartbeat. Every message has a counter of its own in the state."""

from collections.abc import Sequence
from math import sqrt

from fsw.core.config import FlightConfig
from fsw.core.estimation import mekf
from fsw.core.estimation.attitude import Attitude
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import Layout, component_places
from fsw.core.events import SEVERITY, Event, Happening, Throttle, throttle_events
from fsw.core.fdir import fault_events
from fsw.core.fdir.observation import Observation
from fsw.core.gate.measurements import Measurements
from fsw.core.gate.sync_watch import near
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor
from fsw.core.orbit.ephemeris import Reference
from fsw.core.rates import RateTable
from fsw.core.state import FlightState
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilDipole,
    CoilFire,
    CountedMessage,
    FswBoot,
    FswEvent,
    FswHeartbeat,
    NavAttitude,
    NavParameter,
    NavQuality,
    NavRate,
    TcAck,
    WheelTorque,
)

CONTRACT_VERSION = 1
LEAST_ARGUMENT, MOST_ARGUMENT = -(2**31), 2**31 - 1
"""Of an event."""
COUNTED = (
    CoilFire.ID,
    CoilDipole.ID,
    NavAttitude.ID,
    NavRate.ID,
    NavQuality.ID,
    NavParameter.ID,
    TcAck.ID,
    FswEvent.ID,
    FswHeartbeat.ID,
    WheelTorque.ID,
)
_SLOT = {can_id: slot for slot, can_id in enumerate(COUNTED)}


def first_counters(with_wheel: bool) -> tuple[int, ...]:
    """The counters of fsw's messages at boot; that of ``WHEEL_TORQUE`` only where there is a wheel."""
    return (0,) * (len(COUNTED) - (not with_wheel))


def boot_frame(table_crc: int) -> Frame:
    """FSW_BOOT: sent once, before the first SYNC."""
    return FswBoot(reason=0, version=CONTRACT_VERSION, table_crc=table_crc).encode()


def report(
    before: FlightState,
    state: FlightState,
    observation: Observation,
    violated: Monitor | None,
    replies: Sequence[CountedMessage],
    config: FlightConfig,
) -> tuple[FlightState, list[Frame]]:
    """The frames of this tick: requests and acknowledgements, then telemetry as it is due."""
    events, of_events = event_messages(
        before, state, observation.measurements, violated, config.event_spacing_ticks, config.leap_ticks
    )
    messages = [
        *replies,
        *navigation_messages(state, observation.used, observation.reference, config.rates),
        *parameter_messages(state, config.estimator.mekf.layout, config.rates),
        *of_events,
        *heartbeat_messages(state, config.rates),
    ]
    frames, sent = number(messages, state.sent)
    return state._replace(events=events, sent=sent), frames


def navigation_messages(
    state: FlightState, used: Used, reference: Reference | None, rates: RateTable
) -> list[CountedMessage]:
    """NAV_ATTITUDE, NAV_RATE and NAV_QUALITY, those that are due."""
    messages: list[CountedMessage] = []
    if rates.attitude.due(state.tick):
        messages += attitude_messages(state.attitude)
    if rates.quality.due(state.tick):
        lit = reference is not None and reference.lit
        messages.append(quality_message(state.attitude, state.modes, used, lit))
    return messages


def parameter_messages(state: FlightState, places: Layout, rates: RateTable) -> list[CountedMessage]:
    """NAV_PARAMETER of the component whose turn it is, if one is due and there is an estimate.

    Args:
        state: of this tick.
        places: of the error state.
        rates: when it is due.
    """
    estimate, group = state.estimator.estimate, rates.parameter
    if not group.due(state.tick) or estimate is None or not mekf.healthy(estimate):
        return []
    known = list(component_places(places).items())
    return [parameter_message(estimate, *known[group.in_turn(state.tick, len(known))])] if known else []


def heartbeat_messages(state: FlightState, rates: RateTable) -> list[CountedMessage]:
    """FSW_HEARTBEAT, if it is due."""
    if not rates.heartbeat.due(state.tick):
        return []
    return [heartbeat_message(state.tick, state.modes, state.gate.rejected)]


def event_messages(
    before: FlightState,
    after: FlightState,
    measurements: Measurements,
    violated: Monitor | None,
    spacing_ticks: int,
    leap_ticks: int,
) -> tuple[Throttle, list[CountedMessage]]:
    """The events of this tick that may be sent, and the throttle after it."""
    found = happenings(before, after, measurements, violated, leap_ticks)
    throttle, passed = throttle_events(after.events, found, after.tick, spacing_ticks)
    return throttle, [event_message(happening, after.tick) for happening in passed]


def attitude_messages(attitude: Attitude) -> list[CountedMessage]:
    """NAV_ATTITUDE and NAV_RATE."""
    _, q1, q2, q3 = attitude.q_body_from_orbit
    valid = int(attitude.valid)
    return [NavAttitude(valid, q1, q2, q3), NavRate(valid, *attitude.omega_body_orbit_radps)]


def quality_message(attitude: Attitude, modes: ModeState, used: Used, lit: bool) -> CountedMessage:
    """NAV_QUALITY."""
    return NavQuality(
        mode=modes.mode,
        sigma3_attitude=attitude.sigma3_attitude_rad,
        sigma3_rate=attitude.sigma3_rate_radps,
        mag_used=int(used.field),
        sun_used=int(used.sun),
        mag_blanked=int(used.blanked),
        eclipse=int(not lit),
        estimate_valid=int(attitude.valid),
        tripped=int(modes.trips > 0),
        trips=min(modes.trips, 255),
    )


DIGITS = 4
"""Digits of a reported parameter after the first."""


def parameter_message(estimate: Estimate, component: int, place: int) -> CountedMessage:
    """NAV_PARAMETER.

    Args:
        estimate: of finite numbers.
        component: its number among the parameters.
        place: where it stands in the error state.
    """
    value, sigma = estimate.parameters.floats()[component], sqrt(estimate.covariance[place, place])
    _, _, exponent_text = f"{max(abs(value), sigma):.{DIGITS}e}".partition("e")
    exponent = int(exponent_text) - DIGITS
    unit = float(f"1e{exponent}")
    return NavParameter(component, exponent, round(value / unit), round(sigma / unit))


def heartbeat_message(tick: int, modes: ModeState, rejects: int) -> CountedMessage:
    """FSW_HEARTBEAT."""
    return FswHeartbeat(state=modes.mode, rejects=min(rejects, 0xFFFF), slips=0, tick=tick)


def happenings(
    before: FlightState,
    after: FlightState,
    measurements: Measurements,
    violated: Monitor | None,
    leap_ticks: int,
) -> list[Happening]:
    """The events of this tick: changes only, so that nothing is reported again while it lasts."""
    found = _plant(before, after, measurements, leap_ticks) if before.tick >= 0 else []
    tripped = after.modes.trips > before.modes.trips
    if violated is not None and (tripped or violated != before.violated):
        found.append(Happening(Event.MONITOR_TRIPPED, violated))
    if after.modes.mode is not before.modes.mode:
        found.append(Happening(Event.MODE_CHANGED, after.modes.mode))
    if after.estimator.restarts != before.estimator.restarts:
        found.append(Happening(Event.FILTER_RESTARTED, after.estimator.restarts))
    if before.estimator.estimate is None and after.estimator.estimate is not None:
        found.append(Happening(Event.FILTER_STARTED, after.estimator.restarts))
    faults_before = fault_events.find_faults(before.health)
    found += fault_events.happenings(faults_before, fault_events.find_faults(after.health))
    if after.second_sender.detected and not before.second_sender.detected:
        found.append(Happening(Event.SECOND_SENDER, after.second_sender.can_id))
    if measurements.refused is not None:
        found.append(Happening(Event.REQUEST_REFUSED, measurements.refused.reason))
    if after.time_error_s != before.time_error_s:
        found.append(Happening(Event.TIME_MISMATCH, after.time_error_s))
    return found


def _plant(
    before: FlightState, after: FlightState, measurements: Measurements, leap_ticks: int
) -> list[Happening]:
    """A restart of the plant, and frames under its identifiers that it cannot have sent."""
    found = []
    if not near(before.tick, after.tick, leap_ticks):
        found.append(Happening(Event.PLANT_RESTARTED, before.tick))
    elif before.syncs.strange_tick >= 0:
        found.append(Happening(Event.STRANGE_SYNC, before.syncs.strange_tick))
    if measurements.end_ticks >= 0:
        found.append(Happening(Event.FALSE_END, measurements.end_ticks))
    return found


def event_message(happening: Happening, tick: int) -> CountedMessage:
    """FSW_EVENT; a time out of range saturates, and the number of a tick wraps."""
    event, argument = happening
    if event == Event.TIME_MISMATCH:
        argument = max(LEAST_ARGUMENT, min(argument, MOST_ARGUMENT))
    return FswEvent(severity=SEVERITY[event], event=event, tick=tick, argument=argument)


def number(messages: list[CountedMessage], sent: tuple[int, ...]) -> tuple[list[Frame], tuple[int, ...]]:
    """Give each message its counter and encode it; also return the counters afterwards."""
    counters = list(sent)
    frames = []
    for message in messages:
        slot = _SLOT[message.ID]
        message.counter = counters[slot]
        frames.append(message.encode())
        counters[slot] = (counters[slot] + 1) & 0xF
    return frames, tuple(counters)
