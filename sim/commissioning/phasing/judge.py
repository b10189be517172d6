"""The verdict of phasing: every pair of wirings that the evidence admits.

Which wirings of coils and magnetometer the evidence admits, each piece by itself.

With S the wiring of the channels, W that of the outputs, F the coils' field at the magnetometer by true
dipole and b the field around, body axes:

    the coils' field         D = S F W      needs F, and tells S and W together only: if F is f times the
                                            identity, each S has its W
    what the coils turn      C = W          needs an attitude, hence S
    field and Sun            S              needs orbit and Sun
    a field around, known    z = S b + o    needs b, and an offset that is small beside it
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from fsw.table.estimator import field_noise_nt, sun_noise_rad
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.coil_axes import CoilAxes, coil_axes
from sim.commissioning.calibrate.flown.coil_field import CoilResponse, coil_response
from sim.commissioning.calibrate.flown.expected import Expected, expected
from sim.commissioning.calibrate.flown.joint_fit import FieldFit, FreeSamples
from sim.commissioning.calibrate.flown.samples import Samples, in_time, whole
from sim.commissioning.calibrate.flown.sensor_axes import sensor_axes
from sim.commissioning.calibrate.flown.wiring import WIRINGS, Wiring, body_from_outputs, channels_from_body
from sim.value_types import Array, Flags

LEAST_GAIN, LARGEST_GAIN = 0.4, 2.0
"""Of a coil that works."""
TILT = 0.15
"""Standard deviation by which a coil may be off its axis, in parts of its nominal dipole."""
LARGEST_D2 = 25.0
"""Square of the largest distance of a coil's dipole from an axis, in standard deviations."""
DEAD = 0.15
"""Gain below which a coil does nothing, where it is known so well."""
FIELD_PART = 0.35
"""How far the coils' field may be off what is known of it, by output, in parts of its largest component."""
SIGMAS = 5.0
SENSES = tuple((axis, sign) for axis in (1, 2, 3) for sign in (1, -1))


class OutputAxes(NamedTuple):
    """Signed axes along which the coil of an output may be; ``dead``: it does nothing.

    By axis the square of how far its dipole is from there, with the likeliest gain, in standard deviations.
    """

    distances: dict[int, float]
    dead: bool


def by_torque(found: CoilAxes) -> list[OutputAxes]:
    """By output, the axes that agree with what its pulses did to the rate."""
    outputs = []
    for output in range(3):
        dipole, covariance = found.column(output)
        distances = {}
        for axis, sign in SENSES:
            d2 = _distance(dipole, covariance, axis, sign)
            if d2 < LARGEST_D2:
                distances[sign * axis] = d2
        still = float(np.linalg.norm(dipole)) < DEAD and float(np.sqrt(covariance.diagonal().max())) < DEAD
        outputs.append(OutputAxes({} if still else distances, still))
    return outputs


def _distance(dipole: Array, covariance: Array, axis: int, sign: int) -> float:
    """The square of the distance from a signed axis, with the likeliest gain of a coil that works."""
    along = np.zeros(3)
    along[axis - 1] = sign
    weights = np.linalg.inv(covariance + TILT**2 * np.eye(3))
    gain = float(along @ weights @ dipole / (along @ weights @ along))
    gain = min(max(gain, LEAST_GAIN), LARGEST_GAIN)
    off = dipole - gain * along
    return float(off @ weights @ off)


def wirings_of(outputs: list[OutputAxes]) -> list[Wiring]:
    """The wirings with a coil for each axis that are not much worse than the best of them, the best first."""
    squares: dict[Wiring, float] = {}
    for one, two, three in product(*(output.distances for output in outputs)):
        if sorted((abs(one), abs(two), abs(three))) == [1, 2, 3]:
            wiring = (one, two, three)
            squares[wiring] = sum(
                output.distances[axis] for output, axis in zip(outputs, wiring, strict=True)
            )
    least = min(squares.values(), default=0.0)
    return [
        wiring
        for wiring in sorted(squares, key=lambda one: squares[one])
        if squares[wiring] < least + LARGEST_D2
    ]


def by_coil_field(response: CoilResponse, field_nt_per_am2: Array) -> set[tuple[Wiring, Wiring]]:
    """The pairs (S, W) for which D = S F W, within what is known of F and the noise."""
    fired = np.array(response.pulses) > 0
    admitted = set()
    for sensor, coils in product(WIRINGS, WIRINGS):
        expected = channels_from_body(sensor) @ field_nt_per_am2 @ body_from_outputs(coils)
        tolerance = FIELD_PART * np.abs(expected).max(axis=0) + SIGMAS * response.sigma
        if (np.abs(response.nt_per_am2 - expected) < tolerance)[:, fired].all():
            admitted.add((sensor, coils))
    return admitted


def is_detected(response: CoilResponse) -> bool:
    """Whether each output that was fired shows in the field."""
    clear = np.abs(response.nt_per_am2) > SIGMAS * response.sigma
    return all(clear[:, output].any() for output, pulses in enumerate(response.pulses) if pulses)


def by_field_around(reading_nt: Array, b_body_nt: Array, offset_nt: float) -> list[Wiring]:
    """The wirings that lead a known field to the mean reading, with an offset below ``offset_nt`` an axis."""
    return [
        wiring
        for wiring in WIRINGS
        if bool((np.abs(reading_nt - channels_from_body(wiring) @ b_body_nt) < offset_nt).all())
    ]


NEAR_TICKS = 3
"""So near to a pulse a sample may show it, where its delay is not known."""


@dataclass(frozen=True, slots=True)
class PhasingPremises:
    """What is known of the bench or the satellite besides its table.

    Attributes:
        coil_field_nt_per_am2: F, the coils' field at the magnetometer by true dipole, body axes, (3, 3).
        field_around_nt: the field on the bench, body axes; None: the satellite is in orbit.
        offset_nt: largest offset of an axis of the magnetometer, by which a known field is compared.
        in_orbit: whether the field is that of an orbit where ``field_around_nt`` is None.
    """

    coil_field_nt_per_am2: Array | None = None
    field_around_nt: Array | None = None
    offset_nt: float = 1000.0
    in_orbit: bool = True


@dataclass(frozen=True, slots=True)
class Phasing:
    """What the pulses show.

    Attributes:
        response: of the channels to the outputs.
        pairs: of wirings (magnetometer, coils) that the evidence admits, of which one is the true one.
        sensor_fit: with the likeliest wiring of the magnetometer.
        coils: true dipoles by output, with that wiring.
        outputs: by output, the axes that its torque admits.
        missing: what could not be used, and why.
    """

    response: CoilResponse
    pairs: tuple[tuple[Wiring, Wiring], ...]
    sensor_fit: FieldFit | None
    coils: CoilAxes | None
    outputs: tuple[OutputAxes, ...]
    missing: tuple[str, ...]

    @property
    def wiring(self) -> tuple[Wiring, Wiring] | None:
        """The wirings, if one pair alone is admitted."""
        return self.pairs[0] if len(self.pairs) == 1 else None


Judged = Callable[[Samples, Array, Flags, Expected, FlightTable], CoilAxes | None]
"""The coils' dipoles, as ``coil_axes`` finds them."""


def phasing(
    samples: Samples, table: FlightTable, premises: PhasingPremises, dipoles: Judged = coil_axes
) -> Phasing:
    """Judge the samples of a log by all evidence there is."""
    response = coil_response(samples, table.coils.levels_am2)
    samples = in_time(samples, response.delay_ticks or 0.0)
    missing = [
        f"output {n} gave no pulse that can be used"
        for n, count in enumerate(response.pulses, 1)
        if not count
    ]
    fits: dict[Wiring, FieldFit] = {}
    motion: dict[Wiring, tuple[CoilAxes, list[OutputAxes]]] = {}
    sensors: list[Wiring] = list(WIRINGS)
    free_nt = samples.field_nt[samples.free(NEAR_TICKS)]
    free_nt = free_nt[whole(free_nt)]
    if premises.field_around_nt is not None and not len(free_nt):
        missing.append(
            "no sample of the field is clear of the pulses, so that the field around tells nothing"
        )
    elif premises.field_around_nt is not None:
        reading = free_nt.mean(axis=0)
        sensors = by_field_around(reading, premises.field_around_nt, premises.offset_nt)
    elif premises.in_orbit:
        along = expected(table, samples.unix_s)
        found = sensor_axes(_observed(samples, along, table))
        missing += [found.reason] if found.reason else []
        fits = {one.wiring: one.fit for one in found.candidates}
        sensors = list(fits) or sensors
        for wiring, fit in fits.items():
            moved = _moved(samples, fit, along, table, dipoles)
            motion |= {} if moved is None else {wiring: moved}
        sensors = list(motion) or sensors  # with a wrong wiring the motion makes no sense
    else:
        missing.append("the field around the bench is not known")
    pairs = [
        (sensor, coils)
        for sensor in sensors
        for coils in (wirings_of(motion[sensor][1]) if sensor in motion else WIRINGS)
    ]
    if premises.coil_field_nt_per_am2 is None:
        missing.append("the coils' field at the magnetometer is not known")
    elif not is_detected(response):
        missing.append("the coils' field is too weak to be seen by the magnetometer")
    else:
        admitted = by_coil_field(response, premises.coil_field_nt_per_am2)
        pairs = [pair for pair in pairs if pair in admitted]
    likeliest = next(iter(sensors), None)
    coils_found, outputs = motion.get(likeliest, (None, [])) if likeliest else (None, [])
    return Phasing(
        response,
        tuple(pairs),
        fits.get(likeliest) if likeliest else None,
        coils_found,
        tuple(outputs),
        tuple(missing),
    )


def _observed(samples: Samples, along: Expected, table: FlightTable) -> FreeSamples:
    free = samples.free(NEAR_TICKS)
    return FreeSamples(
        samples.field_nt[free],
        samples.sun[free],
        along.b_eci_nt[free],
        along.sun_eci[free],
        field_noise_nt(table.estimator),
        sun_noise_rad(table.estimator),
    )


def _moved(
    samples: Samples, fit: FieldFit, along: Expected, table: FlightTable, dipoles: Judged
) -> tuple[CoilAxes, list[OutputAxes]] | None:
    """What the pulses did to the rate, seen with a wiring of the magnetometer."""
    b_body_nt = (samples.field_nt - fit.offset_nt) @ fit.matrix.T
    found = dipoles(samples, b_body_nt, samples.free(NEAR_TICKS), along, table)
    return None if found is None else (found, by_torque(found))
