"""Results of 40 runs that nobody flew: the pointing error follows the initial angle, two runs failed."""

from dataclasses import replace

import numpy as np
import pytest

from sim.campaign.definition.columns import input_cells
from sim.campaign.one_run import ERROR_HISTORY
from sim.campaign.report.analysis import analyse
from sim.campaign.results.store import RunRow, Status, open_results
from sim.statistics.indices import INDICES, profile


def _f4(values):
    return np.asarray(values, "<f4").tobytes()


@pytest.fixture(scope="session")
def failed_row(small):
    """A run that failed."""
    return lambda run: RunRow(
        run, Status.FAILED, f"run {run}: <too> fast", 1, False, "", input_cells(small.draw(run).inputs)
    )


@pytest.fixture(scope="session")
def done_row(small):
    """A run that was flown; its pointing error is 20 deg plus 1.5 deg a run."""

    def row(run):
        pointing_deg = 20.0 + 1.5 * run
        cells = input_cells(small.draw(run).inputs) | {"input_initial_angle_deg": float(run)}
        cells |= {
            "pointing_deg_rms_last_orbit": pointing_deg,
            "pointing_deg_max_last_orbit": 2.0 * pointing_deg,
        }
        over_time = pointing_deg * (1.0 + np.arange(500) / 500.0)
        profiles = {name: _f4(profile(over_time)) for name in INDICES}
        profiles[ERROR_HISTORY] = _f4(over_time[::-50])
        cells["limits_ok"] = 1
        cells |= {
            "requirements_0_verdict": "not judged", "requirements_0_limit": 3.0,
            "requirements_1_verdict": "met" if pointing_deg < 50.0 else "failed",
            "requirements_1_measured": pointing_deg, "requirements_1_limit": 50.0,
        }  # fmt: skip
        met = pointing_deg <= 60.0
        missed = "" if met else "pointing_deg_rms_last_orbit <= 60"
        return RunRow(run, Status.DONE, "", 1, met, missed, cells, profiles)

    return row


@pytest.fixture(scope="session")
def unsettled(campaign_of_40, done_row, tmp_path_factory):
    """Statistics of 12 of them, of which six have not settled: five for the same two causes."""
    with open_results(tmp_path_factory.mktemp("unsettled"), campaign_of_40) as results:
        for run in range(12):
            causes = {3: "weak"}.get(run, "estimate, mismatch" if run > 6 else "")
            why = {"unsettled_causes": causes, "unsettled_why": f"{causes} <of> {run}" if causes else ""}
            row = done_row(run)
            results.add(replace(row, cells=row.cells | why))
        return analyse(campaign_of_40, results)


@pytest.fixture(scope="session")
def campaign_of_40(small):
    """The campaign of these results."""
    return replace(small, runs=40)


@pytest.fixture(scope="session")
def analysis(campaign_of_40, done_row, failed_row, tmp_path_factory):
    """Its statistics."""
    with open_results(tmp_path_factory.mktemp("results"), campaign_of_40) as results:
        for run in range(40):
            results.add(failed_row(run) if run in (7, 21) else done_row(run))
        return analyse(campaign_of_40, results)
