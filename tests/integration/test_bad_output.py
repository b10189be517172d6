"""Places that cannot be written: one sentence and exit code 2, before any work is done."""

import os
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from sim.record import run_dir

LONGEST_S = 5.0
NOBODY = 65534


@pytest.fixture(params=["below a file", "proc", "a device"])
def nowhere(request, tmp_path):
    """A place where no folder can be made, not even by root."""
    (tmp_path / "file").write_text("kept")
    return {"below a file": tmp_path / "file" / "x", "proc": Path("/proc/x"), "a device": Path("/dev/full")}[
        request.param
    ]


@pytest.mark.parametrize(
    "words",
    [
        ("sil", "--bus", "virtual"),
        ("validate", "--quick"),
        ("design", "microsat"),
        ("design", "microsat", "--json"),
        ("compare",),
        ("faults",),
        ("hil", "--seconds", "2"),
    ],
    ids=" ".join,
)
def test_an_out_that_cannot_be_written_is_refused_before_any_work(words, nowhere, torquer):
    began = time.process_time()
    done = torquer(*words, "--out", nowhere)
    assert time.process_time() - began < LONGEST_S
    assert (done.code, done.out) == (2, "")
    assert str(nowhere) in done.sentence or str(nowhere.parent) in done.sentence
    assert "cannot be written" in done.sentence


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (("compare", "--out", "out"), "compare.png"),
        (("faults", "--out", "out"), "faults.html"),
        (("design", "microsat", "--out", "out"), "robustness.png"),
        (("hil", "--out", "out"), "hil.json"),
        (("validate", "--quick", "--out", "out/page.md"), "page.md"),
        (("sil", "--bus", "virtual", "--out", "out"), "bus.log.index"),
    ],
)
def test_so_is_a_folder_in_the_way_of_a_file(words, name, torquer, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out" / name).mkdir(parents=True)
    done = torquer(*words)
    assert (done.code, done.out) == (2, "")
    assert "out" in done.sentence


@pytest.mark.parametrize("name", ["summary.json", "report.html"])
def test_a_report_that_cannot_be_written(run, torquer, name):
    (run / name).unlink()
    (run / name).mkdir()
    before = (run / "run.json").read_bytes()
    done = torquer("report", run)
    assert done.code == 2
    assert f"{name}: cannot be written (Is a directory)" in done.sentence
    assert (run / "run.json").read_bytes() == before


@contextmanager
def read_only(folder):
    """For root, which may write everywhere, another user."""
    folder.chmod(0o555)
    is_root = os.geteuid() == 0
    if is_root:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        if is_root:
            os.seteuid(0)
        folder.chmod(0o755)


@pytest.mark.long
def test_a_report_in_a_folder_that_is_read_only(run, torquer):
    assert torquer("report", run).code == 0  # everything is imported, which nobody may not do
    with tempfile.TemporaryDirectory(dir="/tmp") as place:
        os.chmod(place, 0o755)
        copy = Path(place) / "run"
        copy.mkdir()
        for file in run.iterdir():
            (copy / file.name).write_bytes(file.read_bytes())
        with read_only(copy):
            done = torquer("report", copy)
    assert done.code == 2
    assert f"{copy}: cannot be written (Permission denied)" in done.sentence


def test_gains_into_a_scenario_that_is_read_only(torquer):
    with tempfile.TemporaryDirectory(dir="/tmp") as place:
        os.chmod(place, 0o755)
        folder = Path(place) / "mine"
        folder.mkdir()
        shipped = Path(run_dir.__file__).parents[1] / "scenario" / "shipped" / "microsat.toml"
        (folder / "mine.toml").write_bytes(shipped.read_bytes())
        with read_only(folder):
            done = torquer("design", folder / "mine.toml", "--json", "--write")
    assert (done.code, done.out) == (2, "")
    assert "cannot be written (Permission denied)" in done.sentence
