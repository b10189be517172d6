"""Files are replaced at once, by way of a file that nobody else can have prepared."""

import os
import secrets
import stat
import subprocess
import sys

import pytest

from sim.record.whole_file import replace_file, replace_text, replacing

KILLED = """
import os, signal, sys
from pathlib import Path
from sim.record.whole_file import replacing
with replacing(Path(sys.argv[1])) as path:
    path.write_text("half of")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def left_over(tmp_path):
    """The temporary file of a process that was killed."""
    subprocess.run([sys.executable, "-c", KILLED, tmp_path / "run.csv"], check=False)
    (path,) = tmp_path.iterdir()
    assert path.read_text() == "half of"
    return path


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_the_file_is_replaced_and_alone(tmp_path):
    (tmp_path / "a").write_text("old")
    replace_file(tmp_path / "a", b"new")
    replace_text(tmp_path / "b", "\N{DEGREE SIGN}")
    assert (tmp_path / "a").read_bytes() == b"new"
    assert (tmp_path / "b").read_text(encoding="utf-8") == "\N{DEGREE SIGN}"
    assert names(tmp_path) == {"a", "b"}


@pytest.mark.parametrize("dangling", [False, True])
def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path, dangling):
    there, link = tmp_path / "there", tmp_path / "link"
    if not dangling:
        there.write_text("precious")
    link.symlink_to(there)
    replace_file(link, b"new")
    assert not link.is_symlink()
    assert link.read_bytes() == b"new"
    assert there.exists() is not dangling
    assert dangling or there.read_text() == "precious"


def test_the_temporary_file_is_another_each_time_and_not_foreseen(tmp_path):
    seen = set()
    for _ in range(20):
        with replacing(tmp_path / "a") as path:
            seen.add(path)
            assert path.parent == tmp_path
            assert stat.S_ISREG(path.lstat().st_mode)
    assert len(seen) == 20
    assert all(len(path.stem.rpartition("-")[2]) == 16 for path in seen)


def test_a_name_that_is_taken_is_never_used(tmp_path, monkeypatch):
    with replacing(tmp_path / "a") as path:
        pass
    monkeypatch.setattr(secrets, "token_hex", lambda size: path.stem.rpartition("-")[2])
    (tmp_path / "precious").write_text("precious")
    path.symlink_to(tmp_path / "precious")
    with pytest.raises(FileExistsError):
        replace_file(tmp_path / "a", b"new")
    assert (tmp_path / "precious").read_text() == "precious"
    path.unlink()
    path.symlink_to(tmp_path / "nowhere")
    with pytest.raises(FileExistsError):
        replace_file(tmp_path / "a", b"new")
    assert names(tmp_path) == {"a", "precious", path.name}


def test_it_has_the_rights_of_any_new_file(tmp_path):
    (tmp_path / "ordinary").write_text("")
    replace_file(tmp_path / "a", b"")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "ordinary").stat().st_mode


def test_a_block_that_fails_leaves_the_file_as_it_was(tmp_path):
    (tmp_path / "a").write_text("old")
    with pytest.raises(TypeError), replacing(tmp_path / "a") as path:
        path.write_text(None)
    assert (tmp_path / "a").read_text() == "old"
    assert names(tmp_path) == {"a"}


def test_a_kill_leaves_the_file_as_it_was_and_the_next_clears_up(left_over):
    replace_file(left_over.with_name("other"), b"all")
    assert names(left_over.parent) == {"other"}


def test_what_belongs_to_others_stays(left_over):
    _, machine, process, token = left_over.stem.split("-")
    others = {
        f".torquer-{machine}-{os.getpid()}-{token}.part",  # of a process that runs
        f".torquer-{machine}-1-{token}.part",
        f".torquer-{machine}x-{process}-{token}.part",  # of another machine that shares the folder
        f".torquer-{machine}-{process}.part",
        f".torquer-{machine}-mine-{token}.part",
        "torquer.part",
    }
    for name in others:
        left_over.with_name(name).write_text("theirs")
    replace_file(left_over.with_name("a"), b"all")
    assert names(left_over.parent) == others | {"a"}
