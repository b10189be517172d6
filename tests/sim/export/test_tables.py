"""CSV and Parquet, read again: the run's own numbers to the last bit, with their units."""

import csv

import numpy as np
import pyarrow.parquet as pq
import pytest

from sim.export.command import write_csv, write_parquet
from sim.export.source import open_source
from sim.record.truth import COLUMNS


@pytest.fixture
def rows(exported):
    with exported("csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("name", [name for name, *_ in COLUMNS])
def test_csv_has_the_histories_of_the_plant_to_the_last_bit(flight, rows, name):
    history = flight.truth[name].reshape(len(rows), -1)
    endings = {1: [""], 3: ["_x", "_y", "_z"], 4: ["_w", "_x", "_y", "_z"]}[history.shape[1]]
    assert [[float(row[name + ending]) for ending in endings] for row in rows] == history.tolist()


def test_csv_has_the_torques_of_each_source(flight, rows):
    torque = flight.truth["torque_body_nm/coils"]
    assert [float(row["torque_body_nm_coils_z"]) for row in rows] == torque[:, 2].tolist()
    assert np.any(torque)


def test_csv_has_the_estimates_of_the_replay(flight, rows):
    """The last of them is that of the last NAV_ATTITUDE, whose bits are of 2^-16."""
    assert rows[0]["estimate_q_body_from_orbit_w"] != rows[-1]["estimate_q_body_from_orbit_w"] != ""
    on_bus = [entry.frame for entry in flight.entries if entry.frame.can_id == 0x200][-1]
    word = int.from_bytes(on_bus.data, "little")
    raw = [(word >> start & 0x1FFFF) - (0x20000 if word >> start & 0x10000 else 0) for start in (5, 22, 39)]
    ours = [float(rows[-1][f"estimate_q_body_from_orbit_{axis}"]) for axis in "xyz"]
    assert ours == pytest.approx([2.0**-16 * value for value in raw], abs=2.0**-16)
    assert 0.0 < float(rows[-1]["estimate_error_deg"]) < float(rows[-1]["estimate_sigma3_deg"]) < 10.0
    assert {row["mode"] for row in rows} <= {"0.0", "1.0", "2.0", "3.0"}
    assert rows[-1]["estimate_valid"] == "1.0"


@pytest.mark.long
def test_parquet_is_the_same_table_with_units(flight, exported, rows):
    table = pq.read_table(exported("parquet"))
    assert table.column_names == list(rows[0])
    for name in table.column_names:
        ours = ["" if value is None else repr(value) for value in table[name].to_pylist()]
        assert ours == [row[name] for row in rows], name
    assert table.schema.field("b_body_t_x").metadata[b"unit"] == b"T"
    assert table.schema.metadata[b"scenario"] == b"microsat"
    assert table.schema.metadata[b"seed"] == b"5"


@pytest.mark.long
def test_ticks_that_were_not_replayed_have_no_estimate(cut, tmp_path):
    notes = write_csv(open_source(cut), tmp_path / "out.csv", lambda done: None)
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 400
    assert rows[-1]["estimate_q_body_from_orbit_w"] == rows[-1]["mode"] == rows[-1]["estimate_valid"] == ""
    assert rows[100]["mode"] != ""
    replayed = sum(row["mode"] != "" for row in rows)
    assert 100 < replayed < 400
    assert any(f"of 400 ticks the histories have 400, the log {replayed}; it ends" in note for note in notes)
    write_parquet(open_source(cut), tmp_path / "out.parquet", lambda done: None)
    modes = pq.read_table(tmp_path / "out.parquet")["mode"].to_pylist()
    assert [value is None for value in modes] == [row["mode"] == "" for row in rows]
