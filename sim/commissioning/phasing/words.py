"""The verdict of phasing in words and as JSON, held against the onboard table."""

import numpy as np
from numpy.typing import NDArray

from fsw.core.gate.calibration import Outputs
from fsw.core.laws.plan.pulse_model import AXES
from fsw.table.calibration import MagnetometerTable, outputs_of
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.coil_axes import CoilAxes
from sim.commissioning.calibrate.flown.wiring import (
    COILS,
    MAGNETOMETER,
    RIGHT,
    WIRINGS,
    Wiring,
    channels_from_body,
    in_words,
)
from sim.commissioning.phasing.judge import Phasing
from sim.value_types import Json

Pair = tuple[Wiring, Wiring]

MOST_LISTED = 12


def of_table(table: FlightTable) -> Pair:
    """The wirings that the table says: those nearest to its calibration."""
    magnetometer = table.calibration.magnetometer or MagnetometerTable()
    body_from_channels = np.array(magnetometer.matrix)
    sensor = max(WIRINGS, key=lambda one: float(np.sum(channels_from_body(one).T * body_from_channels)))
    coils = table.calibration.coils
    outputs: Outputs = outputs_of(AXES if coils is None or coils.matrix is None else coils.matrix)
    one, two, three = (sign * (axis + 1) for axis, sign in zip(outputs.axis, outputs.sign, strict=True))
    return sensor, (one, two, three)


def verdict(found: Phasing, table: FlightTable) -> str:
    """One sentence: what is wired how, or that it cannot be determined."""
    said = of_table(table)
    if found.wiring is not None:
        return sentence(found.wiring, said)
    dead = [f"coil {number} does nothing" for number, one in enumerate(found.outputs, 1) if one.dead]
    if dead:
        return "; ".join(dead)
    if not found.pairs:
        return "no wiring of coils and magnetometer explains the samples"
    if {sensor for sensor, _ in found.pairs} == {found.pairs[0][0]}:
        return f"{in_words(MAGNETOMETER, found.pairs[0][0])}; of the coils {_ways(found)}"
    if {coils for _, coils in found.pairs} == {found.pairs[0][1]}:
        return f"{in_words(COILS, found.pairs[0][1])}; of the magnetometer {_ways(found)}"
    return f"of magnetometer and coils {_ways(found)}"


def _ways(found: Phasing) -> str:
    return f"{len(found.pairs)} wirings cannot be told apart"


def sentence(pair: Pair, said: Pair) -> str:
    """How both are wired; what the table says, where it says otherwise than right."""
    if pair == said:
        return "magnetometer and coils are wired as the table says"
    sensor, coils = pair
    text = f"{in_words(MAGNETOMETER, sensor)}; {in_words(COILS, coils)}"
    if said == (RIGHT, RIGHT):
        return text
    return f"{text}. The table has {in_words(MAGNETOMETER, said[0])}; {in_words(COILS, said[1])}"


def alternatives(found: Phasing, table: FlightTable) -> list[str]:
    """The pairs that cannot be told apart, those with the least wrong first."""
    if len(found.pairs) < 2:
        return []
    said = of_table(table)
    wrong = sorted(found.pairs, key=lambda pair: (pair[0] != said[0]) + (pair[1] != said[1]))
    text = [
        sentence(pair, (RIGHT, RIGHT)) if pair != said else sentence(pair, said)
        for pair in wrong[:MOST_LISTED]
    ]
    others = len(wrong) - MOST_LISTED
    return [*text, *([f"and {others} more"] if others > 0 else [])]


def lines(found: Phasing, table: FlightTable) -> list[str]:
    """Matrices with their uncertainty, the verdict, and what was missing."""
    response = found.response
    text = ["response of the magnetometer's channels, nT by nominal A m^2 of coil 1, 2, 3:"]
    text += _matrix(response.nt_per_am2, response.sigma, "{:+9.0f} ±{:.0f}")
    if response.delay_ticks is not None and response.delay_sigma is not None:
        tick_s = 1.0 / table.time.tick_hz
        late, sigma = response.delay_ticks * tick_s, response.delay_sigma * tick_s
        text.append(f"it shows {late:.2f} ±{sigma:.2f} s late")
    if found.coils is not None:
        text.append("dipole in body axes, by nominal A m^2 of coil 1, 2, 3, from the change of the rate:")
        text += _matrix(found.coils.matrix, _sigma(found.coils), "{:+7.2f} ±{:.2f}")
    if found.sensor_fit is not None:
        offset, sigmas = found.sensor_fit.offset_nt, np.sqrt(found.sensor_fit.covariance.diagonal()[9:])
        parts = ", ".join(f"{o / 1000.0:+.1f} ±{s / 1000.0:.1f}" for o, s in zip(offset, sigmas, strict=True))
        text.append(f"offset of the magnetometer's channels: {parts} uT")
    listed = alternatives(found, table)
    text += ["cannot be told apart:", *(f"  {one}" for one in listed)] if listed else []
    text += [f"not used: {reason}" for reason in found.missing] if found.wiring is None else []
    return text


def _sigma(coils: CoilAxes) -> NDArray[np.float64]:
    return np.sqrt(coils.covariance.diagonal()).reshape(3, 3)


def _matrix(values: NDArray[np.float64], sigmas: NDArray[np.float64], form: str) -> list[str]:
    return [
        "  " + "  ".join(form.format(value, sigma) for value, sigma in zip(row, sigma_row, strict=True))
        for row, sigma_row in zip(values.tolist(), sigmas.tolist(), strict=True)
    ]


def as_json(found: Phasing, table: FlightTable) -> Json:
    """The same as values."""
    response, coils = found.response, found.coils
    tick_s = 1.0 / table.time.tick_hz
    late, sigma = response.delay_ticks, response.delay_sigma
    return {
        "verdict": verdict(found, table),
        "told": found.wiring is not None,
        "as_table": found.wiring == of_table(table),
        "pairs": [{"magnetometer": list(sensor), "coils": list(wired)} for sensor, wired in found.pairs],
        "table": dict(zip(("magnetometer", "coils"), map(list, of_table(table)), strict=True)),
        "response_nt_per_am2": response.nt_per_am2.tolist(),
        "response_sigma": response.sigma.tolist(),
        "delay_s": None if late is None else late * tick_s,
        "delay_sigma_s": None if sigma is None else sigma * tick_s,
        "pulses": list(response.pulses),
        "dipole_by_coil": None if coils is None else coils.matrix.tolist(),
        "dipole_sigma": None if coils is None else _sigma(coils).tolist(),
        "missing": list(found.missing),
    }
