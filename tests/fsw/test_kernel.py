"""A kernel flies only if it was built from the source that is there."""

import shutil
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES

import pytest

from fsw import kernel
from fsw.kernel import FOLDER, KERNEL, SOURCE, refuse_stale_kernel

BINARY = f"_kalman_kernel{EXTENSION_SUFFIXES[0]}"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A source, and a binary that holds its digest; what is imported stays as it is."""
    monkeypatch.setitem(sys.modules, KERNEL, sys.modules.get(KERNEL))
    monkeypatch.delitem(sys.modules, KERNEL)
    digest = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
    (tmp_path / SOURCE).write_bytes(b"test")
    (tmp_path / BINARY).write_bytes(b"\x7fELF" + digest.encode() + b"\x00")
    return tmp_path


def test_a_kernel_of_this_source_is_imported(folder):
    refuse_stale_kernel(folder)
    assert KERNEL not in sys.modules


def test_one_of_another_source_is_not(folder):
    (folder / SOURCE).write_bytes(b"another")
    refuse_stale_kernel(folder)
    assert sys.modules[KERNEL] is None


@pytest.mark.parametrize("missing", [SOURCE, BINARY])
def test_nothing_is_stale_where_one_of_the_two_is_missing(missing, folder):
    (folder / missing).unlink()
    refuse_stale_kernel(folder)
    assert KERNEL not in sys.modules


@pytest.mark.long
def test_a_flight_with_a_stale_kernel_is_by_filterpy(tmp_path):
    """A whole copy of the package, its source changed by a comment."""
    shutil.copytree(FOLDER.parents[1], tmp_path / "fsw")
    source = tmp_path / "fsw" / "core" / "estimation" / SOURCE
    source.write_text(source.read_text() + "/* changed */\n")
    asked = "from fsw.core.estimation.kalman import Algebra, available; print(available(Algebra.KERNEL))"
    done = subprocess.run(
        [sys.executable, "-c", asked], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "filterpy"
    assert kernel.FOLDER == FOLDER
