"""The flight loop as one pure function, from what the boards sent to what is sent and reported."""

from dataclasses import replace

from fsw.core import telemetry
from fsw.core.actuation import own_field, pulses, read_back, wheel
from fsw.core.actuation.actuator import actuate, update_view, wait_ticks
from fsw.core.actuation.driven import driven
from fsw.core.actuation.wheel import WheelView
from fsw.core.algebra.quaternion import rotate
from fsw.core.commands import command
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.estimation.estimator import anew, predict, update
from fsw.core.estimation.orbital_attitude import orbital_attitude, perfect_attitude
from fsw.core.estimation.parameters import NOTHING
from fsw.core.estimation.samples import sun_direction, usable_field
from fsw.core.fdir import fdir
from fsw.core.fdir.fdir import Evidence
from fsw.core.fdir.observation import Observation
from fsw.core.gate import calibration, second_sender
from fsw.core.gate.measurements import Measurements
from fsw.core.gate.readings import admit
from fsw.core.gate.sync_watch import Belief, SyncWatch, judge, near
from fsw.core.laws import by_mode
from fsw.core.laws.interface import Demand, FieldSample, LawInput
from fsw.core.laws.plan.constant_torque import constant_torque
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, plausible, reference_at, with_orbit
from fsw.core.packing import checksum
from fsw.core.restart import restarted
from fsw.core.state import FlightState, Inbox, initial_state
from fsw.core.supervisor import supervise
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire, TickDone, WheelTorque

Outbox = tuple[Frame, ...]


def boot(config: FlightConfig) -> FlightState:
    """The state before the first SYNC."""
    driven = config.wheel is not None
    return initial_state(
        pulses.boot(0, config.coils.pulses),
        config.control.setpoint,
        telemetry.first_counters(with_wheel=driven),
        WheelView() if driven else None,
    )


def step(state: FlightState, inbox: Inbox, config: FlightConfig) -> tuple[FlightState, Outbox]:
    """One tick: (state, inbox, config) -> (state, outbox), the outbox closed by TICK_DONE.

    A SYNC that is not believed is counted and answered with nothing; one that is repeated because the answer
    was not received, with TICK_DONE alone. Only the first and one that advances take the frames of the inbox.
    """
    before, tick = state, inbox.tick
    belief, syncs = judge(state.syncs, state.tick, tick, config.leap_ticks)
    if belief is Belief.IGNORED or belief is Belief.UNANSWERED:
        state = state._replace(ignored_syncs=state.ignored_syncs + 1, syncs=syncs)
        return state, (_done(state, tick),) if belief is Belief.UNANSWERED else ()
    state = state._replace(health=state.health.copy())
    state, inbox = _begin(state, inbox, belief, config)
    model = with_orbit(config.ephemeris, state.orbit)
    state, measurements = _gate(state, inbox, syncs, config)
    config = _with_wheel(state, before.tick, config)
    state, reference = _predict(state, model, before.tick, config)
    observation = _update(state, measurements, reference, config)
    state = _judge(state, observation, config)
    state, violated = supervise(state, config)
    state, acks = command(state, observation.measurements, violated, config)
    law_input, demand = _control(state, observation, model, config)
    state, requests = _schedule(state, observation.measurements, law_input, demand, config)
    replies = (*requests, *acks)
    state, frames = telemetry.report(before, state, observation, violated, replies, config)
    return state, (*frames, _done(state, tick))


def takes_inbox(before: FlightState, after: FlightState, leap_ticks: int) -> bool:
    """Whether a step has taken the frames of its inbox: the SYNC was the first, or advanced the count."""
    return after.tick != before.tick and (before.tick < 0 or near(before.tick, after.tick, leap_ticks))


def _done(state: FlightState, tick: int) -> Frame:
    return TickDone(tick, checksum(state)).encode()


def _begin(
    state: FlightState, inbox: Inbox, belief: Belief, config: FlightConfig
) -> tuple[FlightState, Inbox]:
    """At the first tick of a count every timer starts in full; skipped ticks stop the timers.

    What the coils drove in skipped ticks is not known.
    """
    tick, timing = inbox.tick, config.coils.pulses
    if belief is Belief.RESTARTED:
        state, inbox = restarted(state, tick, config), inbox._replace(frames=())
    if state.tick < 0:
        state = state._replace(pulses=pulses.boot(tick, timing), field_tick=tick, status_tick=tick)
    elif state.tick < tick - 1:
        timers = pulses.delay(state.pulses, tick, tick - state.tick - 1)
        state = state._replace(pulses=timers, coil=state.coil._replace(past_am2=(), idle_ticks=0))
    return state, inbox


def _gate(
    state: FlightState, inbox: Inbox, syncs: SyncWatch, config: FlightConfig
) -> tuple[FlightState, Measurements]:
    """Accept what the boards sent, and compare the coil driver's currents with the requests."""
    tick = inbox.tick
    gate = replace(state.gate, counters=state.gate.counters.copy())
    readings = admit(inbox.frames, gate, skipped=0 <= state.tick < tick - 1)
    measurements = calibration.measure(readings, config.calibration)
    read_back.remove_offset(measurements, state.coil, tick, config.read_back)
    view = update_view(state.coil, measurements, tick, config.coils)
    view = own_field.subtract_own_field(view, measurements, config.estimator.blank_ticks, config.own_field)
    expected_s = config.epoch_unix_s + tick // config.tick_hz
    fdir.judge_current(state.health, view, measurements, tick, config.fdir)
    state = state._replace(
        tick=tick,
        syncs=syncs if syncs.strange_tick < 0 else syncs._replace(strange_tick=-1),
        field_tick=tick if measurements.field is not None else state.field_tick,
        status_tick=tick if measurements.coil is not None else state.status_tick,
        time_error_s=inbox.unix_time_s - expected_s,
        gate=gate,
        second_sender=second_sender.watch(
            state.second_sender,
            measurements,
            view.seq,
            config.coils.dipoles is None,
            tick,
            config.second_sender,
        ),
        coil=view,
        wheel=wheel.seen(state.wheel, measurements, tick, config.wheel),
    )
    return state, measurements


def _with_wheel(state: FlightState, before: int, config: FlightConfig) -> FlightConfig:
    """The tables with an estimator that accounts for the driven wheel, if there is one."""
    if state.wheel is None:
        return config
    ticks = state.tick - before if before >= 0 else 1
    seen = wheel.estimating(config.estimator, state.wheel, state.tick, ticks, config.wheel)
    return replace(config, estimator=seen)


def _predict(
    state: FlightState, model: EphemerisModel, before: int, config: FlightConfig
) -> tuple[FlightState, Reference | None]:
    """Carry ephemeris and estimate to this tick; the reference is None where the orbit has no position."""
    ephemeris = advance(state.ephemeris, state.tick, model)
    if ephemeris is None:
        return _without_orbit(state), None
    reference = reference_at(ephemeris, state.tick, config.ephemeris)
    if not plausible(reference):
        return _without_orbit(state), None
    state = state._replace(ephemeris=ephemeris)
    if state.estimator.estimate is None and not state.estimator.batch.samples:
        return state, reference
    tick, view, coils = state.tick, state.coil, config.coils
    driven_am2 = fdir.driven_am2(state.health, view, config.fdir)
    drives = driven(view, driven_am2, state.status_tick == tick, range(before + 1, tick + 1), coils)
    return state._replace(estimator=predict(state.estimator, reference, drives, config.estimator)), reference


def _without_orbit(state: FlightState) -> FlightState:
    """The state where the orbit has no position: nothing carries the estimate on, so it ends."""
    fdir.discard_proof(state.health)
    return state._replace(ephemeris=None, estimator=anew(state.estimator))


def _update(
    state: FlightState, measurements: Measurements, reference: Reference | None, config: FlightConfig
) -> Observation:
    """Update the estimate by the samples that may be trusted."""
    if reference is None:
        return Observation(measurements, None, state.estimator, UNKNOWN)
    if config.estimator.perfect:
        attitude = perfect_attitude(measurements, state.attitude)
        return Observation(measurements, reference, state.estimator, attitude)
    known = state.estimator.estimate if state.attitude.valid else None
    findings = fdir.examine(measurements, state.health, reference, config.fdir, known)
    fdir.judge_samples(measurements, state.health, findings)
    updated, used = update(state.estimator, measurements, reference, config.estimator)
    attitude = orbital_attitude(updated.estimate, reference, config.estimator.valid_sigma_rad)
    return Observation(measurements, reference, updated, attitude, used, findings)


def _judge(state: FlightState, observation: Observation, config: FlightConfig) -> FlightState:
    """Judge sensors and coils by all samples, those of isolated sensors included."""
    reference, findings, tick = observation.reference, observation.findings, state.tick
    estimator, attitude = observation.estimator, observation.attitude
    if reference is not None and findings is not None:
        settled = state.syncs.settled(tick)
        evidence = Evidence(tick, findings, state.coil, reference, observation.used, settled)
        estimator, attitude = fdir.judge(state.health, estimator, attitude, evidence, config.fdir)
    return state._replace(estimator=estimator, attitude=attitude)


def _control(
    state: FlightState, observation: Observation, model: EphemerisModel, config: FlightConfig
) -> tuple[LawInput, Demand | None]:
    """What the law of this mode knows, and what it demands."""
    law_input = _law_input(state, observation, model, config)
    demand = by_mode.demand(state.modes.mode, law_input, state.memory, state.setpoint, config.control)
    return law_input, demand


def _law_input(
    state: FlightState, observation: Observation, model: EphemerisModel, config: FlightConfig
) -> LawInput:
    """The field is the modelled one where the attitude is valid, otherwise the last one measured."""
    measurements, reference, attitude = observation.measurements, observation.reference, state.attitude
    usable = usable_field(measurements)
    sample = FieldSample(usable, state.tick) if usable is not None else state.sample
    b_body_t = sample.b_body_t
    if attitude.valid and reference is not None:
        b_orbit_t = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
        b_body_t = rotate(attitude.q_body_from_orbit, b_orbit_t)
    estimate, faults = state.estimator.estimate, state.health.coils.faults
    parameters = estimate.parameters if estimate is not None else NOTHING
    return LawInput(
        attitude,
        b_body_t,
        sample,
        state.sample,
        sun_direction(measurements, config.estimator.mekf.cells),
        reference,
        constant_torque(parameters, reference),
        parameters.dipole_body_am2,
        state.tick,
        model,
        wait_ticks(state.pulses, state.coil, measurements, state.tick, config.coils.pulses, faults),
        wheel.momentum_nms(state.wheel, config.wheel),
    )


def _schedule(
    state: FlightState,
    measurements: Measurements,
    law_input: LawInput,
    demand: Demand | None,
    config: FlightConfig,
) -> tuple[FlightState, list[CoilFire | CoilDipole | WheelTorque]]:
    """At most one request to the coil driver, and one to the wheel."""
    faults, b_body_t = state.health.coils.faults, law_input.b_body_t
    timers, view, request = actuate(
        state.pulses, state.coil, demand, b_body_t, measurements, state.tick, config.coils, faults
    )
    memory = demand.memory if demand is not None else ()
    turning, torque = wheel.request(state.wheel, demand, state.tick, config.wheel)
    state = state._replace(sample=law_input.sample, memory=memory, pulses=timers, coil=view, wheel=turning)
    coils = [] if request is None else [calibration.for_outputs(request, config.calibration)]
    return state, [*coils, *([] if torque is None else [torque])]
