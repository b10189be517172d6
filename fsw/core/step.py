"""The flight loop as one function, from what the boards sent to what is sent and reported."""

from math import atan2

from fsw.core import telemetry
from fsw.core.actuation import own_field, pulses, read_back, wheel
from fsw.core.actuation.actuator import actuate, update_view, wait_ticks
from fsw.core.actuation.drives import find_drives
from fsw.core.actuation.wheel import WheelView
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, cross, dot, norm
from fsw.core.commands import command
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.estimation.estimator import discard_estimate, predict, update
from fsw.core.estimation.mekf_config import WheelMotion
from fsw.core.estimation.orbital_attitude import orbital_attitude, perfect_attitude
from fsw.core.estimation.parameters import NOTHING
from fsw.core.estimation.samples import sun_direction, usable_field
from fsw.core.fdir import fdir
from fsw.core.fdir.fdir import Evidence
from fsw.core.fdir.observation import Observation
from fsw.core.gate import calibration
from fsw.core.gate.measurements import Measurements
from fsw.core.gate.readings import admit
from fsw.core.gate.second_sender import watch_senders
from fsw.core.gate.sync_watch import Belief, judge_sync, near
from fsw.core.laws import by_mode
from fsw.core.laws.interface import Demand, FieldSample, LawInput
from fsw.core.laws.plan.constant_torque import constant_torque
from fsw.core.monitors import MOST_TIME_ERROR_S
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, plausible, reference_at, with_orbit
from fsw.core.restart import begin_count
from fsw.core.state import FlightState, Inbox
from fsw.core.state_bytes import checksum
from fsw.core.supervisor import supervise
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire, TickDone, WheelTorque

Outbox = tuple[Frame, ...]


def boot(config: FlightConfig) -> FlightState:
    """The state before the first SYNC."""
    driven = config.wheel is not None
    return FlightState(
        pulses.boot(0, config.coils.pulses),
        config.control.setpoint,
        telemetry.first_counters(with_wheel=driven),
        WheelView() if driven else None,
    )


def step(state: FlightState, inbox: Inbox, config: FlightConfig) -> Outbox:
    """One tick: update the state by what the boards sent; the answer is closed by TICK_DONE.

    A SYNC that is not believed is counted and answered with nothing; one that is repeated because the answer
    was not received, with TICK_DONE alone. Only the first and one that advances take the frames of the inbox.
    """
    before, tick = telemetry.Before(state), inbox.tick
    belief = judge_sync(state.syncs, state.tick, tick, config.leap_ticks)
    if belief is Belief.IGNORED or belief is Belief.UNANSWERED:
        state.ignored_syncs += 1
        return (_done(state, tick),) if belief is Belief.UNANSWERED else ()
    frames = inbox.frames
    if belief is Belief.RESTARTED:
        begin_count(state, tick, config)
        frames = ()
    _skip_ticks(state, tick, config)
    model = with_orbit(config.ephemeris, state.orbit)
    measurements = _gate(state, tick, frames, config)
    _compare_time(state, inbox.unix_time_s, config)
    ticks = tick - before.tick if before.tick >= 0 else 1
    motion = wheel.wheel_motion(state.wheel, tick, ticks, config.wheel)
    reference = _predict(state, model, before.tick, motion, config)
    wheel_nms = ZERO if motion is None else motion.momentum_nms
    observation = _update(state, measurements, reference, wheel_nms, config)
    _judge(state, observation, wheel_nms, config)
    violated = supervise(state, config)
    acks = command(state, observation.measurements, violated, config)
    law_input = _law_input(state, observation, model, config)
    demand = by_mode.demand(state.modes.mode, law_input, state.memory, state.setpoint, config.control)
    requests = _schedule(state, observation.measurements, law_input, demand, config)
    answer = telemetry.report(before, state, observation, violated, (*requests, *acks), config)
    return (*answer, _done(state, tick))


def takes_inbox(before: int, after: int, leap_ticks: int) -> bool:
    """Whether a step from one tick to another has taken its frames: from none, or forward in the count."""
    return after != before and (before < 0 or near(before, after, leap_ticks))


def _done(state: FlightState, tick: int) -> Frame:
    return TickDone(tick, checksum(state)).encode()


def _skip_ticks(state: FlightState, tick: int, config: FlightConfig) -> None:
    """At the first tick of a count every timer starts in full; skipped ticks stop the timers.

    What the coils drove in skipped ticks is not known.
    """
    timing = config.coils.pulses
    if state.tick < 0:
        state.pulses = pulses.boot(tick, timing)
        state.field_tick = state.status_tick = state.time_tick = tick
    elif state.tick < tick - 1:
        pulses.delay(state.pulses, tick, tick - state.tick - 1)
        state.coil.past_am2, state.coil.idle_ticks = (), 0


def _compare_time(state: FlightState, unix_time_s: int, config: FlightConfig) -> None:
    """Compare the time of the SYNC with that of the table, by which field, Sun and orbit are computed."""
    state.time_error_s = unix_time_s - (config.epoch_unix_s + state.tick // config.tick_hz)
    if abs(state.time_error_s) <= MOST_TIME_ERROR_S:
        state.time_tick = state.tick


def _gate(state: FlightState, tick: int, frames: tuple[Frame, ...], config: FlightConfig) -> Measurements:
    """Accept what the boards sent, and compare the coil driver's currents with the requests."""
    readings = admit(frames, state.gate, skipped=0 <= state.tick < tick - 1)
    measurements = calibration.measure(readings, config.calibration)
    read_back.remove_offset(measurements, state.coil, tick, config.read_back)
    view = state.coil
    update_view(view, measurements, tick, config.coils)
    own_field.subtract_own_field(view, measurements, config.estimator.blank_ticks, config.own_field)
    state.tick, state.syncs.strange_tick = tick, -1
    if measurements.field is not None:
        state.field_tick = tick
    if measurements.coil is not None:
        state.status_tick = tick
    pulsed = config.coils.dipoles is None
    watch_senders(state.second_sender, measurements, view.seq, pulsed, tick, config.second_sender)
    if state.wheel is not None and config.wheel is not None:
        wheel.update_view(state.wheel, measurements, tick, config.wheel)
    fdir.judge_current(state.health, view, measurements, tick, config.fdir)
    return measurements


def _predict(
    state: FlightState, model: EphemerisModel, before: int, motion: WheelMotion | None, config: FlightConfig
) -> Reference | None:
    """Carry ephemeris and estimate to this tick; the reference is None where the orbit has no position."""
    tick = state.tick
    state.ephemeris = advance(state.ephemeris, tick, model)
    reference = None if state.ephemeris is None else reference_at(state.ephemeris, tick, config.ephemeris)
    if reference is None or not plausible(reference):  # nothing carries the estimate on, so it ends
        state.ephemeris = None
        discard_estimate(state.estimator)
        fdir.discard_proof(state.health)
        return None
    if state.estimator.estimate is not None or state.estimator.batch.samples:
        driven_am2 = fdir.driven_am2(state.health, state.coil, config.fdir)
        ticks, reported = range(before + 1, tick + 1), state.status_tick == tick
        drives = find_drives(state.coil, driven_am2, reported, ticks, config.coils)
        predict(state.estimator, reference, drives, config.estimator, motion)
    return reference


def _update(
    state: FlightState,
    measurements: Measurements,
    reference: Reference | None,
    wheel_nms: Vec3,
    config: FlightConfig,
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
    turn_rad = _field_turn_rad(state.sample, usable_field(measurements), state.tick)
    used = update(state.estimator, measurements, reference, config.estimator, wheel_nms, turn_rad)
    limits = config.estimator
    attitude = orbital_attitude(
        state.estimator.estimate,
        reference,
        limits.valid_sigma_rad,
        limits.usable_sigma_rad,
        limits.fastest_valid_radps,
        state.attitude.valid,
    )
    return Observation(measurements, reference, state.estimator, attitude, used, findings)


def _field_turn_rad(before: FieldSample, b_body_t: Vec3 | None, tick: int) -> float:
    """By how much the measured field has turned in the body in one tick; 0 without a sample of each."""
    if b_body_t is None or before.tick != tick - 1:
        return 0.0
    return atan2(norm(cross(before.b_body_t, b_body_t)), dot(before.b_body_t, b_body_t))


def _judge(state: FlightState, observation: Observation, wheel_nms: Vec3, config: FlightConfig) -> None:
    """Judge sensors and coils by all samples, those of isolated sensors included."""
    state.attitude = observation.attitude
    reference, findings, tick = observation.reference, observation.findings, state.tick
    if reference is not None and findings is not None:
        settled = state.syncs.settled(tick) and state.time_tick == tick
        evidence = Evidence(tick, findings, state.coil, reference, observation.used, settled, wheel_nms)
        state.attitude = fdir.judge(state.health, state.estimator, state.attitude, evidence, config.fdir)


def _law_input(
    state: FlightState, observation: Observation, model: EphemerisModel, config: FlightConfig
) -> LawInput:
    """The field is the modelled one where the attitude is usable, otherwise the last one measured."""
    measurements, reference, attitude = observation.measurements, observation.reference, state.attitude
    usable = usable_field(measurements)
    sample = FieldSample(usable, state.tick) if usable is not None else state.sample
    b_body_t = sample.b_body_t
    if attitude.usable and reference is not None:
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
        constant_torque(parameters, reference, config.control.axes),
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
) -> list[CoilFire | CoilDipole | WheelTorque]:
    """At most one request to the coil driver, and one to the wheel."""
    faults, b_body_t = state.health.coils.faults, law_input.b_body_t
    request = actuate(
        state.pulses, state.coil, demand, b_body_t, measurements, state.tick, config.coils, faults
    )
    state.sample, state.memory = law_input.sample, demand.memory if demand is not None else ()
    requests: list[CoilFire | CoilDipole | WheelTorque] = []
    if request is not None:
        requests.append(calibration.for_outputs(request, config.calibration))
    if state.wheel is not None and config.wheel is not None:
        torque = wheel.request(state.wheel, demand, state.tick, config.wheel)
        if torque is not None:
            requests.append(torque)
    return requests
