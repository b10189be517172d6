"""The flight loop as one pure function: gate, estimate, supervise, obey, control, schedule, report."""

from fsw.core import telemetry
from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import actuate, hear, unexpected
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO
from fsw.core.commands import command
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.estimation.estimator import (
    NONE_USED,
    Used,
    attitude,
    estimate,
    perfect_attitude,
    restart,
    untraced,
    usable_field,
    usable_sun,
)
from fsw.core.fdir import coil_health, sensor_health
from fsw.core.gate import second_sender
from fsw.core.gate.readings import Readings, admit
from fsw.core.gate.sync_watch import Belief, judge, near
from fsw.core.laws import by_mode
from fsw.core.laws.interface import FieldSample, Seen
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, fly_orbit, reference_at, sound
from fsw.core.restart import restarted
from fsw.core.state import FlightState, Inbox, checksum, initial_state
from fsw.core.supervisor import Verdict, supervise
from fsw.core.throttle import Throttle, throttled
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire, CountedMessage, TcAck, TickDone

Outbox = tuple[Frame, ...]


def boot(config: FlightConfig) -> FlightState:
    """The state before the first SYNC."""
    return initial_state(
        pulses.boot(0, config.coils.pulses), config.control.setpoint, telemetry.FIRST_COUNTERS
    )


def step(state: FlightState, inbox: Inbox, config: FlightConfig) -> tuple[FlightState, Outbox]:
    """One tick: (state, inbox, config) -> (state, outbox), the outbox closed by TICK_DONE.

    A SYNC that is not believed is counted and answered with nothing; one that is repeated because the answer
    was not heard, with TICK_DONE alone. Only the first and one that goes on take what is in the inbox.
    """
    before, tick = state, inbox.tick
    belief, syncs = judge(state.syncs, state.tick, tick)
    if belief is Belief.IGNORED or belief is Belief.UNHEARD:
        state = state._replace(ignored_syncs=state.ignored_syncs + 1, syncs=syncs)
        return state, (TickDone(tick, checksum(state)).encode(),) if belief is Belief.UNHEARD else ()
    if belief is Belief.RESTARTED:
        state, inbox = restarted(state, tick, config), inbox._replace(frames=())
    elif 0 <= state.tick < tick - 1:
        state = state._replace(pulses=pulses.delay(state.pulses, tick, tick - state.tick - 1))
    state = state._replace(syncs=syncs._replace(strange_tick=-1))
    model = fly_orbit(config.ephemeris, state.orbit)
    state, readings = _gate(state, inbox, model, config)
    state, readings, reference, used = _estimate(state, readings, tick - before.tick, config)
    verdict = supervise(state, state.attitude, tick, config)
    state, acks = command(state._replace(modes=verdict.modes), readings, verdict.violated is not None, config)
    seen = _look(state, readings, reference, model)
    demand = by_mode.demand(state.modes.mode, seen, state.memory, state.setpoint, config.control)
    pulse_state, coil, request = actuate(
        state.pulses, state.coil, demand, seen.b_body_t, readings, tick, config.coils, state.coils.faults
    )
    frames, events, sent = _report(before, state, readings, used, reference, verdict, acks, request, config)
    state = state._replace(
        sample=seen.sample,
        memory=demand.memory if demand is not None else (),
        pulses=pulse_state,
        coil=coil,
        events=events,
        sent=sent,
    )
    return state, (*frames, TickDone(tick, checksum(state)).encode())


def takes_inbox(before: FlightState, after: FlightState) -> bool:
    """Whether a step has looked at what came: the SYNC was the first, or went on."""
    return after.tick != before.tick and (before.tick < 0 or near(before.tick, after.tick))


def _gate(
    state: FlightState, inbox: Inbox, model: EphemerisModel, config: FlightConfig
) -> tuple[FlightState, Readings]:
    """Take what the boards said; at the first tick of a count start every timer in full."""
    tick = inbox.tick
    if state.tick < 0:
        state = state._replace(
            pulses=pulses.boot(tick, config.coils.pulses), field_tick=tick, status_tick=tick
        )
    readings, gate = admit(inbox.frames, state.gate)
    view = hear(state.coil, readings, tick, config.coils)
    unasked = unexpected(view, tick, config.coils.pulses)
    expected_s = config.epoch_unix_s + tick // config.tick_hz
    heard = state._replace(
        tick=tick,
        field_tick=tick if readings.field is not None else state.field_tick,
        status_tick=tick if readings.coil is not None else state.status_tick,
        time_error_s=inbox.unix_time_s - expected_s,
        gate=gate,
        second_sender=second_sender.watch(
            state.second_sender, readings, view.seq, config.coils.dipoles is None, tick, config.second_sender
        ),
        ephemeris=advance(state.ephemeris, tick, model),
        coil=view,
        coils=coil_health.judge_current(
            state.coils, view, readings, unasked, tick, config.coils.pulses, config.coil_health
        ),
    )
    return heard, readings


def _estimate(
    state: FlightState, readings: Readings, elapsed_ticks: int, config: FlightConfig
) -> tuple[FlightState, Readings, Reference | None, Used]:
    """The estimate of this tick, the readings that may be trusted, what was expected and what was taken."""
    if state.ephemeris is None:
        return state._replace(attitude=UNKNOWN), readings, None, NONE_USED
    reference = reference_at(state.ephemeris, state.tick, config.ephemeris)
    if not sound(reference):
        lost = state._replace(ephemeris=None, estimator=restart(state.estimator), attitude=UNKNOWN)
        return lost, readings, None, NONE_USED
    if config.estimator.perfect:
        known = perfect_attitude(readings, state.attitude)
        return state._replace(attitude=known), readings, reference, NONE_USED
    trusted = sensor_health.trusted(readings, state.sensors, reference)
    driven_am2 = coil_health.driven_am2(state.coils, state.coil, config.coils.pulses, config.coil_health)
    estimator, used = estimate(
        state.estimator, trusted, reference, driven_am2, elapsed_ticks, config.estimator
    )
    seen = attitude(estimator, reference, config.estimator)
    sensors = sensor_health.judge(
        state.sensors,
        readings,
        usable_field(readings),
        usable_sun(readings),
        reference,
        used,
        estimator.estimate,
        seen.sigma3_attitude_rad,
        config.sensors,
    )
    coils = state.coils
    if sensor_health.in_doubt(sensors, config.sensors):
        estimator = untraced(estimator)
    else:
        coils, estimator = coil_health.judge_rate(
            coils,
            state.coil,
            reference.b_eci_t,
            estimator,
            state.tick,
            config.coils.pulses,
            config.coil_health,
            config.estimator.mekf,
        )
    if sensors.doubted:
        estimator, seen = restart(estimator), UNKNOWN
    if coil_health.turned_unawares(coils):
        seen = seen._replace(valid=False)
    state = state._replace(estimator=estimator, sensors=sensors, coils=coils, attitude=seen)
    return state, trusted, reference, used


def _look(state: FlightState, readings: Readings, reference: Reference | None, model: EphemerisModel) -> Seen:
    """What the law sees: the modelled field where the attitude is known, else the measured one."""
    usable = usable_field(readings)
    sample = FieldSample(usable, state.tick) if usable is not None else state.sample
    b_body_t = sample.b_body_t
    if state.attitude.valid and reference is not None:
        b_orbit_t = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
        b_body_t = rotate(state.attitude.q_body_from_orbit, b_orbit_t)
    known = state.estimator.estimate
    torque_body_nm = known.torque_body_nm if known is not None else ZERO
    return Seen(
        state.attitude,
        b_body_t,
        sample,
        state.sample,
        usable_sun(readings),
        reference,
        torque_body_nm,
        state.tick,
        model,
    )


def _report(
    before: FlightState,
    state: FlightState,
    readings: Readings,
    used: Used,
    reference: Reference | None,
    verdict: Verdict,
    acks: list[TcAck],
    request: CoilFire | CoilDipole | None,
    config: FlightConfig,
) -> tuple[list[Frame], Throttle, tuple[int, ...]]:
    """The frames of this tick without TICK_DONE, what events were told, and the counters of what was sent."""
    tick = state.tick
    messages: list[CountedMessage] = [] if request is None else [request]
    messages += acks
    if config.rates.attitude.due(tick):
        messages += telemetry.attitude_messages(state.attitude)
    if config.rates.quality.due(tick):
        messages.append(
            telemetry.quality_message(
                state.attitude, state.modes, used, reference is not None and reference.lit
            )
        )
    happened = telemetry.happenings(before, state, readings, verdict.violated)
    events, happenings = throttled(state.events, happened, tick, config.event_spacing_ticks)
    messages += [telemetry.event_message(happening, tick) for happening in happenings]
    if config.rates.heartbeat.due(tick):
        messages.append(telemetry.heartbeat_message(tick, state.modes, state.gate.rejected))
    frames, sent = telemetry.number(messages, state.sent)
    return frames, events, sent
