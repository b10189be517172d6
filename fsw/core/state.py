"""The whole flight state, and what goes into a step."""

from dataclasses import dataclass, field
from typing import final

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import PulseState
from fsw.core.actuation.wheel import WheelView
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.events import Throttle
from fsw.core.fdir.fdir import Health
from fsw.core.gate.readings import GateState
from fsw.core.gate.second_sender import SecondSenderWatch
from fsw.core.gate.sync_watch import SyncWatch
from fsw.core.laws.interface import FieldSample, Memory, Setpoint
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.orbit.ephemeris import EphemerisWindow
from fsw.wire.frame import Frame
from fsw.wire.value import Value


@final
class Inbox(Value):
    """A SYNC's tick and time, and the frames since the last SYNC that took the inbox."""

    FIELDS = ("tick", "unix_time_s", "frames")
    __slots__ = FIELDS

    def __init__(self, tick: int, unix_time_s: int, frames: tuple[Frame, ...]) -> None:
        self.tick = tick
        self.unix_time_s = unix_time_s
        self.frames = frames


@final
@dataclass(slots=True)
class FlightState:
    """Everything that fsw carries from one tick to the next, updated in place.

    ``tick`` is -1 before the first SYNC; ``ignored_syncs`` counts the SYNCs that began no tick, and
    ``syncs`` holds those in doubt; ``field_tick`` and ``status_tick`` are the last ticks with an intact
    MAG_FIELD and COIL_STATUS, ``time_tick`` that whose SYNC last had the time of the table, ``time_error_s``
    the last SYNC's time less the expected; ``setpoint`` and
    ``memory`` are the control law's; ``orbit`` and ``upload`` are elements from the ground, those in use
    (None: the table's orbit) and those not loaded yet; ``sent`` are the counters of fsw's own messages;
    ``wheel`` is None without a wheel that can be driven; ``violated`` is the monitor that is, 0: none.
    """

    pulses: PulseState
    setpoint: Setpoint
    sent: list[int]
    wheel: WheelView | None = None
    tick: int = -1
    field_tick: int = -1
    status_tick: int = -1
    time_tick: int = -1
    ignored_syncs: int = 0
    syncs: SyncWatch = field(default_factory=SyncWatch)
    time_error_s: int = 0
    gate: GateState = field(default_factory=GateState)
    second_sender: SecondSenderWatch = field(default_factory=SecondSenderWatch)
    orbit: Elements | None = None
    upload: Upload = field(default_factory=Upload)
    ephemeris: EphemerisWindow | None = None
    estimator: EstimatorState = field(default_factory=EstimatorState)
    health: Health = field(default_factory=Health)
    attitude: Attitude = UNKNOWN
    modes: ModeState = field(default_factory=ModeState)
    sample: FieldSample = field(default_factory=FieldSample)
    memory: Memory = ()
    coil: CoilView = field(default_factory=CoilView)
    events: Throttle = field(default_factory=Throttle)
    violated: int = 0
