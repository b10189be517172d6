"""Which wirings of coils and magnetometer the evidence admits, each piece by itself.

With S the wiring of the channels, W that of the outputs, F the coils' field at the magnetometer by true
dipole and b the field around, body axes:

    the coils' field         D = S F W      needs F, and tells S and W together only: if F is f times the
                                            identity, each S has its W
    what the coils turn      C = W          needs an attitude, hence S
    field and Sun            S              needs orbit and Sun
    a field around, known    z = S b + o    needs b, and an offset that is small beside it
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.calibrate.flown.coil_axes import CoilAxes
from sim.commissioning.calibrate.flown.coil_field import CoilResponse
from sim.commissioning.calibrate.flown.wiring import WIRINGS, Wiring, body_from_outputs, channels_from_body

Array = NDArray[np.float64]

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


def seen(response: CoilResponse) -> bool:
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
