"""The verdict of phasing: every pair of wirings that the evidence admits."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsw.table.estimator import field_noise_nt, sun_noise_rad
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.coil_axes import CoilAxes, coil_axes
from sim.commissioning.calibrate.flown.coil_field import CoilResponse, coil_response
from sim.commissioning.calibrate.flown.expected import Expected, expected
from sim.commissioning.calibrate.flown.joint_fit import FieldFit, FreeSamples
from sim.commissioning.calibrate.flown.samples import Samples, in_time, whole
from sim.commissioning.calibrate.flown.sensor_axes import sensor_axes
from sim.commissioning.calibrate.flown.wiring import WIRINGS, Wiring
from sim.commissioning.phasing import evidence
from sim.commissioning.phasing.evidence import OutputAxes

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NEAR_TICKS = 3
"""So near to a pulse a sample may show it, where its delay is not known."""


@dataclass(frozen=True, slots=True)
class Known:
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
    def told(self) -> tuple[Wiring, Wiring] | None:
        """The wirings, if one pair alone is admitted."""
        return self.pairs[0] if len(self.pairs) == 1 else None


Judged = Callable[[Samples, Array, Flags, Expected, FlightTable], CoilAxes | None]
"""The coils' dipoles, as ``coil_axes`` finds them."""


def phasing(samples: Samples, table: FlightTable, known: Known, dipoles: Judged = coil_axes) -> Phasing:
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
    if known.field_around_nt is not None and not len(free_nt):
        missing.append(
            "no sample of the field is clear of the pulses, so that the field around tells nothing"
        )
    elif known.field_around_nt is not None:
        reading = free_nt.mean(axis=0)
        sensors = evidence.by_field_around(reading, known.field_around_nt, known.offset_nt)
    elif known.in_orbit:
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
        for coils in (evidence.wirings_of(motion[sensor][1]) if sensor in motion else WIRINGS)
    ]
    if known.coil_field_nt_per_am2 is None:
        missing.append("the coils' field at the magnetometer is not known")
    elif not evidence.seen(response):
        missing.append("the coils' field is too weak to be seen by the magnetometer")
    else:
        admitted = evidence.by_coil_field(response, known.coil_field_nt_per_am2)
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
    return None if found is None else (found, evidence.by_torque(found))
