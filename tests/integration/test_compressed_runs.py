"""A run whose log is compressed is the same run: every tool reads both, and each may become the other."""

import gzip
import json
import os
import signal
import subprocess
import sys
import time

import pytest

from fsw.wire.messages import MagField
from hil_stub.process.stimulus_option import stimulus_of
from sim.flight.sil import last_tick
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.report import follow as following
from sim.scenario.schema import load
from tests.integration.conftest import TINY

PLAIN, COMPRESSED = run_dir.BUS_LOG, run_dir.COMPRESSED_LOG


@pytest.fixture
def run(sil_run, tmp_path):
    """A copy of a compressed run of 30 ticks."""
    folder = tmp_path / "run"
    folder.mkdir()
    for file in sil_run(*TINY, "--compress").iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    return folder


def without(out, *words):
    """The lines of an output that have none of these words."""
    return [line for line in out.splitlines() if not any(word in line for word in words)]


def test_it_differs_from_a_plain_one_in_how_its_log_is_stored_alone(run, sil_run):
    plain = sil_run(*TINY)
    assert not (run / PLAIN).exists()
    assert gzip.decompress((run / COMPRESSED).read_bytes()) == (plain / PLAIN).read_bytes()
    assert (run / run_dir.TRUTH).read_bytes() == (plain / run_dir.TRUTH).read_bytes()
    ours, theirs = run_dir.read_run(run), run_dir.read_run(plain)
    assert (ours["compressed"], theirs["compressed"]) == (True, False)
    assert ours["digests"][PLAIN] == theirs["digests"][PLAIN]


@pytest.mark.parametrize("log_alone", [False, True])
@pytest.mark.parametrize("command", ["check", "replay"])
def test_the_tools_say_of_it_what_they_say_of_a_plain_one(run, sil_run, torquer, command, log_alone):
    plain = sil_run(*TINY)
    ours = torquer(command, run / COMPRESSED if log_alone else run)
    theirs = torquer(command, plain / PLAIN if log_alone else plain)
    assert (ours.code, ours.out, ours.err) == (theirs.code, theirs.out, theirs.err)
    assert ours.code == 0


@pytest.mark.long
def test_it_is_reported_again(run, torquer):
    summary = (run / run_dir.SUMMARY).read_bytes()
    assert torquer("report", run).code == 0
    assert (run / run_dir.SUMMARY).read_bytes() == summary
    assert torquer("check", run).code == 0


def test_it_may_be_unpacked_and_a_plain_one_packed(run, torquer):
    (run / PLAIN).write_bytes(gzip.decompress((run / COMPRESSED).read_bytes()))
    (run / COMPRESSED).unlink()
    assert torquer("check", run).code == 0
    assert torquer("replay", run).code == 0
    with gzip.open(run / COMPRESSED, "wb", 9) as file:
        file.write((run / PLAIN).read_bytes())
    (run / PLAIN).unlink()
    assert torquer("check", run).code == 0
    assert torquer("replay", run).code == 0


@pytest.mark.parametrize("command", ["check", "replay"])
def test_one_that_was_altered_and_packed_again_fails(run, torquer, command):
    text = gzip.decompress((run / COMPRESSED).read_bytes())
    (run / COMPRESSED).write_bytes(gzip.compress(text.replace(b"#", b"#0", 1)))
    assert torquer(command, run).code != 0
    (run / COMPRESSED).write_bytes(gzip.compress(text.replace(b"000A", b"000B", 1)))
    assert torquer(command, run).code == 1


def test_one_that_is_damaged_is_one_sentence(run, torquer):
    stored = bytearray((run / COMPRESSED).read_bytes())
    stored[len(stored) // 2] ^= 0xFF
    (run / COMPRESSED).write_bytes(stored)
    for command in ("check", "replay"):
        outcome = torquer(command, run)
        assert outcome.code == 2
        assert "bus.log.gz: cannot be read (its compressed text is damaged)" in outcome.sentence


def test_a_sensor_shows_what_one_has_recorded(run, sil_run):
    def shown(folder):
        stimulus = stimulus_of((str(folder),), "field_nt", MagField, 1, 1.0, lambda vector: vector)
        return [stimulus(tick) for tick in range(30)]

    assert shown(run) == shown(sil_run(*TINY))
    assert shown(run)[5].valid


def test_a_run_is_not_begun_where_there_is_one(run, torquer):
    (run / run_dir.RUN).unlink()
    outcome = torquer("sil", *TINY, "--out", run)
    assert outcome.code == 2
    assert "already holds a run" in outcome.sentence


@pytest.mark.long
@pytest.mark.slow
def test_a_flight_of_two_processes_is_followed_and_its_progress_known(tmp_path, torquer, monkeypatch):
    """The replay in another process reads the log as it grows."""
    monkeypatch.setattr(following, "LEAST_TICKS", 100)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    path = tmp_path / "run"
    outcome = torquer("sil", "microsat", "--orbits", "0.3", "--bus", "loop", "--compress", "--out", path)
    assert outcome.code == 0
    assert json.loads((path / run_dir.SUMMARY).read_text())["replay"]["bit_exact"] is True
    ticks = run_dir.read_run(path)["ticks"]
    assert last_tick(path, load("microsat")) == ticks
    assert torquer("check", path).code == 0


@pytest.mark.long
def test_one_that_is_killed_leaves_whole_ticks(tmp_path, torquer):
    path = tmp_path / "run"
    words = ("sil", "microsat", "--bus", "virtual", "--orbits", "5", "--compress", "--out", str(path))
    process = subprocess.Popen(
        [sys.executable, "-m", "torquer", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while not ((path / COMPRESSED).exists() and (path / COMPRESSED).stat().st_size > 50_000):
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert len(list(whole_entries(path / COMPRESSED))) > 1000
    outcome = torquer("check", path)
    assert outcome.code == 1
    killed = (  # where: between two blocks, within one, between one and its line of the index
        "the flight did not come to its end, and its last second may be missing",
        " is incomplete; the lines before it are judged",
        "nothing vouches for what follows line ",
    )
    assert any(sentence in outcome.out for sentence in killed)
    assert "incomplete" in outcome.out.splitlines()[-1]
