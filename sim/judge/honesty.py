"""Whether attitudes that a flight software calls valid are near the truth."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.fault_table.wrong_estimates import WRONG_DEG
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.record.truth import TruthReader
from sim.report.figures.attitude_arrays import angle_rad
from sim.report.figures.estimate_error import estimate_error
from sim.report.observed import observed_estimates


class WrongAttitude(NamedTuple):
    """The longest time for which attitudes were called valid and were wrong.

    Attributes:
        longest_s: on end; a tick without an attitude ends nothing.
        worst_deg: the largest error of all that were called valid.
        limit_deg: the error from which on one is wrong.
    """

    longest_s: float
    worst_deg: float
    limit_deg: float = WRONG_DEG


def wrong_attitude(path: Path, tick_hz: int, limit_deg: float, forged: bool = False) -> WrongAttitude:
    """Of the attitudes that the log of a run holds, against its histories; ``forged`` as for the answers."""
    longest = wrong = first = 0
    worst_deg = 0.0
    with TruthReader(path / run_dir.TRUTH) as truth:
        entries = whole_entries(run_dir.bus_log(path))
        for estimates in observed_estimates(entries, truth.complete, forged):
            rows = truth.rows(first, first + len(estimates.valid))
            first += len(estimates.valid)
            error_deg = np.degrees(angle_rad(estimate_error(rows, estimates)))[estimates.valid]
            for one in error_deg.tolist():
                wrong = wrong + 1 if one > limit_deg else 0
                longest, worst_deg = max(longest, wrong), max(worst_deg, one)
    return WrongAttitude(longest / tick_hz, worst_deg, limit_deg)
