"""The whole flight state, and what goes into a step."""

from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseState
from fsw.core.actuation.wheel import WheelView
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.events import Throttle
from fsw.core.fdir.fdir import Health
from fsw.core.gate.readings import GateState
from fsw.core.gate.second_sender import NO_SIGNS, SecondSenderWatch
from fsw.core.gate.sync_watch import SyncWatch
from fsw.core.laws.interface import FieldSample, Memory, Setpoint
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.orbit.ephemeris import EphemerisWindow
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
