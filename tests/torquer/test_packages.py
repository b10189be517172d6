"""``import torquer``: quick, whole, and from its own packages whatever folders the user has."""

import json
import subprocess
import sys

import pytest

import torquer

LIST_LOADED = "import json, sys, torquer; print(json.dumps(sorted(sys.modules)))"
BROKEN = "raise RuntimeError('the package of a user')"


@pytest.fixture
def folder(tmp_path):
    """A folder of a user who has packages of the same names."""
    for name in ("fsw", "hil_stub", "sim"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(BROKEN)
    return tmp_path


def run(folder, *words):
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder), "OPENBLAS_NUM_THREADS": "1"}
    words = [sys.executable, *words]
    return subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_importing_it_loads_nothing_heavy(tmp_path):
    loaded = json.loads(run(tmp_path, "-c", LIST_LOADED).stdout)
    assert {"numpy", "pydantic", "click", "sim", "torquer.api"}.isdisjoint(loaded)


def test_every_name_is_there():
    assert dir(torquer) == sorted(torquer._MODULES) == torquer.__all__
    for name in torquer.__all__:
        assert getattr(torquer, name).__doc__
    with pytest.raises(AttributeError, match="nothing"):
        torquer.nothing  # noqa: B018  to be asked for is to fail


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        ("sil", "microsat", "--bus", "loop", "--orbits", "0.005", "--out", "run"),
        ("campaign", "microsat", "--runs", "2", "--workers", "2", "--orbits", "0.005", "--out", "campaign"),
    ],
    ids=["sil", "campaign"],
)
@pytest.mark.slow
def test_a_folder_called_sim_harms_no_command_and_none_of_its_processes(words, folder):
    done = run(folder, "-m", "torquer", *words)
    assert "user" not in done.stderr
    assert done.returncode == 0


def test_a_script_beside_a_file_of_that_name_is_told_which_it_is(tmp_path):
    (tmp_path / "fsw.py").write_text(BROKEN)
    (tmp_path / "script.py").write_text("import torquer\ntorquer.fly")
    last = run(tmp_path, "script.py").stderr.splitlines()[-1]
    assert f"{tmp_path / 'fsw.py'} comes first" in last


def test_a_script_beside_such_a_folder_is_told_which_it_is(folder):
    (folder / "script.py").write_text("import torquer\ntorquer.fly")
    done = run(folder, "script.py")
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("ImportError: torquer needs ")
    assert f"{folder / 'fsw'} comes first" in last
