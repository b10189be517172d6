"""What the boards sent in one tick, in SI units and body axes, those of the coil driver by coil axis."""

from typing import Final, final

from fsw.core.algebra.vector import Vec3, scale
from fsw.core.gate.readings import Telecommand
from fsw.wire.value import Value

TESLA_PER_NT: Final = 1e-9


@final
class FieldReading(Value):
    """A sample of the magnetometer; not ``valid``: an axis is saturated, or the self-test failed."""

    FIELDS = ("valid", "b_body_nt")
    __slots__ = (*FIELDS, "b_body_t")

    def __init__(self, valid: bool, b_body_nt: Vec3) -> None:
        self.valid = valid
        self.b_body_nt = b_body_nt
        self.b_body_t = scale(TESLA_PER_NT, b_body_nt)


@final
class SunReading(Value):
    """A Sun direction, as long as the sensor gives it; not ``valid``: there is none."""

    FIELDS = ("valid", "s_body")
    __slots__ = FIELDS

    def __init__(self, valid: bool, s_body: Vec3) -> None:
        self.valid = valid
        self.s_body = s_body


@final
class CellReading(Value):
    """Currents of the Sun cells, in parts of the nominal one in full sunlight; not ``valid``: of none."""

    FIELDS = ("valid", "currents")
    __slots__ = FIELDS

    def __init__(self, valid: bool, currents: tuple[float, ...]) -> None:
        self.valid = valid
        self.currents = currents


@final
class CoilReport(Value):
    """What the coil driver reports of one coil: level and current, signed by the coil's axis."""

    FIELDS = ("level", "coil", "remaining_ms", "current_ma", "lockout_ms", "seq")
    __slots__ = FIELDS

    def __init__(
        self, level: int, coil: int, remaining_ms: int, current_ma: int, lockout_ms: int, seq: int
    ) -> None:
        self.level = level
        self.coil = coil
        self.remaining_ms = remaining_ms
        self.current_ma = current_ma
        self.lockout_ms = lockout_ms
        self.seq = seq


@final
class Refusal(Value):
    """A request that the coil driver refused: ``tick`` is the low 8 bits of that in which it came."""

    FIELDS = ("coil", "seq", "reason", "tick")
    __slots__ = FIELDS

    def __init__(self, coil: int, seq: int, reason: int, tick: int) -> None:
        self.coil = coil
        self.seq = seq
        self.reason = reason
        self.tick = tick


@final
class WheelReading(Value):
    """The speed of the wheel about its axis, relative to the body; not ``valid``: it cannot be measured."""

    FIELDS = ("valid", "speed_radps")
    __slots__ = FIELDS

    def __init__(self, valid: bool, speed_radps: float) -> None:
        self.valid = valid
        self.speed_radps = speed_radps


@final
class ReferenceReading(Value):
    """The true attitude, the vector part of ``q_body_from_orbit``, or the true rate relative to the orbit."""

    FIELDS = ("valid", "vector")
    __slots__ = FIELDS

    def __init__(self, valid: bool, vector: Vec3) -> None:
        self.valid = valid
        self.vector = vector


@final
class Measurements:
    """The last accepted message of each kind in this tick, None where there was none: filled by the gate.

    ``dipole``: what a continuous driver drove, as fractions of full scale. ``coil_booted``: the coil driver
    has started in this tick. ``end_ticks``: those flown by a PLANT_END after which the flight has gone on, -1
    without one. Refusals and telecommands are all taken, in order of reception; ``repeated`` are telecommands
    with the counter of the one before. ``under_own_id`` is the lowest identifier of fsw itself under which an
    intact frame came, 0 if none did.

    ``saturated``: for each axis of the magnetometer that is at the end of its range, the direction of
    ``field``, body axes, that follows from its reading. ``quiet``: no coil has been driven for as long as a
    field sample may be old. ``settled``: what the coils add to the field sample is known, and has been
    subtracted.

    What the filter may use: ``field_trusted``, ``sun_trusted`` for the Sun by sensor or cells, and of the
    cells those that are not among the ``unusable_cells``.
    """

    field: FieldReading | None = None
    sun: SunReading | None = None
    coil: CoilReport | None = None
    refused: tuple[Refusal, ...] = ()
    ref_attitude: ReferenceReading | None = None
    ref_rate: ReferenceReading | None = None
    dipole: Vec3 | None = None
    coil_booted: bool = False
    end_ticks: int = -1
    cells: CellReading | None = None
    wheel: WheelReading | None = None
    telecommands: tuple[Telecommand, ...] = ()
    repeated: tuple[Telecommand, ...] = ()
    under_own_id: int = 0
    saturated: tuple[Vec3, ...] = ()
    quiet: bool = True
    settled: bool = False
    field_trusted: bool = True
    sun_trusted: bool = True
    unusable_cells: tuple[int, ...] = ()
