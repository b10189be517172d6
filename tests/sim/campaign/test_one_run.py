"""A run gives the same row alone, after others and in any order; an error is a row too."""

import gc
from dataclasses import replace

import numpy as np
import pytest

from sim.campaign import one_run
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.definition.columns import cells
from sim.campaign.flight import digest_of, record_scenario
from sim.campaign.one_run import ERROR_HISTORY, LIMITS, Keep, RunTask, lost_run, run_folder
from sim.campaign.results.store import Status
from sim.errors import HarnessError
from sim.record import run_dir
from sim.report.conclude import conclude
from sim.scenario.schema import scenario_of
from sim.statistics.indices import POINTS

pytestmark = pytest.mark.long


def untimed(row):
    return replace(row, wall_s=0.0, worker="")


@pytest.fixture(scope="module")
def task(small, tmp_path_factory):
    return RunTask(small, Keep.NONE, tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="module")
def rows(task):
    return {run: task.fly(run) for run in (3, 0, 1)}


def test_a_run_is_the_same_in_any_order(task, rows):
    again = task.fly_all([1, 3])
    assert [untimed(row) for row in again] == [untimed(rows[1]), untimed(rows[3])]
    assert rows[1].cells["frames_sha256"] != rows[3].cells["frames_sha256"]


def test_its_row_has_inputs_figures_and_profiles(small, rows):
    row, drawn = rows[3], small.draw(3)
    assert (row.run, row.status, row.failure, row.seed) == (3, Status.DONE, "", drawn.seed)
    assert row.cells["input_initial_angle_deg"] == drawn.inputs["initial.angle_deg"]
    assert (
        row.cells["input_sensors_magnetometer_bias_nt_2"] == drawn.inputs["sensors.magnetometer.bias_nt"][2]
    )
    assert row.cells["input_coils_backoff"] == drawn.inputs["coils.backoff"]
    assert row.cells["ticks"] == 121
    assert 20.0 < row.cells["pointing_deg_final"] < 90.0
    assert set(row.profiles) == {"ape", "mpe", "rpe", "ake", ERROR_HISTORY}
    ape = np.frombuffer(row.profiles["ape"], "<f4")
    assert len(ape) == POINTS
    assert ape[-1] == pytest.approx(row.cells["ape_deg_max"])


def test_success_is_what_the_requirement_says(rows):
    for row in rows.values():
        assert row.success == (row.cells["pointing_deg_rms_last_orbit"] <= 60.0)
        assert row.missed == ("" if row.success else "pointing_deg_rms_last_orbit <= 60")


def test_broken_limits_are_no_success(small, task, monkeypatch):
    monkeypatch.setattr("sim.campaign.one_run.cells", lambda summary: {**cells(summary), "limits_ok": 0})
    row = replace(task, campaign=replace(small, requirements=())).fly(0)
    assert not row.success
    assert row.missed == LIMITS


@pytest.mark.parametrize("keep", [Keep.FAILURES, Keep.ALL])
def test_a_kept_run_has_the_same_frames(task, rows, keep, tmp_path):
    missed = next(run for run, row in rows.items() if not row.success)
    row = replace(task, keep=keep, folder=tmp_path).fly(missed)
    assert untimed(row) == untimed(rows[missed])
    path = run_folder(tmp_path, missed)
    assert digest_of(path / run_dir.BUS_LOG).frames == row.cells["frames_sha256"]
    assert digest_of(path / run_dir.BUS_LOG).commands == row.cells["commands_sha256"]
    assert conclude(path)["pointing_deg"]["final"] == row.cells["pointing_deg_final"]


def test_a_success_is_kept_with_all_alone(task, rows, tmp_path):
    met = next(run for run, row in rows.items() if row.success)
    replace(task, keep=Keep.FAILURES, folder=tmp_path).fly(met)
    assert not run_folder(tmp_path, met).exists()


def test_a_run_that_cannot_be_kept_ends_the_campaign(task, rows, tmp_path):
    (tmp_path / "runs").write_text("in the way")
    with pytest.raises(HarnessError, match="cannot be written"):
        replace(task, keep=Keep.ALL, folder=tmp_path).fly(0)


def test_values_that_are_not_allowed_fail_their_run_alone(tmp_path):
    path = tmp_path / "wide.toml"
    path.write_text(
        'scenario = "microsat"\nruns = 8\norbits = 0.01\n'
        '[[disperse]]\nkey = "sensors.magnetometer.noise_nt"\n'
        'distribution = "normal"\nmean = 10.0\nsigma = 30.0'
    )
    campaign = load_campaign(str(path), {}, {})
    rows = RunTask(campaign, Keep.FAILURES, tmp_path).fly_all(range(8))
    for row in rows:
        negative = row.cells["input_sensors_magnetometer_noise_nt"] < 0.0
        assert (row.status is Status.FAILED) == negative
        if negative:
            assert row.failure.startswith(f"run {row.run}: sensors.magnetometer.noise_nt = -")
            assert row.failure.endswith("is not allowed: allowed is a number at least 0")
            assert not row.success
    assert {row.status for row in rows} == set(Status)


def test_a_defect_is_a_sentence_with_its_place(task, monkeypatch):
    def defect(*arguments):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("sim.campaign.one_run.record_scenario", defect)
    row = task.fly(2)
    assert row.status is Status.FAILED
    assert row.failure.startswith("ZeroDivisionError: division by zero (test_one_run.py:")


def test_a_run_that_no_worker_survives_says_so(small):
    row = lost_run(small, 5, 3)
    assert (row.run, row.status) == (5, Status.FAILED)
    assert (
        row.failure == "its worker process was lost 3 times (ended from outside, out of memory, or crashed)"
    )


def test_nothing_stays_frozen_after_a_run(task):
    task.fly(0)
    assert gc.get_freeze_count() == 0


def test_garbage_is_collected_after_each_second_of_flights(task, monkeypatch):
    collections = []
    monkeypatch.setattr(one_run.gc, "collect", lambda: collections.append(True))
    monkeypatch.setattr(one_run, "COLLECT_EVERY_S", 1e9)
    task.fly(0)
    assert collections == []
    monkeypatch.setattr(one_run, "COLLECT_EVERY_S", 0.0)
    task.fly(0)
    task.fly(1)
    assert collections == [True, True]


def test_a_scenario_flies_with_its_faults(small):
    fault = {"kind": "mag_bias", "at_s": 30.0, "parameters": {"axis": 1, "nt": 20000.0}}
    healthy, faulty = (scenario_of(small.base, "here", over) for over in ({}, {"fault": [fault]}))
    assert record_scenario(healthy, 1).digest.frames != record_scenario(faulty, 1).digest.frames
