"""Which of the values a log tells, and what it would need to tell the others."""

from math import degrees

import numpy as np

from fsw.table.calibration import outputs_of
from sim.commissioning.calibrate.flown.run_fit import RunCalibration
from sim.commissioning.calibrate.flown.wiring import channels_from_body
from sim.value_types import Array

DETERMINED_OFFSET_NT = 2000.0
"""Three standard deviations of a determined offset: what the bias of a table may be at most is 3000."""
DETERMINED_PART = 0.03
"""The same of a component of M, and of the coils' dipoles."""
SIGMAS = 3.0
BEYOND_MEASURE = 1e9
"""Of nothing that was measured, a standard deviation."""


def turn_rad(found: RunCalibration) -> Array:
    """The small turn of the magnetometer against the Sun sensor, a rotation vector in body axes.

    M S = P R, P symmetric (scale and non-orthogonality), R the turn, S the wiring.
    """
    u, _, vt = np.linalg.svd(found.field.matrix @ channels_from_body(found.wiring))
    r = u @ vt
    return 0.5 * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])


def turn_sigma_rad(found: RunCalibration) -> Array:
    """Its standard deviations: of the antisymmetric part of M S."""
    wired = np.kron(np.eye(3), channels_from_body(found.wiring).T)
    covariance = wired @ found.field.covariance[:9, :9] @ wired.T
    pairs = ((7, 5), (2, 6), (3, 1))
    spread = [covariance[a, a] + covariance[b, b] - 2.0 * covariance[a, b] for a, b in pairs]
    return 0.5 * np.sqrt(np.maximum(spread, 0.0))


def part_sigma(found: RunCalibration) -> Array:
    """Standard deviations of the components of M, (3, 3)."""
    return np.sqrt(found.field.covariance.diagonal()[:9]).reshape(3, 3)


def offset_sigma_nt(found: RunCalibration) -> Array:
    """Standard deviations of the offset, by channel."""
    return np.sqrt(found.field.covariance.diagonal()[9:])


def are_coils(matrix: Array) -> bool:
    """Whether these can be the dipoles of three coils: each along an axis of its own, of nearly its size."""
    first, second, third = (tuple(row) for row in matrix.tolist())
    try:
        outputs_of((first, second, third))
    except ValueError:
        return False
    return True


def list_undetermined(found: RunCalibration) -> list[str]:
    """What the log does not tell, a sentence each; none: everything."""
    text = []
    values, directions = np.linalg.eigh(found.field.covariance[9:, 9:])
    worst_nt = SIGMAS * float(np.sqrt(values[-1]))
    if worst_nt > DETERMINED_OFFSET_NT:
        along = ", ".join(f"{part:+.2f}" for part in directions[:, -1])
        text.append(
            f"the offset along ({along}) of the channels is known within {worst_nt / 1000.0:.1f} uT only: "
            "the body must turn about another axis, or the log be longer"
        )
    if SIGMAS * float(part_sigma(found).max()) > DETERMINED_PART:
        percent = 100.0 * SIGMAS * float(part_sigma(found).max())
        text.append(f"scale and turn are known within {percent:.0f} % only: more attitudes are needed")
    response = found.response
    text += [
        f"output {n} gave no pulse that can be used: its field is not known"
        for n, c in enumerate(response.pulses, 1)
        if not c
    ]
    if response.delay_ticks is None:
        text.append("no pulse shows in the field: its delay is not known, and taken for zero")
    if found.coils is not None and not are_coils(found.coils.matrix):
        text.append("what the pulses did to the rate is that of no dipoles of coils")
    if found.coils is None and not min(response.pulses):
        text.append("the coils' dipoles are not known: each output needs a pulse that can be used")
    elif found.coils is None:
        text.append(
            "the coils' dipoles are not known: the filter found no attitude in which the pulses make sense"
        )
    return text


def sentences(found: RunCalibration, tick_s: float) -> list[str]:
    """The values with three standard deviations."""
    offset, sigma = found.field.offset_nt / 1000.0, SIGMAS * offset_sigma_nt(found) / 1000.0
    turn = [degrees(part) for part in turn_rad(found)]
    turn_sigma = [SIGMAS * degrees(part) for part in turn_sigma_rad(found)]
    text = [
        "offset of the channels: " + _values(offset, sigma, "{:+.3f} ±{:.3f}") + " uT",
        "turn against the Sun sensor: "
        + _values(turn, turn_sigma, "{:+.3f} ±{:.3f}")
        + " deg about axis 1, 2, 3",
        "matrix, body from channels (nT by nT):",
        *_matrix(found.field.matrix, SIGMAS * part_sigma(found), "{:+9.5f} ±{:.5f}"),
        "field of coil 1, 2, 3 by nominal A m^2, body axes, nT:",
        *_matrix(found.field_nt_per_am2, SIGMAS * found.field_sigma, "{:+9.1f} ±{:.1f}"),
    ]
    late, late_sigma = found.response.delay_ticks, found.response.delay_sigma
    if late is not None and late_sigma is not None:
        text.append(
            f"samples of the field are {late * tick_s:.3f} ±{SIGMAS * late_sigma * tick_s:.3f} s late"
        )
    if found.coils is not None:
        sigmas = SIGMAS * np.sqrt(found.coils.covariance.diagonal()).reshape(3, 3)
        text.append("dipole of coil 1, 2, 3 by nominal A m^2, body axes:")
        text += _matrix(found.coils.matrix, sigmas, "{:+9.3f} ±{:.3f}")
    if found.measurable_nt < found.strongest_nt:
        text.append(
            f"in a field above {max(0.0, found.measurable_nt) / 1000.0:.1f} uT an axis may be at the end of "
            f"its range, and that of this log is up to {found.strongest_nt / 1000.0:.1f} uT: the filter then "
            "takes the other two axes"
        )
    rms = np.sqrt(np.nanmean(found.residual_nt**2, axis=0))
    text.append(
        f"residual {rms[0]:.0f} nT rms of the strength, {rms[1]:.0f} nT of the component along the Sun, "
        f"{len(found.residual_nt)} smoothed samples, {100.0 * found.left_out:.1f} % left out"
    )
    return text


def _values(values: Array | list[float], sigmas: Array | list[float], form: str) -> str:
    return ", ".join(form.format(value, sigma) for value, sigma in zip(values, sigmas, strict=True))


def _matrix(values: Array, sigmas: Array, form: str) -> list[str]:
    return [
        "  " + "  ".join(_one(value, sigma, form) for value, sigma in zip(row, row_sigma, strict=True))
        for row, row_sigma in zip(values.tolist(), sigmas.tolist(), strict=True)
    ]


def _one(value: float, sigma: float, form: str) -> str:
    """An output without a pulse has no value, and a deviation beyond all measure."""
    return form.format(value, sigma) if sigma < BEYOND_MEASURE else f"{'not known':>16}"
