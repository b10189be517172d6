"""Claims on phasing: every wiring of the coils with every wiring of the magnetometer, 48 by 48.

The sequence acts without looking, so that the wiring of the magnetometer changes nothing of a flight but
which channel shows what: each wiring of the coils is flown once, and its log judged with all 48 of the
magnetometer. Each flight is of another satellite: attitude, rate, offset up to 60 uT, scale,
non-orthogonality, turn, coils' field and delay are drawn.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.input.schema import Nested
from fsw.table.table import FlightTable
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.commissioning.calibrate.flown.coil_axes import CoilAxes, coil_axes
from sim.commissioning.calibrate.flown.expected import Expected
from sim.commissioning.calibrate.flown.samples import Samples, read_samples
from sim.commissioning.calibrate.flown.wiring import WIRINGS, Wiring, channels_from_body
from sim.commissioning.phasing.command import sequence_ticks, with_sequence
from sim.commissioning.phasing.judge import PhasingPremises, phasing
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import flight_table, load
from sim.value_types import Array

SCENARIO = "microsat"
SOURCE = "Every signed permutation of the axes of sensor and coils, alone and together"
TOLD = "Part of the pairs that one round of pulses tells; of the others, all that may be are named"
LEAST_DETERMINED = 0.75
SAME_NT = 1.0


class Tally(NamedTuple):
    """Of one wiring of the coils with all of the magnetometer: verdicts by kind, and the wrong ones."""

    coils: Wiring
    told: int
    among: int
    wrong: tuple[Wiring, ...]


def satellite(number: int) -> Nested:
    """Settings of a satellite that is drawn: what a calibration is to find."""
    draw = np.random.default_rng(number)

    def within(limit: float) -> list[float]:
        return [float(value) for value in draw.uniform(-limit, limit, 3)]

    offset = draw.normal(size=3)
    offset *= draw.uniform(0.0, 60000.0) / np.linalg.norm(offset)
    field = draw.uniform(-1.0, 1.0, (3, 3))
    field *= 2500.0 / np.linalg.norm(field, axis=0)  # 20 uT at 8 A m^2
    return {
        "initial": {
            "rate_degps": within(0.45),
            "angle_deg": float(draw.uniform(0.0, 180.0)),
            "axis": within(1.0),
        },
        "sensors": {
            "magnetometer": {
                "bias_nt": [float(value) for value in offset],
                "scale": [1.0 + value for value in within(0.05)],
                "non_orthogonality_deg": within(2.0),
                "misalignment_deg": within(1.0),
                "latency_s": float(draw.uniform(0.0, 2.0)),
                "coil_field_nt_per_am2": field.tolist(),
            }
        },
    }


def tally(coils: Wiring, sensors: Sequence[Wiring] = WIRINGS) -> Tally:
    """Fly the sequence with this wiring of the coils, and judge it with each of the magnetometer."""
    overrides = {**satellite(WIRINGS.index(coils)), "coils": {"wiring": list(coils)}}
    scenario = with_sequence(load(SCENARIO, overrides), 1)
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run"
        run_dir.begin(folder, scenario, 1, sequence_ticks(scenario, 1), "virtual", Pace())
        fly_virtual(folder, scenario, lambda tick: None)
        samples = read_samples(folder / run_dir.BUS_LOG, scenario.time.tick_hz)
    return judged(coils, samples, flight_table(scenario), sensors)


def judged(coils: Wiring, samples: Samples, table: FlightTable, sensors: Sequence[Wiring]) -> Tally:
    """The verdicts on a log, its channels led to the magnetometer in each of these ways."""
    told = among = 0
    wrong = []
    dipoles = _Remembered()
    for sensor in sensors:
        channels = samples.field_nt @ channels_from_body(sensor).T
        pairs = phasing(replace(samples, field_nt=channels), table, PhasingPremises(), dipoles).pairs
        told += pairs == ((sensor, coils),)
        among += len(pairs) > 1 and (sensor, coils) in pairs
        wrong += [sensor] if (sensor, coils) not in pairs else []
    return Tally(coils, told, among, tuple(wrong))


class _Remembered:
    """``coil_axes``, asked once for the same field in body axes, to which each right wiring leads."""

    def __init__(self) -> None:
        self._found: list[tuple[Array, CoilAxes | None]] = []

    def __call__(
        self,
        samples: Samples,
        b_body_nt: Array,
        usable: NDArray[np.bool_],
        along: Expected,
        table: FlightTable,
    ) -> CoilAxes | None:
        for known, found in self._found:
            if np.allclose(known[usable], b_body_nt[usable], rtol=0.0, atol=SAME_NT):
                return found
        found = coil_axes(samples, b_body_nt, usable, along, table)
        self._found.append((b_body_nt, found))
        return found


def studies() -> list[Study]:
    """All of them."""
    tasks = tuple(partial(tally, coils) for coils in WIRINGS)
    return [Study("phasing", tasks, conclude, has_flights=True)]


def conclude(tallies: Sequence[Any]) -> list[ClaimOutcome]:
    """No verdict is wrong, and most tell both wirings."""
    wrong = [(sensor, one.coils) for one in tallies for sensor in one.wrong]
    count = sum(one.wiring + one.among + len(one.wrong) for one in tallies)
    where = f"magnetometer {wrong[0][0]}, coils {wrong[0][1]}" if wrong else f"of {count}"
    untold = [one.coils for one in tallies if one.wiring < one.wiring + one.among]
    none_wrong = Claim("phasing.wrong", "Pairs of wirings that are told wrong", SOURCE, "1", high=0.0)
    told = Claim("phasing.wiring", TOLD, SOURCE, "1", low=LEAST_DETERMINED)
    part = sum(one.wiring for one in tallies) / count
    return [
        none_wrong.judge(float(len(wrong)), where),
        told.judge(part, f"not told: coils {untold}" if untold else ""),
    ]
