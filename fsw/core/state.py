"""The whole flight state, what goes into a step and what comes out, and the state's checksum."""

import struct
import zlib
from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseState
from fsw.core.actuation.wheel import WheelView
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.fdir.fdir import Health
from fsw.core.gate.readings import GateState
from fsw.core.gate.second_sender import NO_SIGNS, SecondSenderWatch
from fsw.core.gate.sync_watch import SyncWatch
from fsw.core.laws.interface import FieldSample, Memory, Setpoint
from fsw.core.laws.table import number_of
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.orbit.ephemeris import EphemerisWindow
from fsw.core.throttle import Throttle
from fsw.wire.frame import Frame


class Inbox(NamedTuple):
    """A SYNC's tick and time, and the frames since the last SYNC that took the inbox."""

    tick: int
    unix_time_s: int
    frames: tuple[Frame, ...]


class FlightState(NamedTuple):
    """Everything that fsw carries from one tick to the next.

    ``tick`` is -1 before the first SYNC; ``ignored_syncs`` counts the SYNCs that began no tick, and
    ``syncs`` holds those in doubt; ``field_tick`` and ``status_tick`` are the last ticks with an intact
    MAG_FIELD and COIL_STATUS, ``time_error_s`` the last SYNC's time less the expected; ``setpoint`` and
    ``memory`` are the control law's; ``orbit`` and ``upload`` are elements from the ground, those in use
    (None: the table's orbit) and those not loaded yet; ``sent`` are the counters of fsw's own messages;
    ``wheel`` is None without a wheel that can be driven; ``violated`` is the monitor that is, 0: none.
    """

    tick: int
    field_tick: int
    status_tick: int
    ignored_syncs: int
    syncs: SyncWatch
    time_error_s: int
    gate: GateState
    second_sender: SecondSenderWatch
    orbit: Elements | None
    upload: Upload
    ephemeris: EphemerisWindow | None
    estimator: EstimatorState
    health: Health
    attitude: Attitude
    modes: ModeState
    sample: FieldSample
    setpoint: Setpoint
    memory: Memory
    pulses: PulseState
    coil: CoilView
    events: Throttle
    sent: tuple[int, ...]
    wheel: WheelView | None = None
    violated: int = 0

    def integers(self) -> tuple[int, ...]:
        """Every integer and flag, in the order that recorded logs fix."""
        return (
            self.tick,
            self.field_tick,
            self.status_tick,
            self.ignored_syncs,
            *self.syncs.integers(),
            self.time_error_s,
            *self.gate.integers(),
            *self.second_sender,
            self.upload.received,
            self.orbit is not None,
            *self.estimator.integers(),
            *self.health.integers(),
            self.attitude.valid,
            *self.modes.integers(),
            self.sample.tick,
            number_of(self.setpoint.law),
            *self.pulses.integers(),
            *self.coil.integers(),
            *self.events.integers(),
            *self.sent,
            *(self.wheel.integers() if self.wheel is not None else ()),
            *((self.violated,) if self.violated else ()),
        )

    def floats(self) -> tuple[float, ...]:
        """Every float outside the estimator's arrays, in the order that recorded logs fix."""
        return (
            *self.attitude.floats(),
            *self.health.floats(),
            *self.sample.b_body_t,
            *self.pulses.floats(),
            *self.coil.floats(),
            *self.setpoint.floats(),
            *self.memory,
            *self.upload.values,
            *(self.orbit or ()),
            *(self.ephemeris.floats() if self.ephemeris is not None else ()),
            *self.estimator.floats(),
            *(self.wheel.floats() if self.wheel is not None else ()),
        )


def checksum(state: FlightState) -> int:
    """CRC-32 over every number of the state, as each part gives its own.

    Little-endian: all integers as 64 bit, all floats as doubles, then the arrays of the estimator.
    """
    integers, floats = state.integers(), state.floats()
    numbers = struct.pack(f"<{len(integers)}q{len(floats)}d", *integers, *floats)
    return zlib.crc32(state.estimator.packed(), zlib.crc32(numbers))


def initial_state(
    pulses: PulseState, setpoint: Setpoint, sent: tuple[int, ...], wheel: WheelView | None = None
) -> FlightState:
    """The state at boot, before the first SYNC."""
    return FlightState(
        tick=-1,
        field_tick=-1,
        status_tick=-1,
        ignored_syncs=0,
        syncs=SyncWatch(),
        time_error_s=0,
        gate=GateState(),
        second_sender=NO_SIGNS,
        orbit=None,
        upload=Upload(),
        ephemeris=None,
        estimator=EstimatorState(),
        health=Health(),
        attitude=UNKNOWN,
        modes=ModeState(),
        sample=FieldSample(),
        setpoint=setpoint,
        memory=(),
        pulses=pulses,
        coil=CoilView(),
        events=Throttle(),
        sent=sent,
        wheel=wheel,
    )
