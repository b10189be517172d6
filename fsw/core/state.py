"""The whole flight state, what goes into a step and what comes out, and the state's checksum."""

import struct
import zlib
from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseState
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.fdir.coil_health import CoilHealth
from fsw.core.fdir.sensor_health import SensorHealth
from fsw.core.gate.readings import GateState
from fsw.core.gate.second_sender import NOBODY, SecondSender
from fsw.core.gate.sync_watch import SyncWatch
from fsw.core.laws.interface import FieldSample, Memory, Setpoint
from fsw.core.laws.table import LAWS
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.orbit.ephemeris import EphemerisWindow, pack_values
from fsw.core.throttle import Throttle
from fsw.wire.frame import Frame


class Inbox(NamedTuple):
    """A SYNC's tick and time, and what came since the last one that took what had come."""

    tick: int
    unix_time_s: int
    frames: tuple[Frame, ...]


class FlightState(NamedTuple):
    """Everything that fsw carries from one tick to the next.

    ``tick`` is -1 before the first SYNC; ``ignored_syncs`` counts those that were not answered, and ``syncs``
    tells which are in doubt; ``field_tick`` and ``status_tick`` are the last ticks with an
    intact MAG_FIELD and COIL_STATUS, ``time_error_s`` the last SYNC's time less the expected; ``setpoint``
    and ``memory`` are the control law's; ``orbit`` and ``upload`` are elements from the ground, those flown
    (None: the table's orbit) and those kept aside; ``sent`` are the counters of the messages that fsw sends.
    """

    tick: int
    field_tick: int
    status_tick: int
    ignored_syncs: int
    syncs: SyncWatch
    time_error_s: int
    gate: GateState
    second_sender: SecondSender
    orbit: Elements | None
    upload: Upload
    ephemeris: EphemerisWindow | None
    estimator: EstimatorState
    sensors: SensorHealth
    coils: CoilHealth
    attitude: Attitude
    modes: ModeState
    sample: FieldSample
    setpoint: Setpoint
    memory: Memory
    pulses: PulseState
    coil: CoilView
    events: Throttle
    sent: tuple[int, ...]


def checksum(state: FlightState) -> int:
    """CRC-32 over every number of the state, little-endian: integers as 64 bit, floats as doubles."""
    gate, modes, coil, pulses, attitude = state.gate, state.modes, state.coil, state.pulses, state.attitude
    field_watch, sun_watch, pair, doubted = state.sensors
    faults, wrong, *strange = state.coils
    known, *refusals = state.estimator
    integers = (
        state.tick,
        state.field_tick,
        state.status_tick,
        state.ignored_syncs,
        *state.syncs.doubted,
        *state.syncs[1:],
        state.time_error_s,
        *gate.counters,
        *gate[1:],
        *state.second_sender,
        state.upload.come,
        state.orbit is not None,
        *refusals,
        *field_watch[:-1],
        *sun_watch[:-1],
        *pair,
        doubted,
        *faults,
        *wrong,
        *strange,
        attitude.valid,
        modes.mode,
        modes.since_tick,
        *modes.held_since,
        modes.trips,
        modes.held,
        state.sample.tick,
        LAWS[state.setpoint.law].number,
        *pulses.ready_tick,
        pulses.busy_until,
        *coil.lockout_ms,
        coil.driven_coil,
        coil.driven_level,
        coil.seq,
        coil.refusals,
        coil.fired_tick,
        *coil.fired,
        *(number for told in state.events.told for number in told),
        state.events.held_back,
        *state.sent,
    )
    floats: tuple[float, ...] = (
        *attitude.q_body_from_orbit,
        *attitude.omega_body_orbit_radps,
        attitude.sigma3_attitude_rad,
        attitude.sigma3_rate_radps,
        *field_watch.sample,
        *sun_watch.sample,
        *state.sample.b_body_t,
        *pulses.owed_impulse_body_nms,
        *pulses.held_am2,
        *coil.driven_am2,
        *coil.paid_body_nms,
        *state.setpoint[1:],
        *state.memory,
        *state.upload.values,
        *(state.orbit or ()),
    )
    if state.ephemeris is not None:
        floats += pack_values(state.ephemeris)
    if known is not None:
        floats += (*known.q_body_from_eci, *known.omega_body_radps, *known.mag_bias_t, *known.torque_body_nm)
    register = zlib.crc32(struct.pack(f"<{len(integers)}q{len(floats)}d", *integers, *floats))
    if known is None:
        return register
    register = zlib.crc32(known.covariance.tobytes(), register)
    if known.trace is None:
        return register
    causes, effect, sums, count = known.trace
    register = zlib.crc32(struct.pack(f"<{1 + len(causes)}q", count, *causes), register)
    return zlib.crc32(sums.tobytes(), zlib.crc32(effect.tobytes(), register))


def initial_state(pulses: PulseState, setpoint: Setpoint, sent: tuple[int, ...]) -> FlightState:
    """The state at boot, before the first SYNC."""
    return FlightState(
        tick=-1,
        field_tick=-1,
        status_tick=-1,
        ignored_syncs=0,
        syncs=SyncWatch(),
        time_error_s=0,
        gate=GateState(),
        second_sender=NOBODY,
        orbit=None,
        upload=Upload(),
        ephemeris=None,
        estimator=EstimatorState(),
        sensors=SensorHealth(),
        coils=CoilHealth(),
        attitude=UNKNOWN,
        modes=ModeState(),
        sample=FieldSample(),
        setpoint=setpoint,
        memory=(),
        pulses=pulses,
        coil=CoilView(),
        events=Throttle(),
        sent=sent,
    )
