"""Telecommands: what the ground may change in flight.

Each is carried out whole or, with nothing changed, refused whole, in the order of arrival, and answered by
one TC_ACK. One with the counter of the one before it is not carried out again, but is still answered.
"""

from collections.abc import Callable
from dataclasses import replace
from math import sqrt
from typing import Any, final

from fsw.core import modes
from fsw.core.algebra.vector import positive_definite
from fsw.core.config import FlightConfig
from fsw.core.estimation.estimator import discard_trace
from fsw.core.estimation.loaded import freeze, load, thaw
from fsw.core.estimation.parameters import component_places, estimated_inertia
from fsw.core.estimation.start.batch import discard_samples
from fsw.core.fdir.coils.retest import forget_gain
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.fdir import Health
from fsw.core.gate.measurements import Measurements
from fsw.core.gate.readings import Telecommand
from fsw.core.laws.entry import LawEntry, is_met
from fsw.core.laws.interface import MAX_GAIN, MAX_SPIN_RADPS, ControlConfig
from fsw.core.laws.table import LAWS, OWN_NUMBER
from fsw.core.monitors import Monitor, trips
from fsw.core.orbit.elements import RANGES, Upload
from fsw.core.orbit.ephemeris import advance, with_orbit
from fsw.core.orbit.propagation import element_orbit
from fsw.core.state import FlightState
from fsw.wire.messages import (
    Component,
    Element,
    Gain,
    Mode,
    TcAck,
    TcAckResult,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
)


@final
class Situation:
    """What a telecommand is judged by besides the state."""

    __slots__ = ("config", "violated")

    def __init__(self, violated: Monitor | None, config: FlightConfig) -> None:
        self.violated = violated
        self.config = config


LAW_NAMES = {law.number: name for name, law in LAWS.items()}


def command(
    state: FlightState, measurements: Measurements, violated: Monitor | None, config: FlightConfig
) -> list[TcAck]:
    """Carry out the telecommands of this tick.

    Args:
        state: of this tick, its mode as the mode table left it.
        measurements: what came through the gate.
        violated: the monitor that is violated in this tick, if any.
        config: the onboard tables.

    Returns:
        An acknowledgement of each telecommand.
    """
    situation = Situation(violated, config)
    acks = []
    for message in measurements.telecommands:
        acks.append(_ack(message, HANDLERS[type(message)](state, message, situation), state.tick))
    for message in measurements.repeated:
        acks.append(_ack(message, TcAckResult.REPEATED, state.tick))
    return acks


def decimal(mantissa: int, exponent: int) -> float:
    """The float nearest to mantissa times 10^exponent, on every machine."""
    return float(f"{mantissa}e{exponent}")


def _ack(message: Telecommand, result: TcAckResult, tick: int) -> TcAck:
    return TcAck(result=result, command=message.ID, command_counter=message.counter, tick=tick)


def _mode(state: FlightState, message: TcMode, situation: Situation) -> TcAckResult:
    """SAFE at any time; out of it when all is well, but for a rate that DETUMBLE is to end.

    To a law that needs the attitude while it is usable.
    """
    if message.mode not in list(Mode):
        return TcAckResult.UNKNOWN
    mode = Mode(message.mode)
    free = state.modes.trips < situation.config.modes.trips_to_stay_safe and not trips(
        situation.violated, mode
    )
    needs_attitude = mode in (Mode.ACQUIRE, Mode.POINT)
    if mode is not Mode.SAFE and not (free and (state.attitude.usable or not needs_attitude)):
        return TcAckResult.NOT_ALLOWED
    modes.request_mode(state.modes, mode, state.tick)
    return TcAckResult.ACCEPTED


def _clear(state: FlightState, message: TcClear, situation: Situation) -> TcAckResult:
    """Forget the trips, trust every sensor again and use every coil, also its gain if it was isolated."""
    discard_trace(state.estimator)
    for coil, fault in enumerate(state.health.coils.faults):
        if fault:
            forget_gain(state.estimator, coil, situation.config.estimator.mekf)
    state.modes.trips = 0
    state.health = Health()
    return TcAckResult.ACCEPTED


def _law(state: FlightState, message: TcLaw, situation: Situation) -> TcAckResult:
    """A new law begins without memory; the current one, commanded again, keeps its own."""
    own = situation.config.control.own
    name = own.name if own is not None and message.law == OWN_NUMBER else LAW_NAMES.get(message.law)
    config = situation.config.control
    if name is None or (name in LAWS and not _can_fly(LAWS[name], config)):
        return TcAckResult.UNKNOWN
    if name != state.setpoint.law:
        state.setpoint, state.memory = replace(state.setpoint, law=name), ()
    return TcAckResult.ACCEPTED


def _can_fly(law: LawEntry, config: ControlConfig) -> bool:
    axis_body = None if config.wheel is None else config.wheel.axis_body
    return is_met(law.needs, config.pulsed, config.wheel_body_nms, axis_body)


def _spin(state: FlightState, message: TcSpin, situation: Situation) -> TcAckResult:
    if abs(message.spin) > MAX_SPIN_RADPS:
        return TcAckResult.OUT_OF_RANGE
    state.setpoint = replace(state.setpoint, spin_radps=message.spin)
    return TcAckResult.ACCEPTED


def _gain(state: FlightState, message: TcGain, situation: Situation) -> TcAckResult:
    if message.gain not in list(Gain):
        return TcAckResult.UNKNOWN
    value = decimal(message.mantissa, message.exponent)
    if message.mantissa < 0 or value > MAX_GAIN:
        return TcAckResult.OUT_OF_RANGE
    changed: dict[str, Any] = {Gain(message.gain).name.lower(): value}
    state.setpoint = replace(state.setpoint, **changed)
    return TcAckResult.ACCEPTED


def _element(state: FlightState, message: TcOrbitElement, situation: Situation) -> TcAckResult:
    if message.element not in list(Element):
        return TcAckResult.UNKNOWN
    element, value = Element(message.element), decimal(message.mantissa, message.exponent)
    low, high = RANGES[element]
    if not low <= value <= high:
        return TcAckResult.OUT_OF_RANGE
    state.upload = state.upload.with_element(element, value)
    return TcAckResult.ACCEPTED


def _load(state: FlightState, message: TcOrbitLoad, situation: Situation) -> TcAckResult:
    """Together the elements must describe a low orbit with a position around this tick.

    A batch of samples for a start begins anew: what was modelled of each is of the orbit before.
    """
    if not state.upload.complete:
        return TcAckResult.INCOMPLETE
    elements = state.upload.values
    try:
        element_orbit(elements)
    except ValueError:
        return TcAckResult.OUT_OF_RANGE
    window = advance(None, state.tick, with_orbit(situation.config.ephemeris, elements))
    if window is None:
        return TcAckResult.OUT_OF_RANGE
    state.orbit, state.upload, state.ephemeris = elements, Upload(), window
    discard_samples(state.estimator.batch)
    return TcAckResult.ACCEPTED


def _parameter(state: FlightState, message: TcParameter, situation: Situation) -> TcAckResult:
    """The filter continues from this value, and restarts from it; the inertia must stay positive definite.

    An implausible value is refused: the filter would restart from it again and again and never be trusted.
    """
    if message.component not in list(Component):
        return TcAckResult.UNKNOWN
    config, value = situation.config.estimator, decimal(message.mantissa, message.exponent)
    place = component_places(config.mekf.layout).get(message.component)
    if config.perfect or place is None:
        return TcAckResult.NOT_ALLOWED
    mean = config.mekf.initial_parameters.floats()[message.component]
    if abs(value - mean) > SIGMAS * sqrt(config.mekf.initial_covariance[place, place]):
        return TcAckResult.OUT_OF_RANGE
    loaded = state.estimator.copy()
    load(loaded, message.component, value, config.mekf)
    held = [loaded.first, loaded.estimate and loaded.estimate.parameters]
    inertias = [estimated_inertia(config.mekf.rotor, parameters) for parameters in held if parameters]
    if not all(map(positive_definite, inertias)):
        return TcAckResult.OUT_OF_RANGE
    state.estimator = loaded
    return TcAckResult.ACCEPTED


def _freeze(state: FlightState, message: TcFreeze, situation: Situation) -> TcAckResult:
    if message.frozen:
        freeze(state.estimator)
    else:
        thaw(state.estimator)
    return TcAckResult.ACCEPTED


Handler = Callable[[FlightState, Any, Situation], TcAckResult]

HANDLERS: dict[type[Telecommand], Handler] = {
    TcMode: _mode,
    TcClear: _clear,
    TcLaw: _law,
    TcSpin: _spin,
    TcGain: _gain,
    TcOrbitElement: _element,
    TcOrbitLoad: _load,
    TcParameter: _parameter,
    TcFreeze: _freeze,
}
