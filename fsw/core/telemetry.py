"""What fsw reports: navigation, events, heartbeat. Every message has a counter of its own in the state."""

from collections.abc import Sequence
from math import sqrt
from typing import Final, final

from fsw.core.config import FlightConfig
from fsw.core.estimation import mekf
from fsw.core.estimation.attitude import Attitude
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import ATTITUDE_AND_RATE, Layout, component
from fsw.core.events import SEVERITY, Event, Happening, Throttle, throttle_events
from fsw.core.fdir.faults import Sensor
from fsw.core.fdir.fdir import Health
from fsw.core.fdir.observation import Observation
from fsw.core.fdir.sensors.cells import cell_changes, cell_faults
from fsw.core.fdir.sensors.pair import Standing
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

# --- The faults of all units, and what is reported of those that are new or gone


@final
class Faults:
    """The faults of all units, to compare with those of another tick.

    By number: ``field`` and ``sun``, those of each cell, and of each coil; ``disputed``: field and Sun
    disagree.
    """

    __slots__ = ("cells", "coils", "disputed", "field", "sun")

    def __init__(
        self, field: int, sun: int, cells: tuple[int, ...], disputed: bool, coils: tuple[int, int, int]
    ) -> None:
        self.field = field
        self.sun = sun
        self.cells = cells
        self.disputed = disputed
        self.coils = coils


def find_faults(health: Health) -> Faults:
    """The faults that have been found so far."""
    sensors = health.sensors
    return Faults(
        sensors.field.fault,
        sensors.sun.fault,
        cell_faults(sensors.cells),
        sensors.pair.standing is Standing.DISPUTED,
        health.coils.faults,
    )


def fault_happenings(before: Faults, after: Faults) -> list[Happening]:
    """An event for each fault that is new or gone."""
    found: list[Happening] = []
    _add_sensor(found, Sensor.MAGNETOMETER, before.field, after.field)
    _add_sensor(found, Sensor.SUN_SENSOR, before.sun, after.sun)
    for cell, was, now in cell_changes(before.cells, after.cells):
        _add_sensor(found, Sensor.CELL_1 + cell, was, now)
    if after.disputed and not before.disputed:
        found.append(Happening(Event.SENSORS_DISAGREE, 0))
    _add_coil(found, 1, before.coils[0], after.coils[0])
    _add_coil(found, 2, before.coils[1], after.coils[1])
    _add_coil(found, 3, before.coils[2], after.coils[2])
    return found


def _add_sensor(found: list[Happening], sensor: int, before: int, after: int) -> None:
    """Add the event of a sensor whose fault has changed, if it has."""
    if before != after:
        kind = Event.SENSOR_ISOLATED if after else Event.SENSOR_READMITTED
        found.append(Happening(kind, 100 * sensor + (after or before)))


def _add_coil(found: list[Happening], coil: int, before: int, after: int) -> None:
    """Add the event of a coil whose fault has changed, if it has; coils are numbered from 1."""
    if before != after:
        kind = Event.COIL_FAULT if after else Event.COIL_READMITTED
        found.append(Happening(kind, 100 * coil + (after or before)))


# --- What is sent in a tick

CONTRACT_VERSION: Final = 1
LEAST_ARGUMENT: Final = -(2**31)
MOST_ARGUMENT: Final = 2**31 - 1
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
_SLOT: Final = {can_id: slot for slot, can_id in enumerate(COUNTED)}


def first_counters(with_wheel: bool) -> list[int]:
    """The counters of fsw's messages at boot; that of ``WHEEL_TORQUE`` only where there is a wheel."""
    return [0] * (len(COUNTED) - (not with_wheel))


def boot_frame(table_crc: int) -> Frame:
    """FSW_BOOT: sent once, before the first SYNC."""
    return FswBoot(reason=0, version=CONTRACT_VERSION, table_crc=table_crc).encode()


@final
class Before:
    """What the events of a tick are found by: how these were before it."""

    __slots__ = (
        "easings",
        "faults",
        "mode",
        "restarts",
        "second_sender",
        "started",
        "strange_tick",
        "tick",
        "time_error_s",
        "trips",
        "violated",
    )

    def __init__(self, state: FlightState) -> None:
        self.tick = state.tick
        self.strange_tick = state.syncs.strange_tick
        self.time_error_s = state.time_error_s
        self.mode = state.modes.mode
        self.trips = state.modes.trips
        self.violated = state.violated
        self.started = state.estimator.estimate is not None
        self.restarts = state.estimator.restarts
        self.easings = state.estimator.easings
        self.faults = find_faults(state.health)
        self.second_sender = state.second_sender.detected


def report(
    before: Before,
    state: FlightState,
    observation: Observation,
    violated: Monitor | None,
    replies: Sequence[CountedMessage],
    config: FlightConfig,
) -> list[Frame]:
    """The frames of this tick: requests and acknowledgements, then telemetry as it is due."""
    found = happenings(before, state, observation.measurements, violated, config.leap_ticks)
    messages = [
        *replies,
        *navigation_messages(state, observation.used, observation.reference, config.rates),
        *parameter_messages(state, config.estimator.mekf.layout, config.rates),
        *event_messages(state.events, found, state.tick, config.event_spacing_ticks),
        *heartbeat_messages(state, config.rates),
    ]
    return number(messages, state.sent)


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
    known = places.components
    if not known:
        return []
    turn = group.in_turn(state.tick, len(known))
    return [parameter_message(estimate, known[turn], ATTITUDE_AND_RATE + turn)]


def heartbeat_messages(state: FlightState, rates: RateTable) -> list[CountedMessage]:
    """FSW_HEARTBEAT, if it is due."""
    if not rates.heartbeat.due(state.tick):
        return []
    return [heartbeat_message(state.tick, state.modes, state.gate.rejected)]


def event_messages(
    throttle: Throttle, found: list[Happening], tick: int, spacing_ticks: int
) -> list[CountedMessage]:
    """Those events of this tick that may be sent."""
    passed = throttle_events(throttle, found, tick, spacing_ticks)
    return [event_message(happening, tick) for happening in passed]


def attitude_messages(attitude: Attitude) -> list[CountedMessage]:
    """NAV_ATTITUDE and NAV_RATE."""
    _, q1, q2, q3 = attitude.q_body_from_orbit
    w1, w2, w3 = attitude.omega_body_orbit_radps
    valid = int(attitude.valid)
    return [NavAttitude(valid, q1, q2, q3), NavRate(valid, w1, w2, w3)]


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


DIGITS: Final = 4
"""Digits of a reported parameter after the first."""


def parameter_message(estimate: Estimate, number: int, place: int) -> CountedMessage:
    """NAV_PARAMETER.

    Args:
        estimate: of finite numbers.
        number: that of the component among the parameters.
        place: where it stands in the error state.
    """
    value, sigma = component(estimate.parameters, number), sqrt(estimate.covariance[place, place])
    _, _, exponent_text = f"{max(abs(value), sigma):.{DIGITS}e}".partition("e")
    exponent = int(exponent_text) - DIGITS
    unit = float(f"1e{exponent}")
    return NavParameter(number, exponent, round(value / unit), round(sigma / unit))


def heartbeat_message(tick: int, modes: ModeState, rejects: int) -> CountedMessage:
    """FSW_HEARTBEAT."""
    return FswHeartbeat(state=modes.mode, rejects=min(rejects, 0xFFFF), slips=0, tick=tick)


def happenings(
    before: Before, state: FlightState, measurements: Measurements, violated: Monitor | None, leap_ticks: int
) -> list[Happening]:
    """The events of this tick: changes only, so that nothing is reported again while it lasts."""
    found = _plant(before, state.tick, measurements, leap_ticks) if before.tick >= 0 else []
    tripped = state.modes.trips > before.trips
    if violated is not None and (tripped or violated != before.violated):
        found.append(Happening(Event.MONITOR_TRIPPED, violated))
    if state.modes.mode is not before.mode:
        found.append(Happening(Event.MODE_CHANGED, state.modes.mode))
    restarts = state.estimator.restarts
    if restarts != before.restarts:
        found.append(Happening(Event.FILTER_RESTARTED, restarts))
    if state.estimator.easings != before.easings:
        found.append(Happening(Event.FILTER_EASED, state.estimator.easings))
    if not before.started and state.estimator.estimate is not None:
        found.append(Happening(Event.FILTER_STARTED, restarts))
    found += fault_happenings(before.faults, find_faults(state.health))
    if state.second_sender.detected and not before.second_sender:
        found.append(Happening(Event.SECOND_SENDER, state.second_sender.can_id))
    found += [Happening(Event.REQUEST_REFUSED, refused.reason) for refused in measurements.refused]
    if state.time_error_s != before.time_error_s:
        found.append(Happening(Event.TIME_MISMATCH, state.time_error_s))
    return found


def _plant(before: Before, tick: int, measurements: Measurements, leap_ticks: int) -> list[Happening]:
    """A restart of the plant, and frames under its identifiers that it cannot have sent."""
    found = []
    if not near(before.tick, tick, leap_ticks):
        found.append(Happening(Event.PLANT_RESTARTED, before.tick))
    elif before.strange_tick >= 0:
        found.append(Happening(Event.STRANGE_SYNC, before.strange_tick))
    if measurements.end_ticks >= 0:
        found.append(Happening(Event.FALSE_END, measurements.end_ticks))
    return found


def event_message(happening: Happening, tick: int) -> CountedMessage:
    """FSW_EVENT; a time out of range saturates, and the number of a tick wraps."""
    event, argument = happening.event, happening.argument
    if event == Event.TIME_MISMATCH:
        argument = max(LEAST_ARGUMENT, min(argument, MOST_ARGUMENT))
    return FswEvent(severity=SEVERITY[event], event=event, tick=tick, argument=argument)


def number(messages: list[CountedMessage], sent: list[int]) -> list[Frame]:
    """Give each message its counter and encode it; count it in ``sent``."""
    frames = []
    for message in messages:
        slot = _SLOT[message.ID]
        message.counter = sent[slot]
        frames.append(message.encode())
        sent[slot] = (sent[slot] + 1) & 0xF
    return frames
