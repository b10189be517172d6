"""The export has the rows and columns of SQLite."""

import builtins
import math

import pyarrow.parquet as pq
import pytest

from sim.campaign.results.parquet import export
from sim.campaign.results.row import RunRow, Status
from sim.campaign.results.store import open_results
from sim.errors import HarnessError


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
