"""What speaks against a sample by itself: checks that need no attitude, and no history but its repeats.

Only a quantised reading repeats itself while all is well: ``standstill`` says for how long, by the estimate.

Every limit is what the bounds of the table and the noise at the edge of the filter's gate allow in this tick.
"""

from collections.abc import Callable, Sequence
from math import acos
from typing import NamedTuple

from fsw.core.algebra.vector import ZERO, Vec3, dot, norm
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.samples import coils_idle, sensed_sun, usable_cells, usable_field
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.faults import Sensor, SensorFault
from fsw.core.fdir.sensors.standstill import NO_MOTION, Motion, Steps, frozen, moved_on
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import Reference
from fsw.core.orbit.sun import lit

SHADOW_M = RADIUS_M - 100e3
"""Radius of what is certainly shadow: the Earth is flattened by 21 km, half the penumbra of a low orbit is
15 km wide, and the position may be off by tens of km."""
DARK: Vec3 = (0.0, 0.0, 0.0)
"""The sample of a Sun sensor without a Sun."""
MOST_LAMPS, MOST_BEYOND = 2, 1
"""Sun cells that may be broken at once: those lit in the shadow, those brighter than anything can make them.

What speaks against more of them in one tick speaks against the board that reads them.
"""


class PlausibilityConfig(NamedTuple):
    """Largest deviations if all is well: of the field, T and as a fraction of it, and of directions, rad.

    ``in_range_t``: in a field up to that strength no axis of the magnetometer saturates; ``sun_norm``: of the
    Sun vector's length; ``late_ticks``: how long a sample may be repeated; ``cells``: those that give the Sun
    in place of a sensor; ``steps``: of the readings, None if both are continuous.
    """

    field_t: float
    field_part: float
    in_range_t: float
    angle_rad: float
    sun_norm: float
    late_ticks: int
    cells: CellSet | None = None
    steps: Steps | None = None


class Memory(NamedTuple):
    """The last samples as they were sent, and for how many ticks each has been repeated.

    ``motion``: what field and Sun have moved by meanwhile, None if both readings are continuous.
    """

    field: Vec3 = ZERO
    sun: Vec3 = ZERO
    field_still: int = 0
    sun_still: int = 0
    motion: Motion | None = None


class Seen(NamedTuple):
    """What the checks look at in one tick: all that the boards sent, and what the models expect.

    ``lamps``: how many Sun cells in use are lit in the shadow; ``beyond``: how many show what no light does.
    """

    measurements: Measurements
    field: Vec3 | None
    sun: Vec3 | None
    modelled_t: float
    shadow: bool
    field_still: bool
    sun_still: bool
    limits: PlausibilityConfig
    lamps: int = 0
    beyond: int = 0


CHECKS: tuple[tuple[Sensor, SensorFault, Callable[[Seen], bool]], ...] = (
    (Sensor.MAGNETOMETER, SensorFault.SILENT, lambda s: s.measurements.field is None),
    (
        Sensor.MAGNETOMETER,
        SensorFault.SATURATED,
        lambda s: (
            s.measurements.field is not None
            and not s.measurements.field.valid
            and coils_idle(s.measurements)
            and not (s.measurements.saturated and s.modelled_t > s.limits.in_range_t)
        ),
    ),
    (Sensor.MAGNETOMETER, SensorFault.FROZEN, lambda s: s.field_still and not s.sun_still),
    (
        Sensor.MAGNETOMETER,
        SensorFault.STRENGTH,
        lambda s: (
            s.field is not None
            and not abs(norm(s.field) - s.modelled_t) <= s.limits.field_t + s.limits.field_part * s.modelled_t
        ),
    ),
    (
        Sensor.SUN_SENSOR,
        SensorFault.SILENT,
        lambda s: s.measurements.sun is None and s.measurements.cells is None,
    ),
    (
        Sensor.SUN_SENSOR,
        SensorFault.UNLIT,
        lambda s: s.shadow and (s.sun is not None or s.lamps > MOST_LAMPS),
    ),
    (
        Sensor.SUN_SENSOR,
        SensorFault.STRENGTH,
        lambda s: (
            s.beyond > MOST_BEYOND or (s.sun is not None and not abs(norm(s.sun) - 1.0) <= s.limits.sun_norm)
        ),
    ),
    (Sensor.SUN_SENSOR, SensorFault.FROZEN, lambda s: s.sun_still and not s.field_still),
)


class Findings(NamedTuple):
    """What the samples of a tick show by themselves.

    ``field_cause`` and ``sun_cause``: what speaks against each, 0 if nothing does; ``field`` and ``sun``: the
    samples that could be used if nothing did; ``pair``: both can be compared, ``apart``: by an angle that is
    not the modelled one. ``currents`` are those of Sun cells, None where they show nothing about their cell,
    and ``shadow`` says if none can see the Sun.
    """

    field_cause: int
    sun_cause: int
    field: Vec3 | None
    sun: Vec3 | None
    pair: bool
    apart: bool
    memory: Memory
    currents: tuple[float | None, ...] = ()
    shadow: bool = False


def examine(
    memory: Memory,
    measurements: Measurements,
    reference: Reference,
    limits: PlausibilityConfig,
    estimate: Estimate | None = None,
    isolated: Sequence[int] = (),
) -> Findings:
    """Apply the checks to the samples of this tick.

    Args:
        memory: of the tick before.
        measurements: all that the boards sent, of isolated sensors too.
        reference: field and Sun as modelled.
        limits: largest deviations if all is well.
        estimate: predicted to this tick, if it is valid; only quantised readings are judged by it.
        isolated: Sun cells of which it is known that they are faulty.
    """
    memory, late = _remember(memory, measurements), limits.late_ticks
    field_still, sun_still = still = memory.field_still > late, memory.sun_still > late
    if limits.steps is not None:
        motion = moved_on(memory.motion or NO_MOTION, still, estimate, reference, limits.steps)
        memory, (field_still, sun_still) = memory._replace(motion=motion), frozen(motion, still, limits.steps)
    field, sun = usable_field(measurements), sensed_sun(measurements, limits.cells)
    currents = usable_cells(measurements, limits.cells)
    shadow = (sun is not None or bool(currents)) and _in_shadow(reference)
    lamps, beyond = NOWHERE if limits.cells is None else _wrong(currents, shadow, isolated, limits.cells)
    modelled_t, still = norm(reference.b_eci_t), (field_still, sun_still)
    seen = Seen(measurements, field, sun, modelled_t, shadow, *still, limits, len(lamps), len(beyond))
    causes = {Sensor.MAGNETOMETER: 0, Sensor.SUN_SENSOR: 0}
    for sensor, cause, speaks_against in CHECKS:
        if not causes[sensor] and speaks_against(seen):
            causes[sensor] = int(cause)
    b_cause, s_cause = causes[Sensor.MAGNETOMETER], causes[Sensor.SUN_SENSOR]
    pair = field is not None and sun is not None and not (b_cause or s_cause)
    apart = pair and _apart(seen, reference)
    if limits.cells is None:
        return Findings(b_cause, s_cause, field, sun, pair, apart, memory)
    if len(lamps) > MOST_LAMPS or len(beyond) > MOST_BEYOND:
        currents = (None,) * len(currents)
    elif beyond:  # a message with an impossible current in it shows nothing about the other cells
        currents = tuple([current if cell in beyond else None for cell, current in enumerate(currents)])
    return Findings(b_cause, s_cause, field, sun, pair, apart, memory, currents, shadow)


Wrong = tuple[tuple[int, ...], tuple[int, ...]]
"""Cells lit in the shadow, and cells that are brighter than anything can make them."""
NOWHERE: Wrong = ((), ())


def _wrong(currents: Sequence[float | None], shadow: bool, isolated: Sequence[int], cells: CellSet) -> Wrong:
    """The cells in use that are wrong by themselves: without an attitude, and whatever the table allows."""
    used = [
        (cell, current)
        for cell, current in enumerate(currents)
        if current is not None and cell not in isolated
    ]
    most = 1.0 + cells.albedo + SIGMAS * cells.model_sigma
    lamps = tuple([cell for cell, current in used if shadow and current > cells.dark])
    return lamps, tuple([cell for cell, current in used if current > most])


def _remember(memory: Memory, measurements: Measurements) -> Memory:
    field, sun, field_still, sun_still, motion = memory
    if measurements.field is not None:
        sample = measurements.field.b_body_nt
        field, field_still = sample, field_still + 1 if sample == field else 0
    if measurements.sun is not None:
        sample = measurements.sun.s_body if measurements.sun.valid else DARK
        sun, sun_still = sample, sun_still + 1 if sample == sun and sample is not DARK else 0
    return Memory(field, sun, field_still, sun_still, motion)


def _in_shadow(reference: Reference) -> bool:
    """Whether the satellite is certainly in shadow, beyond all errors of the model."""
    return not (reference.lit or lit(reference.r_eci_m, reference.sun_eci, SHADOW_M))


def _apart(seen: Seen, reference: Reference) -> bool:
    """Whether field and Sun are not at the modelled angle; errors of the field turn a weak one most."""
    field, sun, limits = seen.field, seen.sun, seen.limits
    if field is None or sun is None or not norm(field) * norm(sun) > 0.0:
        return False
    measured = dot(field, sun) / (norm(field) * norm(sun))
    expected = dot(reference.b_eci_t, reference.sun_eci) / seen.modelled_t
    limit_rad = limits.angle_rad + limits.field_t / seen.modelled_t
    return not abs(_angle(measured) - _angle(expected)) <= limit_rad


def _angle(cosine: float) -> float:
    return acos(max(-1.0, min(1.0, cosine)))
