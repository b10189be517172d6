"""An export leaves a whole file or none."""

import pytest

from sim.errors import HarnessError
from sim.export.destination import whole_file, write_text


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
