"""Results survive whoever writes them, belong to one campaign, and have one writer."""

import builtins
import math
import sqlite3
import subprocess
import sys
from dataclasses import replace

import pyarrow.parquet as pq
import pytest
from campaign_rows import FAILED

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.results.store import (
    RESULTS,
    SCHEMA_VERSION,
    RunRow,
    Status,
    export,
    open_results,
    read_results,
)
from sim.errors import HarnessError


def test_a_row_is_read_as_it_was_written(small, row_of, tmp_path):
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 4))
    with read_results(tmp_path) as results:
        found = results.row(4)
        assert results.row(3) is None
        assert results.profiles("ape")[4].tolist()[::255] == [0.5, 4.0]
        assert results.numbers(()) == {}, "no columns are no error"
        assert results.numbers(("pointing_deg_rms_last_orbit",))["pointing_deg_rms_last_orbit"] == [1.0 / 7.0]
    assert (found["run"], found["status"], found["seed"]) == (4, "done", small.draw(4).seed)
    assert found["input_initial_angle_deg"] == small.draw(4).inputs["initial.angle_deg"]
    assert found["input_coils_backoff"] in ("shared", "per_coil")
    assert found["pointing_deg_rms_last_orbit"] == 1.0 / 7.0
    assert found["nees_mean"] is None


def test_columns_and_rows_do_not_depend_on_the_order_of_the_runs(small, row_of, tmp_path):
    tables = []
    for folder, order in (("a", (2, 0, 1)), ("b", (0, 1, 2))):
        (tmp_path / folder).mkdir()
        with open_results(tmp_path / folder, small) as results:
            for run in order:
                results.add(row_of(small, run, wall_s=float(order[0])))
        connection = sqlite3.connect(tmp_path / folder / RESULTS)
        tables.append(
            (
                list(connection.execute("SELECT * FROM runs")),
                connection.execute("SELECT * FROM runs").description,
            )
        )
        connection.close()
    assert tables[0] == tables[1]


def test_a_run_that_is_flown_again_replaces_its_row(small, row_of, tmp_path):
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 1, **FAILED))
        assert results.runs(Status.FAILED) == [1]
        results.add(row_of(small, 1))
        assert (results.runs(), results.runs(Status.FAILED)) == ([1], [])
        assert results.row(1)["failure"] == ""
        attempts = list(sqlite3.connect(results.path).execute("SELECT run, failure FROM attempts"))
        assert attempts == [(1, "no fuel"), (1, "")]


def test_another_campaign_is_refused_and_more_runs_of_this_are_not(small, row_of, campaign_file, tmp_path):
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 1))
    other = load_campaign(str(campaign_file), {"seed": 5}, {})
    with (
        pytest.raises(HarnessError, match="holds the runs of another campaign"),
        open_results(tmp_path, other),
    ):
        pass
    with open_results(tmp_path, replace(small, runs=99)) as results:
        assert results.runs() == [1]


def test_there_is_one_writer_and_any_number_of_readers(small, row_of, tmp_path):
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 0))
        with (
            pytest.raises(HarnessError, match="another process is flying this campaign"),
            open_results(tmp_path, small),
        ):
            pass
        mode = sqlite3.connect(results.path).execute("PRAGMA journal_mode").fetchone()
        assert mode == ("wal",)
        with read_results(tmp_path) as reader:
            assert reader.runs() == [0]
            results.add(row_of(small, 1))
            assert reader.runs() == [0, 1]
    with open_results(tmp_path, small) as results:
        assert results.runs() == [0, 1]


KILLED = """
import os, signal, sys
from pathlib import Path
from dataclasses import replace
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.results.store import RunRow, Status
from sim.campaign.results.store import open_results
campaign = load_campaign(sys.argv[1], {}, {})
with open_results(Path(sys.argv[2]), campaign) as results:
    for run in range(3):
        results.add(RunRow(run, Status.FAILED, "no fuel", 1, False, "", {}))
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.long
@pytest.mark.slow
def test_what_was_added_before_sigkill_is_there_and_the_lock_is_not(small, campaign_file, tmp_path):
    done = subprocess.run([sys.executable, "-c", KILLED, campaign_file, tmp_path], check=False)
    assert done.returncode == -9
    with open_results(tmp_path, small) as results:
        assert results.runs() == [0, 1, 2]


def test_no_results_or_others_are_one_sentence(small, tmp_path):
    with pytest.raises(HarnessError, match=f"has no {RESULTS}"), read_results(tmp_path):
        pass
    (tmp_path / RESULTS).write_text("no database, but long enough to be taken for one" * 100)
    with pytest.raises(HarnessError, match="not a database"), read_results(tmp_path):
        pass


@pytest.mark.parametrize("damaged", [b"CREATE TABL\xa4", b"\xa4REATE TABLE"])
def test_a_malformed_table_is_one_sentence_whatever_its_bytes(small, tmp_path, damaged):
    with open_results(tmp_path, small):
        pass
    whole = (tmp_path / RESULTS).read_bytes()
    (tmp_path / RESULTS).write_bytes(whole.replace(b"CREATE TABLE", damaged))
    with pytest.raises(HarnessError, match=f"{RESULTS}: malformed database"), read_results(tmp_path):
        pass


def test_results_without_their_version_are_refused(small, tmp_path):
    with open_results(tmp_path, small):
        pass
    with sqlite3.connect(tmp_path / RESULTS) as connection:
        connection.execute("DELETE FROM meta")
    with pytest.raises(HarnessError, match="schema_version is missing"), read_results(tmp_path):
        pass


def test_results_of_another_version_are_refused(small, tmp_path):
    with open_results(tmp_path, small):
        pass
    with sqlite3.connect(tmp_path / RESULTS) as connection:
        connection.execute("UPDATE meta SET value = '99' WHERE key = 'schema_version'")
    expected = f"schema_version is 99, only {SCHEMA_VERSION} can be read"
    with pytest.raises(HarnessError, match=expected), open_results(tmp_path, small):
        pass


def test_a_campaign_of_an_older_torquer_is_refused_and_left_as_it_was(small, row_of, tmp_path):
    with open_results(tmp_path, small) as results:
        results.add(row_of(small, 0))
    with sqlite3.connect(tmp_path / RESULTS) as connection:
        connection.execute("ALTER TABLE runs DROP COLUMN requirements_failed")
        connection.execute("UPDATE meta SET value = 'x' WHERE key = 'campaign_sha256'")
    says = "was begun by an older torquer, whose runs have no requirements_failed: choose another --out"
    with pytest.raises(HarnessError, match=says), open_results(tmp_path, small):
        pass
    with read_results(tmp_path) as results:
        assert results.runs() == [0], "what is there can still be read and flown again"


# --- The export has the rows and columns of SQLite


@pytest.mark.long
def test_rows_columns_and_versions_are_those_of_the_results(small, tmp_path):
    with open_results(tmp_path, small) as results:
        for run, value in ((2, 0.1), (0, math.inf), (1, None)):
            cells = {"nees_mean": value, "mode_final": "POINT", "input_coils_backoff": "shared", "ticks": 7}
            results.add(RunRow(run, Status.DONE, "", run + 2**62, run > 0, "", cells))
        export(results, tmp_path / "out.parquet")
        rows = list(results.each(tuple(results.kinds())))
        meta = results.all_meta()
    table = pq.read_table(tmp_path / "out.parquet")
    assert list(zip(*(column.to_pylist() for column in table.columns), strict=True)) == rows
    assert table["run"].to_pylist() == [0, 1, 2]
    assert table["nees_mean"].to_pylist() == [math.inf, None, 0.1]
    assert table["seed"].to_pylist()[1] == 2**62 + 1
    assert {key.decode(): value.decode() for key, value in table.schema.metadata.items()} == meta


def test_no_runs_are_no_error(small, tmp_path):
    with open_results(tmp_path, small) as results:
        export(results, tmp_path / "out.parquet")
    assert pq.read_table(tmp_path / "out.parquet").num_rows == 0


def test_without_the_package_it_says_what_to_install(small, tmp_path, monkeypatch):
    original = builtins.__import__

    def missing(name, *arguments):
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return original(name, *arguments)

    monkeypatch.setattr(builtins, "__import__", missing)
    with open_results(tmp_path, small) as results, pytest.raises(HarnessError, match=r"torquer\[parquet\]"):
        export(results, tmp_path / "out.parquet")
