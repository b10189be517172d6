"""``python -m hil_stub``: one board on a bus, as a process."""

import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fsw.bus.open_bus import open_bus
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import (
    CLASSES,
    CoilBoot,
    CoilEvent,
    CoilStatus,
    MagBoot,
    MagField,
    PlantEnd,
    SunBoot,
    SunCells,
    SunVector,
    Sync,
    TickDone,
)
from hil_stub.__main__ import main

ROOT = Path(__file__).parents[2]


@pytest.fixture
def spec():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"loop:{free.getsockname()[1]}"


@pytest.fixture
def bus(spec):
    bus = open_bus(spec)
    yield bus
    bus.close()


@pytest.fixture
def start(spec, bus):
    """Starts a board on the bus; a process that has not ended by itself is ended after the test."""
    started = []

    def run(*arguments):
        command = [sys.executable, "-m", "hil_stub", arguments[0], "--bus", spec, *arguments[1:]]
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        started.append(process)
        return process

    yield run
    for process in started:
        process.kill()
        process.communicate()


def hear(bus, count):
    frames = [bus.receive(120.0) for _ in range(count)]
    assert None not in frames, f"the board fell silent after {frames.index(None)} of {count} frames"
    return [CLASSES[frame.can_id].decode(frame.data) for frame in frames]


BOARDS = [
    (("coil", "--backoff", "per_coil"), CoilBoot, CoilStatus),
    (("magnetometer", "--stimulus", "100", "-200", "300"), MagBoot, MagField),
    (("sun", "--stimulus", "0", "0", "-5"), SunBoot, SunVector),
    (("cells", "--stimulus", "0.5", "0", "1", "0.25", "3", "0"), SunBoot, SunCells),
]


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "boot", "sample"), BOARDS, ids=["coil", "magnetometer", "sun", "cells"]
)
def test_it_follows_the_bus_whatever_end_a_plant_tells_of(bus, start, arguments, boot, sample):
    process = start(*arguments)
    assert [type(message) for message in hear(bus, 2)] == [boot, sample]
    for tick in range(50):
        bus.send([PlantEnd(tick + 1).encode(), Sync(tick, 0).encode(), TickDone(tick, 0).encode()])
        (message,) = hear(bus, 1)
        assert (type(message), message.counter) == (sample, (tick + 1) % 16)
    if sample is MagField:
        assert message.values()[:4] == (1, 100.0, -200.0, 300.0)
    if sample is SunVector:
        assert message.values()[:4] == (1, 0.0, 0.0, -1.0)
    if sample is SunCells:
        assert message.values()[:7] == (1, 0.5, 0.0, 1.0, 0.25, 255.0 / 128.0, 0.0)
    assert process.poll() is None


@pytest.mark.long
def test_it_says_which_bus_it_is_on_and_ctrl_c_ends_it_cleanly(bus, start, spec):
    process = start("coil")
    hear(bus, 2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20.0)
    assert process.returncode == 0
    assert errors == f"on {spec}\n"


@pytest.mark.long
def test_a_bus_that_goes_away_ends_it_with_one_sentence(bus, start, spec):
    process = start("sun")
    hear(bus, 2)
    bus.close()
    _, errors = process.communicate(timeout=20.0)
    assert process.returncode == 1
    (_, sentence) = errors.splitlines()
    assert "Traceback" not in sentence


@pytest.mark.long
def test_a_board_whose_starter_is_gone_ends(bus, spec):
    command = [sys.executable, "-m", "hil_stub", "--parent", "1", "sun", "--bus", spec]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        assert process.wait(20.0) == 0
    finally:
        process.kill()
        process.wait()


def exchange(bus, tick):
    """A tick on the bus: what the board says in the next."""
    bus.send([Sync(tick, 0).encode(), TickDone(tick, 0).encode()])
    return hear(bus, 1)[0]


@pytest.mark.long
def test_a_sensor_shows_a_recorded_run_and_a_script(bus, start, tmp_path):
    log = [format_line(format_time(0), "vcan0", frame) for frame in recorded_frames()]
    (tmp_path / "bus.log").write_text("".join(log))
    process = start("magnetometer", "--stimulus", str(tmp_path))
    assert hear(bus, 2)[1].values()[:4] == (1, 0.0, 100.0, -200.0)
    assert exchange(bus, 0).values()[:4] == (1, 2.0, 100.0, -200.0)
    process.kill()
    script = tmp_path / "script.toml"
    script.write_text("[[step]]\nt_s = 0.0\nsun = [0, -2, 0]\n[[step]]\nt_s = 0.1\nsun = false\n")
    start("sun", "--tick-hz", "10", "--stimulus", str(script))
    assert hear(bus, 2)[1].values()[:4] == (1, 0.0, -1.0, 0.0)
    assert exchange(bus, 0).values()[:4] == (0, 0.0, 0.0, 0.0)


def recorded_frames():
    for tick in range(3):
        yield MagField(1, 2.0 * tick, 100.0, -200.0).encode()
        yield Sync(tick, 0).encode()


@pytest.mark.long
def test_the_dead_man_wakes_when_the_bus_falls_silent(bus, start):
    start("coil", "--deadman-s", "0.2", "--clock", "ticks")
    hear(bus, 2)
    for tick in range(20):
        status = exchange(bus, tick)
    assert status.lockout_ms == 80_000
    time.sleep(0.5)
    bus.send([Sync(20, 0).encode(), TickDone(20, 0).encode()])
    status, event = hear(bus, 2)
    assert (status.lockout_ms, type(event)) == (99_000, CoilEvent)


@pytest.mark.long
def test_with_a_clock_of_its_own_fast_ticks_do_not_end_the_lockout(bus, start):
    start("coil")
    hear(bus, 2)
    for tick in range(110):
        status = exchange(bus, tick)
    assert status.lockout_ms > 60_000


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["coil"], "--bus"),
        (["coil", "--bus", "nowhere"], "nowhere"),
        (["coil", "--bus", "loop:0"], "loop:0"),
        (["coil", "--bus", "virtual"], "virtual"),
        (["coil", "--bus", "loop", "--tick-hz", "0"], "--tick-hz"),
        (["coil", "--bus", "loop", "--tick-hz", "2.5"], "--tick-hz"),
        (["coil", "--bus", "loop", "--backoff", "none"], "--backoff"),
        (["coil", "--bus", "loop", "--stimulus", "1", "0", "0"], "--stimulus"),
        (["sun", "--bus", "loop", "--stimulus", "0", "0", "0"], "--stimulus"),
        (["sun", "--bus", "loop", "--stimulus", "nan", "0", "0"], "--stimulus"),
        (["sun", "--bus", "loop", "--stimulus", "1.7e308", "1.7e308", "0"], "must be a direction"),
        (["magnetometer", "--bus", "loop", "--stimulus", "inf", "0", "0"], "--stimulus"),
        (["magnetometer", "--bus", "loop", "--stimulus", "x", "0", "0"], "--stimulus"),
        (["magnetometer", "--bus", "loop", "--stimulus", "1", "0"], "--stimulus"),
        (["sun", "--bus", "loop", "--stimulus", "no/such/run"], "no/such/run"),
        (["sun", "--bus", "loop", "--stimulus", "LICENSE"], "LICENSE"),
        (["magnetometer", "--bus", "loop", "--stimulus", "pyproject.toml"], "pyproject.toml"),
        (["magnetometer", "--bus", "loop", "--wind", "3"], "--wind"),
        (["coil", "--bus", "loop", "--deadman-s", "-1"], "--deadman-s"),
        (["coil", "--bus", "loop", "--pulse-s", "3.1"], "--pulse-s"),
        (["coil", "--bus", "loop", "--backoff-s", "200"], "--backoff-s"),
        (["coil", "--bus", "loop", "--clock", "none"], "--clock"),
        (["coil", "--bus", "loop", "--levels-ma", "1", "3", "2"], "--levels-ma"),
        (["coil", "--bus", "loop", "--levels-ma", "1", "2", "inf"], "--levels-ma"),
        (["coil", "--bus", "loop", "--levels-ma", "nan", "2", "3"], "--levels-ma"),
        (["coil", "--bus", "loop", "--levels-ma", "1000", "2000", "2048"], "at most 2047"),
        (["coil", "--bus", "loop", "--pulse-s", "nan"], "--pulse-s"),
        (["coil", "--bus", "loop", "--backoff-s", "nan"], "--backoff-s"),
        (["coil", "--bus", "loop", "--deadman-s", "nan"], "--deadman-s"),
        (["coil", "--bus", "loop", "--deadman-s", "inf"], "--deadman-s"),
        (["coil", "--bus", "loop", "--deadman-s", "0.0004"], "at least 0.001"),
        (["coil", "--bus", "loop:" + "9" * 5000], "names no TCP port"),
        (["gyro", "--bus", "loop"], "gyro"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(capsys, monkeypatch, arguments, named):
    monkeypatch.chdir(ROOT)
    assert main(arguments) == 2
    report = capsys.readouterr()
    assert report.out == ""
    (sentence,) = report.err.splitlines()
    assert named in sentence


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["coil", "--help"], ["dipole", "--help"], ["magnetometer", "--help"], ["sun", "--help"]],
)
def test_help_names_the_options(capsys, arguments):
    assert main(arguments) == 0
    assert ("--bus" if len(arguments) > 1 else "coil") in capsys.readouterr().out
