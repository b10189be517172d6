"""An export leaves a whole file or none, and clears up after those that were killed."""

import os
import subprocess
import sys

import pytest

from sim.errors import HarnessError
from sim.export.destination import whole_file, write_text

KILLED = """
import os, signal, sys
from pathlib import Path
from sim.export.destination import whole_file
with whole_file(Path(sys.argv[1]), False) as path:
    path.write_text("half of")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def left_over(tmp_path):
    """The temporary file of an export that was killed."""
    subprocess.run([sys.executable, "-c", KILLED, tmp_path / "run.csv"], check=False)
    (path,) = tmp_path.iterdir()
    assert path.read_text() == "half of"
    return path


def test_the_next_export_removes_what_a_killed_one_left(left_over):
    write_text(left_over.with_name("other.csv"), "all", force=False)
    assert [path.name for path in left_over.parent.iterdir()] == ["other.csv"]


def test_what_belongs_to_others_stays(left_over):
    machine = left_over.name.split("-")[1]
    others = {
        f".torquer-{machine}-{os.getpid()}.part",  # of a process that runs
        f".torquer-{machine}-1.part",
        f".torquer-{machine}x-{2**22 + 1}.part",  # of another machine that shares the folder
        f".torquer-{machine}-mine.part",
        "torquer.part",
    }
    for name in others:
        left_over.with_name(name).write_text("theirs")
    with whole_file(left_over.with_name("run.mcap"), False) as path:
        path.write_text("all")
    mine = {f".torquer-{machine}-{os.getpid()}.part"}  # it took the name of the own one
    assert {path.name for path in left_over.parent.iterdir()} == others - mine | {"run.mcap"}


def test_a_block_that_fails_leaves_nothing(tmp_path):
    with pytest.raises(TypeError), whole_file(tmp_path / "run.csv", False) as path:
        path.write_text(None)  # it opens the file first
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_is_kept_without_force(tmp_path):
    write_text(tmp_path / "run.csv", "old", force=False)
    with pytest.raises(HarnessError, match="already exists: name another file"):
        write_text(tmp_path / "run.csv", "new", force=False)
    assert (tmp_path / "run.csv").read_text() == "old"
    write_text(tmp_path / "run.csv", "new", force=True)
    assert (tmp_path / "run.csv").read_text() == "new"
