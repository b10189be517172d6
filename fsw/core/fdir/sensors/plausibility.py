"""What speaks against a sample by itself: checks that need no attitude, and no history but its repeats.

Only a quantised reading repeats itself while all is well: ``standstill`` says for how long, by the estimate.

Every limit is what the bounds of the table and the noise at the edge of the filter's gate allow in this tick.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos
from typing import Final, final

from fsw.core.algebra.vector import ZERO, Vec3, dot, norm
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.samples import coils_idle, sensed_sun, usable_cells, usable_field
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.memory import Memory, remember
from fsw.core.fdir.sensors.standstill import ReadingMotion, Steps, is_frozen, update_motion
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import Reference
from fsw.core.orbit.sun import apparent_sun, lit

SHADOW_M: Final = RADIUS_M - 100e3
"""Radius of what is certainly shadow: the Earth is flattened by 21 km, half the penumbra of a low orbit is
15 km wide, and the position may be off by tens of km."""
MOST_LAMPS: Final = 2
MOST_IMPOSSIBLE: Final = 1
"""Sun cells that may be broken at once: those lit in the shadow, those brighter than anything can make them.

What speaks against more of them in one tick speaks against the board that reads them.
"""


@dataclass(frozen=True, slots=True)
class PlausibilityConfig:
    """Largest deviations if all is well: of the field, T and as a fraction of it, and of directions, rad.

    ``in_range_t``: in a field up to that strength no axis of the magnetometer saturates; ``sun_norm``: of the
    Sun vector's length; ``late_ticks``: how long a sample may be repeated; ``cells``: those that give the Sun
    in place of a sensor; ``steps``: of the measurements, None if both are continuous; ``most_albedo``: by
    which the Earth's light may turn the Sun's direction.
    """

    field_t: float
    field_part: float
    in_range_t: float
    angle_rad: float
    sun_norm: float
    late_ticks: int
    cells: CellSet | None = None
    steps: Steps | None = None
    most_albedo: float = 0.0


@final
class Findings:
    """What the samples of a tick show by themselves.

    ``field_cause`` and ``sun_cause``: what speaks against each, 0 if nothing does; ``field`` and ``sun``: the
    samples that could be used if nothing did; ``pair``: both can be compared, ``apart``: by an angle that is
    not the modelled one. ``currents`` are those of Sun cells, None where they show nothing about their cell,
    and ``shadow`` says if none can see the Sun.
    """

    __slots__ = ("apart", "currents", "field", "field_cause", "pair", "shadow", "sun", "sun_cause")

    def __init__(
        self,
        field_cause: int,
        sun_cause: int,
        field: Vec3 | None,
        sun: Vec3 | None,
        pair: bool,
        apart: bool,
        currents: tuple[float | None, ...] = (),
        shadow: bool = False,
    ) -> None:
        self.field_cause = field_cause
        self.sun_cause = sun_cause
        self.field = field
        self.sun = sun
        self.pair = pair
        self.apart = apart
        self.currents = currents
        self.shadow = shadow


def examine(
    memory: Memory,
    measurements: Measurements,
    reference: Reference,
    limits: PlausibilityConfig,
    estimate: Estimate | None = None,
    isolated: Sequence[int] = (),
) -> Findings:
    """Apply the checks to the samples of this tick, and remember them.

    Args:
        memory: of the tick before.
        measurements: all that the boards sent, of isolated sensors too.
        reference: field and Sun as modelled.
        limits: largest deviations if all is well.
        estimate: predicted to this tick, if it is valid; only quantised readings are judged by it.
        isolated: Sun cells of which it is known that they are faulty.
    """
    remember(memory, measurements)
    field_still, sun_still = memory.field_still > limits.late_ticks, memory.sun_still > limits.late_ticks
    steps = limits.steps
    if steps is not None:
        if memory.motion is None:
            memory.motion = ReadingMotion()
        update_motion(memory.motion, field_still, sun_still, estimate, reference, steps)
        field_still = is_frozen(memory.motion.of_field, field_still, steps.field_t)
        sun_still = is_frozen(memory.motion.of_sun, sun_still, steps.sun)
    field, sun = usable_field(measurements), sensed_sun(measurements, limits.cells)
    currents = usable_cells(measurements, limits.cells)
    shadow = (sun is not None or bool(currents)) and _is_in_shadow(reference)
    modelled_t = norm(reference.b_eci_t)
    lamps, impossible = _wrong_cells(currents, shadow, isolated, limits.cells)
    field_cause = _against_field(measurements, field, modelled_t, field_still and not sun_still, limits)
    sun_cause = _against_sun(
        measurements, sun, shadow, len(lamps), len(impossible), sun_still and not field_still, limits
    )
    pair = apart = False
    if field is not None and sun is not None and not (field_cause or sun_cause):
        pair, apart = True, _are_apart(field, sun, modelled_t, reference, limits)
    if len(lamps) > MOST_LAMPS or len(impossible) > MOST_IMPOSSIBLE:
        currents = (None,) * len(currents)
    elif impossible:  # a message with an impossible current in it shows nothing about the other cells
        currents = tuple([current if cell in impossible else None for cell, current in enumerate(currents)])
    return Findings(field_cause, sun_cause, field, sun, pair, apart, currents, shadow)


def _against_field(
    measurements: Measurements,
    field: Vec3 | None,
    modelled_t: float,
    frozen: bool,
    limits: PlausibilityConfig,
) -> int:
    """What speaks against the magnetometer; 0: nothing."""
    message = measurements.field
    if message is None:
        return SensorFault.SILENT
    strong = measurements.saturated and modelled_t > limits.in_range_t
    if not message.valid and coils_idle(measurements) and not strong:
        return SensorFault.SATURATED
    if frozen:
        return SensorFault.FROZEN
    most_t = limits.field_t + limits.field_part * modelled_t
    if field is not None and not abs(norm(field) - modelled_t) <= most_t:
        return SensorFault.STRENGTH
    return 0


def _against_sun(
    measurements: Measurements,
    sun: Vec3 | None,
    shadow: bool,
    lamps: int,
    impossible: int,
    frozen: bool,
    limits: PlausibilityConfig,
) -> int:
    """What speaks against the Sun sensor, or the board that reads the cells; 0: nothing."""
    if measurements.sun is None and measurements.cells is None:
        return SensorFault.SILENT
    if shadow and (sun is not None or lamps > MOST_LAMPS):
        return SensorFault.UNLIT
    if impossible > MOST_IMPOSSIBLE or (sun is not None and not abs(norm(sun) - 1.0) <= limits.sun_norm):
        return SensorFault.STRENGTH
    return SensorFault.FROZEN if frozen else 0


def _wrong_cells(
    currents: Sequence[float | None], shadow: bool, isolated: Sequence[int], cells: CellSet | None
) -> tuple[list[int], list[int]]:
    """The cells in use that are lit in the shadow, and those brighter than anything can make them.

    Both are wrong by themselves: without an attitude, and whatever the table allows.
    """
    lamps: list[int] = []
    impossible: list[int] = []
    if cells is None:
        return lamps, impossible
    most = 1.0 + cells.albedo + SIGMAS * cells.model_sigma
    for cell, current in enumerate(currents):
        if current is None or cell in isolated:
            continue
        if shadow and current > cells.dark:
            lamps.append(cell)
        if current > most:
            impossible.append(cell)
    return lamps, impossible


def _is_in_shadow(reference: Reference) -> bool:
    """Whether the satellite is certainly in shadow, beyond all errors of the model."""
    return not (reference.lit or lit(reference.r_eci_m, reference.sun_eci, SHADOW_M))


def _are_apart(
    field: Vec3, sun: Vec3, modelled_t: float, reference: Reference, limits: PlausibilityConfig
) -> bool:
    """Whether field and Sun are not at the modelled angle; errors of the field turn a weak one most."""
    if not norm(field) * norm(sun) > 0.0:
        return False
    measured = dot(field, sun) / (norm(field) * norm(sun))
    s_eci, slope_eci = reference.sun_eci, ZERO
    if limits.most_albedo:
        s_eci, slope_eci = apparent_sun(reference.r_eci_m, s_eci, 0.5 * limits.most_albedo)
    expected = dot(reference.b_eci_t, s_eci) / modelled_t
    limit_rad = limits.angle_rad + limits.field_t / modelled_t + 0.5 * limits.most_albedo * norm(slope_eci)
    return not abs(_angle(measured) - _angle(expected)) <= limit_rad


def _angle(cosine: float) -> float:
    return acos(max(-1.0, min(1.0, cosine)))
