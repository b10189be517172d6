"""truth.h5: what is written reads back, with units, and a kill at any moment leaves the complete rows."""

import os
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

from sim.errors import HarnessError
from sim.plant.dynamics.torques import SOURCES
from sim.plant.plant import TruthRow
from sim.record import truth as truth_module
from sim.record.truth import (
    BLOCK_ROWS,
    COLUMNS,
    GrowingTruth,
    RowsMissingError,
    TruthFile,
    TruthReader,
    read_truth,
)


def row(tick):
    """A row in which every number differs from every other and from those of other rows."""
    numbers = iter(tick + 0.01 * np.arange(1, 34))

    def some(count):
        return tuple(float(next(numbers)) for _ in range(count))

    return TruthRow(
        t_s=float(tick),
        q_body_from_orbit=some(4),
        omega_body_orbit_radps=some(3),
        b_body_t=some(3),
        sun_body=some(3),
        lit=0.001 * tick,
        m_body_am2=some(3),
        r_eci_m=some(3),
        torque_body_nm=(some(3), some(3), some(3), some(3)),
    )


def write(path, ticks, rows):
    with TruthFile(path, ticks, SOURCES) as truth:
        for tick in range(rows):
            truth.append(row(tick))


def assert_rows(histories, rows):
    for tick in range(rows):
        expected = row(tick)
        for name, width, *_ in COLUMNS:
            value = histories[name][tick]
            assert tuple(np.atleast_1d(value)) == tuple(np.atleast_1d(getattr(expected, name))), (name, tick)
            assert np.size(value) == width
        for source, torque in zip(SOURCES, expected.torque_body_nm, strict=True):
            assert tuple(histories[f"torque_body_nm/{source}"][tick]) == torque


@pytest.mark.parametrize("rows", [1, 2, BLOCK_ROWS - 1, BLOCK_ROWS, BLOCK_ROWS + 1, 3 * BLOCK_ROWS + 7])
def test_what_is_written_reads_back_to_the_last_bit(tmp_path, rows):
    write(tmp_path / "truth.h5", rows, rows)
    histories = read_truth(tmp_path / "truth.h5")
    assert {len(history) for history in histories.values()} == {rows}
    assert_rows(histories, rows)


def test_a_flight_that_ended_early_has_the_rows_it_flew(tmp_path):
    write(tmp_path / "truth.h5", 1000, 300)
    histories = read_truth(tmp_path / "truth.h5")
    assert {len(history) for history in histories.values()} == {300}
    assert_rows(histories, 300)


def test_a_flight_that_never_flew_has_none(tmp_path):
    write(tmp_path / "truth.h5", 1000, 0)
    assert {len(history) for history in read_truth(tmp_path / "truth.h5").values()} == {0}


def test_rows_that_have_not_been_written_are_missed(tmp_path):
    write(tmp_path / "truth.h5", 3 * BLOCK_ROWS, BLOCK_ROWS)
    growing = GrowingTruth(tmp_path / "truth.h5", 3 * BLOCK_ROWS)
    assert_rows(growing.rows(0, BLOCK_ROWS), BLOCK_ROWS)
    with pytest.raises(RowsMissingError, match=f"rows 0 to {BLOCK_ROWS} have not been written"):
        growing.rows(0, BLOCK_ROWS + 1)


def test_rows_that_one_history_lacks_are_missed(tmp_path):
    """Between two datasets of a flush."""
    write(tmp_path / "truth.h5", 100, 60)
    with h5py.File(tmp_path / "truth.h5", "r+") as file:
        file["r_eci_m"][50:60] = np.nan
    growing = GrowingTruth(tmp_path / "truth.h5", 100)
    assert_rows(growing.rows(0, 50), 50)
    with pytest.raises(RowsMissingError, match="rows 40 to 50"):
        growing.rows(40, 51)


@pytest.mark.parametrize("rows", [1, BLOCK_ROWS + 3])
def test_the_momentum_of_a_driven_wheel_has_a_history_of_its_own(tmp_path, rows):
    path = tmp_path / "truth.h5"
    with TruthFile(path, rows + 5, SOURCES, wheel=True) as truth:
        for tick in range(rows):
            truth.append(row(tick).replace(wheel_nms=-0.25 * tick - 1.0))
    histories = read_truth(path)
    assert_rows(histories, rows)
    assert histories["wheel_nms"].tolist() == [-0.25 * tick - 1.0 for tick in range(rows)]
    with h5py.File(path) as file:
        assert file["wheel_nms"].attrs["unit"] == "N m s"


@pytest.mark.parametrize("value", [2e15, -2e15])
def test_a_magnitude_that_no_history_has_is_refused(tmp_path, value):
    write(tmp_path / "truth.h5", 5, 5)
    with h5py.File(tmp_path / "truth.h5", "r+") as file:
        file["r_eci_m"][3, 1] = value
    with pytest.raises(HarnessError, match="r_eci_m holds a magnitude above 1e"):
        read_truth(tmp_path / "truth.h5")


def test_it_is_read_beside_a_file_of_the_user_that_is_open(tmp_path):
    path = tmp_path / "truth.h5"
    write(path, 5, 5)
    with h5py.File(path) as file:
        assert_rows(read_truth(path), 5)
        assert file["t_s"].shape == (5,)


READ = """
import sys
from pathlib import Path
from sim.record.truth import GrowingTruth

path, rows, past = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
growing = GrowingTruth(Path(path), rows)
print(growing.complete, growing.rows(0, past)["t_s"].tolist())
"""


@pytest.mark.long
def test_rows_that_another_process_still_writes_are_read_as_they_are_written(tmp_path, monkeypatch):
    """However long the reader takes: it is the length of a block that has it written here, not its age."""
    monkeypatch.setattr(truth_module.time, "monotonic", lambda: 0.0)
    path, rows = tmp_path / "truth.h5", 3 * BLOCK_ROWS

    def read(past):
        command = (sys.executable, "-c", READ, path, str(rows), str(past))
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    with TruthFile(path, rows, SOURCES) as truth:
        for tick in range(2 * BLOCK_ROWS):
            truth.append(row(tick))
            if tick + 1 in (BLOCK_ROWS, 2 * BLOCK_ROWS):
                assert read(tick + 1) == f"{rows} {[row(before).t_s for before in range(tick + 1)]}"


@pytest.mark.long
def test_blocks_of_a_cut_file_are_those_of_the_whole(tmp_path):
    path, rows = tmp_path / "truth.h5", 2 * BLOCK_ROWS + 5
    write(path, 4 * BLOCK_ROWS, rows)
    with TruthReader(path) as reader:
        assert reader.complete == rows
        parts = [reader.rows(first, min(first + 100, rows)) for first in range(0, rows, 100)]
    assert_rows({name: np.concatenate([part[name] for part in parts]) for name in parts[0]}, rows)


def test_names_and_units_are_those_of_the_contract(tmp_path):
    write(tmp_path / "truth.h5", 5, 5)
    units = {}
    with h5py.File(tmp_path / "truth.h5") as file:
        file.visititems(
            lambda name, item: units.update({name: item.attrs["unit"]} if hasattr(item, "shape") else {})
        )
        assert all("meaning" in file[name].attrs for name in units)
    assert units == {
        "t_s": "s",
        "q_body_from_orbit": "1",
        "omega_body_orbit_radps": "rad/s",
        "b_body_t": "T",
        "sun_body": "1",
        "lit": "1",
        "m_body_am2": "A m^2",
        "r_eci_m": "m",
        **{f"torque_body_nm/{source}": "N m" for source in SOURCES},
    }


IDENTITY = {"scenario": "microsat", "seed": 2**64 - 1, "epoch_unix_s": 1742000000, "tick_hz": 10}


def test_the_file_says_which_flight_it_is_of(tmp_path):
    path = tmp_path / "truth.h5"
    with TruthFile(path, 20, SOURCES, IDENTITY) as truth:
        truth.append(row(0))
    with TruthReader(path) as reader:
        assert reader.attributes == IDENTITY
    assert_rows(read_truth(path), 1)


def test_a_file_without_that_is_read_as_before(tmp_path):
    write(tmp_path / "truth.h5", 20, 20)
    with TruthReader(tmp_path / "truth.h5") as reader:
        assert (reader.attributes, reader.complete) == ({}, 20)


def test_a_flush_cut_between_two_datasets_leaves_the_rows_that_are_whole(tmp_path):
    write(tmp_path / "truth.h5", 100, 60)
    with h5py.File(tmp_path / "truth.h5", "r+") as file:
        file["r_eci_m"][50:60] = np.nan
        file["torque_body_nm/coils"][55, 2] = np.nan
    histories = read_truth(tmp_path / "truth.h5")
    assert {len(history) for history in histories.values()} == {50}
    assert_rows(histories, 50)


class TestNoTruth:
    def fault(self, path):
        with pytest.raises(HarnessError) as caught:
            read_truth(path)
        assert str(path) in str(caught.value)
        assert caught.value.exit_code == 2
        return str(caught.value)

    def test_missing(self, tmp_path):
        assert "cannot be read as plant histories" in self.fault(tmp_path / "truth.h5")

    def test_something_else(self, tmp_path):
        file = tmp_path / "truth.h5"
        file.write_bytes(b"not hdf5")
        self.fault(file)

    def test_an_hdf5_file_of_something_else(self, tmp_path):
        with h5py.File(tmp_path / "truth.h5", "w") as file:
            file["x"] = [1.0, 2.0]
        self.fault(tmp_path / "truth.h5")


CHILD = """
import sys
from pathlib import Path
sys.path.insert(0, {folder!r})
from test_truth import row
from sim.record.truth import TruthFile
from sim.plant.dynamics.torques import SOURCES
with TruthFile(Path({path!r}), 100_000, SOURCES) as truth:
    for tick in range(100_000):
        print(tick, flush=True)
        truth.append(row(tick))
"""


def test_in_real_time_rows_are_never_a_second_behind(tmp_path, monkeypatch):
    now_s = 100.0
    monkeypatch.setattr(truth_module.time, "monotonic", lambda: now_s)
    path = tmp_path / "truth.h5"
    with TruthFile(path, 40, SOURCES) as truth:
        for tick in range(40):
            now_s += 0.125
            truth.append(row(tick))
            with h5py.File(path, "r+") as file:
                assert np.isfinite(file["t_s"][:]).sum() == (tick + 1) // 4 * 4
    assert_rows(read_truth(path), 40)


@pytest.mark.long
@pytest.mark.parametrize("tick", [0, 200, BLOCK_ROWS, 3 * BLOCK_ROWS - 1, 1000])
def test_a_kill_leaves_a_file_that_opens_with_whole_rows(tmp_path, tick):
    """At most the block that waits is lost."""
    path = tmp_path / "truth.h5"
    code = CHILD.format(folder=os.path.dirname(__file__), path=str(path))
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    while int(process.stdout.readline()) < tick:
        pass
    process.send_signal(signal.SIGKILL)
    assert process.wait(20) == -signal.SIGKILL
    process.stdout.close()
    histories = read_truth(path)
    (rows,) = {len(history) for history in histories.values()}
    assert tick - BLOCK_ROWS < rows < 100_000
    assert_rows(histories, rows)
