"""A pass as it is judged: by a fit to itself, and by the flight filter with the carried calibration."""

from collections.abc import Mapping
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sim.commissioning.calibrate.magnetometer import fit_magnetometer
from sim.commissioning.calibrate.recorded import calibrate_pass
from sim.commissioning.recorded.along import Along, along, screened
from sim.commissioning.recorded.calibration import PassCalibration
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.judge import figures, judge, rank_motions
from sim.errors import HarnessError
from sim.scenario.element_file import nearest_elements

ELEMENTS, CALIBRATED_BY = "tle.txt", "s3_20231211T151930Z"
INERTIA = np.array([38478.7, 38528.7, 6873.7])
"""Ratios as the makers of the satellite declare them."""
SHORT_STARTS_S = (100.0, 200.0, 400.0)
"""Stretches of field from which the filter is started where two solutions are known."""
TWO_SOLUTIONS: Mapping[str, float] = MappingProxyType({CALIBRATED_BY: -24.39, "s3_20240426T041442Z": 65.9})
"""By pass, the right one of two rates, deg/s; the other is 0.29 and 0.6 deg/s off."""
RIGHT_DEGPS = 0.12


class NotToldError(HarnessError):
    """The pass to calibrate by does not tell what all others are judged with."""


class PassFigures(NamedTuple):
    """A pass: the residual of a fit to itself, nT RMS, and the figures of the telemetry command."""

    name: str
    span_s: float
    own_fit_nt: float
    found: dict[str, Any]


class Believed(NamedTuple):
    """Of a pass with two solutions: starts that were judged, and wrong motions that were believed."""

    name: str
    judged: int
    wrong: tuple[str, ...]


def files(folder: Path) -> list[Path]:
    """The passes of a folder, in the order of time.

    Raises:
        HarnessError: it holds none, or not the one to calibrate by.
    """
    found = sorted(folder.glob("s3_*.csv"))
    if not (folder / f"{CALIBRATED_BY}.csv").is_file():
        raise HarnessError(
            f"{folder}: it does not hold {CALIBRATED_BY}.csv, by which the sensors are calibrated"
        )
    return found


def placed(path: Path) -> Along:
    """A pass on its orbit."""
    recorded = read_pass(path)
    return screened(along(recorded, nearest_elements(path.parent / ELEMENTS, recorded.middle_unix_s)))


def carried(folder: Path) -> PassCalibration:
    """The calibration by the one pass that all others are judged with.

    Raises:
        NotToldError: the pass does not tell it.
        HarnessError: a file is malformed.
    """
    found = calibrate_pass(placed(folder / f"{CALIBRATED_BY}.csv"), INERTIA, Noise())
    if found.body is None:
        raise NotToldError(f"{folder}: {CALIBRATED_BY}.csv does not tell sensors and body")
    return found.calibration


def judged(path: Path, known: PassCalibration) -> PassFigures:
    """The figures of a pass."""
    around = placed(path)
    fit = fit_magnetometer(around.recorded.mag_nt, around.strength_nt)
    found = figures(judge(around, known, Noise()))
    return PassFigures(path.stem, float(around.t_s[-1]), fit.rms_nt, found)


def believed(path: Path, known: PassCalibration) -> Believed:
    """Start a pass with two solutions from stretches of several lengths, and offer each motion alone too.

    Under the known inertia some wrong motions are lost by themselves; a sphere follows them too.
    """
    around, right_degps = placed(path), TWO_SOLUTIONS[path.stem]
    count, wrong = 0, []
    for inertia, start_s in product((known.inertia, np.eye(3)), SHORT_STARTS_S):
        whole = judge(around, known._replace(inertia=inertia), Noise(), start_s)
        offered = [(whole.best, whole.verdict), *((one, rank_motions([one])[1]) for one in whole.motions[1:])]
        for motion, verdict in offered:
            count += 1
            rate = float(motion.followed.rate_degps[motion.settled :, 1].mean())
            if verdict.converged and abs(rate - right_degps) > RIGHT_DEGPS:
                wrong.append(f"{rate:.2f} deg/s from {start_s:.0f} s")
    return Believed(path.stem, count, tuple(wrong))
