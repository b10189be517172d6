"""What the frames of a bus have shown so far: attitude, coils, sensors, modes, events, load of the bus.

Time is that of the satellite, by SYNC; only the load of the bus goes by the time at which frames came.
"""

from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from math import acos, degrees, sqrt

from fsw.core.algebra.quaternion import IDENTITY, Quaternion, multiply, rotate
from fsw.core.algebra.vector import Vec3, norm
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    CoilBoot,
    CoilDipoleStatus,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    FswBoot,
    MagBoot,
    MagField,
    Mode,
    NavAttitude,
    NavQuality,
    NavRate,
    PlantBoot,
    PlantEnd,
    SunBoot,
    SunVector,
    Sync,
    WheelBoot,
    intact,
)
from sim.bench.bus_load import BITRATE
from sim.watch.coil_torque import CoilTorque, Craft, coil_torque
from sim.watch.directions import Around, AroundAt, arrows, nothing_around, off_deg
from sim.watch.happening import Occurrence, Weight, event_words

# --- The load of the bus, by the time at which its frames came

WINDOW_S = 2.0
"""Time over which frames are counted."""


def most_bits(length: int) -> int:
    """Bits of a classic frame with an 11-bit identifier and so many data bytes, with the most stuff bits.

    8 n + 47 + floor((34 + 8 n - 1) / 4). Source: Davis, Burns, Bril, Lukkien 2007, Controller Area Network
    schedulability analysis (Real-Time Systems 35), eq. 1.
    """
    return 8 * length + 47 + (33 + 8 * length) // 4


@dataclass(slots=True)
class Load:
    """Frames and bits of the last seconds."""

    _recent: deque[tuple[float, int]] = field(default_factory=deque)
    _bits: int = 0

    def take(self, frame: Frame, now_s: float) -> None:
        """Count one frame; where time goes back, as from one flight to the next in a log, from it on."""
        if self._recent and now_s < self._recent[-1][0] - WINDOW_S:
            self._recent.clear()
            self._bits = 0
        bits = most_bits(len(frame.data))
        self._recent.append((now_s, bits))
        self._bits += bits
        self.pass_time(now_s)

    def pass_time(self, now_s: float) -> None:
        """Forget what is older than the window."""
        while self._recent and self._recent[0][0] < now_s - WINDOW_S:
            self._bits -= self._recent.popleft()[1]

    @property
    def frames_per_s(self) -> float:
        """Over the last seconds."""
        return len(self._recent) / WINDOW_S

    @property
    def part(self) -> float:
        """At most so much of ``BITRATE``; above 1 where frames came faster than such a bus carries them."""
        return self._bits / WINDOW_S / BITRATE


MOST_HAPPENINGS, MOST_SAMPLES = 500, 3600
"""What is kept: happenings, and samples of the time series, one for each second of the satellite."""
MOST_UNKNOWN = 64
"""Identifiers that are no message's and whose frames are counted each by itself."""


@dataclass(frozen=True, slots=True)
class SecondSample:
    """One second of the flight, for the time series; None where nothing is known.

    ``turn_deg``: angle of the estimated attitude from nominal, or from the orbit axes where the satellite is
    not known; ``sigma3_deg``: three standard deviations of it; ``rate_degps``: of the body against the orbit;
    ``field_off_deg``, ``sun_off_deg``: angle between what a sensor measures and what the estimate predicts,
    if the orbit is known.
    """

    unix_s: int
    turn_deg: float | None
    sigma3_deg: float | None
    rate_degps: float | None
    field_off_deg: float | None
    sun_off_deg: float | None


@dataclass(slots=True)
class CoilsReported:
    """The coils as their board reports them, levels of the pulse under way, current, time locked out."""

    levels: list[int] = field(default_factory=lambda: [0, 0, 0])
    current_ma: int = 0
    remaining_ms: int = 0
    lockout_ms: list[int | None] = field(default_factory=lambda: [None, None, None])
    fractions: Vec3 | None = None
    """Of the full dipole, where the driver is a continuous one."""
    pulses: int = 0
    refused: int = 0


class FlightView:
    """What has been seen so far.

    Args:
        around_at: of a tick of the satellite; None where the orbit is not known.
        craft: of the satellite; None where it is not known.
    """

    def __init__(self, around_at: AroundAt = nothing_around, craft: Craft | None = None) -> None:
        self.tick: int | None = None
        self.unix_s: int | None = None
        self.mode: Mode | None = None
        self.quality: NavQuality | None = None
        self.attitude: Quaternion | None = None
        """q_body_from_orbit, while it is valid."""
        self.omega_body_orbit_radps: Vec3 | None = None
        self.field: MagField | None = None
        self.sun: SunVector | None = None
        self.around: Around | None = None
        self.coils = CoilsReported()
        self.samples: deque[SecondSample] = deque(maxlen=MOST_SAMPLES)
        self.sampled = 0
        self.happenings: deque[Occurrence] = deque(maxlen=MOST_HAPPENINGS)
        self.happened = 0
        """As ``sampled``: how many so far, those that are kept no longer included."""
        self.ended = False
        self.frames: Counter[int] = Counter()
        self.other_frames = 0
        """Of identifiers that are unknown and are not in ``frames``."""
        self.broken = 0
        """Frames of a known identifier with a wrong length or CRC."""
        self.load = Load()
        self.around_at = around_at
        self.craft = craft
        self.last_pulse: CoilTorque | None = None
        """Of the last pulse that was driven, also when it is over."""
        self._calm_b_t: Vec3 | None = None  # the last reading while no coil was driven
        self._unknown = 0  # identifiers in ``frames``
        self._driven = False  # a coil, in this tick or in the one before
        self._pulse: tuple[int, int] | None = None  # coil and number of the one that is under way
        self._takes: dict[int, Callable[[bytes], None]] = {
            Sync.ID: self._take_sync,
            CoilStatus.ID: self._take_coil,
            CoilDipoleStatus.ID: self._take_dipole,
            CoilRefused.ID: self._take_refusal,
            MagField.ID: self._take_field,
            SunVector.ID: self._take_sun,
            NavAttitude.ID: self._take_attitude,
            NavRate.ID: self._take_rate,
            NavQuality.ID: self._take_quality,
            PlantEnd.ID: self._take_end,
        }

    def take(self, frame: Frame, now_s: float) -> None:
        """Take one frame that came at ``now_s``."""
        can_id, data = frame.can_id, frame.data
        self._count(can_id)
        self.load.take(frame, now_s)
        if can_id not in NAMES:
            return
        if not intact(frame):
            self.broken += 1
            return
        take = self._takes.get(can_id)
        if take is not None:
            take(data)
        elif NAMES[can_id].endswith("_EVENT"):
            values = CLASSES[can_id].decode(data).by_name()
            self._happens(*event_words(can_id, values["severity"], values["event"], values["argument"]))
        elif can_id in _BOOTS:
            self._happens(Weight.INFO, f"{SENDERS[can_id].lower()}: started")

    def _count(self, can_id: int) -> None:
        """Count a frame by its identifier, in constant memory."""
        if can_id not in NAMES and can_id not in self.frames:
            if self._unknown == MOST_UNKNOWN:
                self.other_frames += 1
                return
            self._unknown += 1
        self.frames[can_id] += 1

    def _take_sync(self, data: bytes) -> None:
        """The tick begins: what came in the one before is whole."""
        sync = Sync.decode(data)
        if self.unix_s is not None and sync.unix_time_s != self.unix_s:
            self.samples.append(self._sample(self.unix_s))
            self.sampled += 1
        if self.tick is not None and sync.tick < self.tick:
            self._happens(Weight.WARNING, f"the count of ticks went back from {self.tick} to {sync.tick}")
            self.samples.clear()
            self.ended = False
        self.tick, self.unix_s = sync.tick, sync.unix_time_s
        self.around = self.around_at(sync.tick)

    def _take_coil(self, data: bytes) -> None:
        status, coils = CoilStatus.decode(data), self.coils
        if status.coil > 2:
            return
        pulse = (status.coil, status.seq) if status.level else None
        if pulse is not None and pulse != self._pulse:
            coils.pulses += 1
            words = f"coil {status.coil} driven at level {status.level:+d}, {status.current_ma} mA"
            self._happens(Weight.PULSE, words)
        self._pulse = pulse
        self._driven = bool(status.level or any(coils.levels))
        coils.levels = [status.level if coil == status.coil else 0 for coil in range(3)]
        coils.current_ma, coils.remaining_ms = status.current_ma, status.remaining_ms
        coils.lockout_ms[status.coil] = status.lockout_ms
        self.last_pulse = self.coil_torque() or self.last_pulse

    def _take_dipole(self, data: bytes) -> None:
        dipole = CoilDipoleStatus.decode(data)
        self.coils.fractions = (dipole.m_x, dipole.m_y, dipole.m_z)
        self._driven = any(self.coils.fractions)

    def _take_refusal(self, data: bytes) -> None:
        refusal = CoilRefused.decode(data)
        self.coils.refused += 1
        why = _REASONS.get(refusal.reason, f"reason {refusal.reason}")
        self._happens(Weight.WARNING, f"coil: refused a pulse of coil {refusal.coil}: {why}")

    def _take_field(self, data: bytes) -> None:
        self.field = MagField.decode(data)
        if self.field.valid and not self._driven:
            self._calm_b_t = self.field_body_t()

    def _take_sun(self, data: bytes) -> None:
        self.sun = SunVector.decode(data)

    def _take_attitude(self, data: bytes) -> None:
        nav = NavAttitude.decode(data)
        square = nav.q_x**2 + nav.q_y**2 + nav.q_z**2
        q = (sqrt(max(0.0, 1.0 - square)), nav.q_x, nav.q_y, nav.q_z)
        self.attitude = q if nav.valid else None

    def _take_rate(self, data: bytes) -> None:
        nav = NavRate.decode(data)
        self.omega_body_orbit_radps = (nav.w_x, nav.w_y, nav.w_z)

    def _take_quality(self, data: bytes) -> None:
        self.quality = NavQuality.decode(data)
        self.mode = Mode(self.quality.mode) if self.quality.mode in Mode.__members__.values() else None

    def _take_end(self, data: bytes) -> None:
        self.ended = True
        self._happens(Weight.INFO, "the flight is over")

    def _happens(self, weight: Weight, words: str) -> None:
        self.happened += 1
        self.happenings.append(Occurrence(self.happened, self.tick, self.unix_s, weight, words))

    def field_off_deg(self) -> float | None:
        """Angle between the measured field and the predicted one, while no coil disturbs it."""
        if self.field is None or not self.field.valid or self._driven or self.around is None:
            return None
        measured = (self.field.b_x, self.field.b_y, self.field.b_z)
        return off_deg(self.attitude, measured, self.around.b_orbit_t)

    def sun_off_deg(self) -> float | None:
        """The same of the Sun, while it is seen."""
        if self.sun is None or not self.sun.valid or self.around is None:
            return None
        return off_deg(self.attitude, (self.sun.s_x, self.sun.s_y, self.sun.s_z), self.around.sun_orbit)

    def field_body_t(self) -> Vec3 | None:
        """The field as measured, T; None where it is not."""
        if self.field is None or not self.field.valid:
            return None
        return (1e-9 * self.field.b_x, 1e-9 * self.field.b_y, 1e-9 * self.field.b_z)

    def sun_body(self) -> Vec3 | None:
        """The direction to the Sun as measured; None where it is not seen."""
        if self.sun is None or not self.sun.valid:
            return None
        return (self.sun.s_x, self.sun.s_y, self.sun.s_z)

    def coil_torque(self) -> CoilTorque | None:
        """What the coils do; None while none is driven.

        In the field of the orbit where that is known, since a coil that is driven disturbs the magnetometer;
        else in the last one that was measured undisturbed.
        """
        b_body_t = self._calm_b_t
        if self.around is not None and self.attitude is not None:
            b_body_t = rotate(self.attitude, self.around.b_orbit_t)
        return coil_torque(self.coils.levels, self.coils.fractions, b_body_t, self.craft)

    def arrows(self) -> dict[str, Vec3]:
        """Directions by name, as of ``directions.arrows``."""
        driven = self.coil_torque()
        dipole, torque = (None, None) if driven is None else (driven.dipole, driven.torque)
        return arrows(self.attitude, self.field_body_t(), self.sun_body(), dipole, torque)

    def sample(self) -> SecondSample | None:
        """Of this moment; None before the first SYNC."""
        return None if self.unix_s is None else self._sample(self.unix_s)

    def _sample(self, unix_s: int) -> SecondSample:
        q, omega, quality = self.attitude, self.omega_body_orbit_radps, self.quality
        nominal = IDENTITY if self.craft is None else self.craft.q_law_from_body
        known = q is not None
        return SecondSample(
            unix_s,
            None if q is None else degrees(2.0 * acos(min(1.0, abs(multiply(q, nominal)[0])))),
            degrees(quality.sigma3_attitude) if quality is not None and known else None,
            degrees(norm(omega)) if omega is not None and known else None,
            self.field_off_deg(),
            self.sun_off_deg(),
        )


_REASONS = {reason.value: reason.name.lower().replace("_", " ") for reason in CoilRefusedReason}
_BOOTS = frozenset(boot.ID for boot in (PlantBoot, FswBoot, CoilBoot, MagBoot, SunBoot, WheelBoot))
