"""``torquer hil --conformance`` against boards that are processes of their own: on loop, over serial.

They take their time, and wait for most of it: all of them run at once.
"""

import importlib.util
import json
import os
import select
import socket
import subprocess
import sys
import threading
from contextlib import contextmanager

import pytest

pytestmark = [pytest.mark.long, pytest.mark.paced]

LIMITS = ("--set", "coils.pulse_s=1.2", "--set", "coils.backoff_s=3.9", "--deadman-s", "2.0")
BOARD = ("coil", "--pulse-s", "1.2", "--backoff-s", "3.9", "--deadman-s", "2.0")
SHORT = (*BOARD, "--backoff-s", "3.0")


def start(*words):
    command = [sys.executable, "-m", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def loop():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"loop:{free.getsockname()[1]}"


@contextmanager
def cable():
    """Two serial adapters on one CAN cable: what one is told to send, the other tells its host."""
    ends = [os.openpty() for _ in range(2)]
    masters = [master for master, _ in ends]
    running = True

    def carry():
        torn = {master: b"" for master in masters}
        while running:
            for master in select.select(masters, (), (), 0.1)[0]:
                *lines, torn[master] = (torn[master] + os.read(master, 4096)).split(b"\r")
                frames = b"".join(line + b"\r" for line in lines if line[:1] in (b"t", b"T", b"r", b"R"))
                os.write(masters[1 - masters.index(master)], frames)

    carrier = threading.Thread(target=carry)
    carrier.start()
    try:
        yield tuple(f"slcan:{os.ttyname(slave)}" for _, slave in ends)
    finally:
        running = False
        carrier.join()
        for descriptor in (descriptor for pair in ends for descriptor in pair):
            os.close(descriptor)


def board(bus, tick_hz, words):
    started = start("hil_stub", *words, "--bus", bus, "--tick-hz", tick_hz)
    assert started.stderr.readline().startswith("on ")
    return started


def conformance(bus, tick_hz, *options):
    words = (*LIMITS, "--tick-hz", tick_hz, *options)
    return start("torquer", "hil", "--conformance", "coil", "--bus", bus, *words)


@pytest.fixture(scope="module")
def ended():
    """Exit code, output and errors of each suite, by name.

    Over serial a tick has a whole second: frames pass the cable's thread, and seven processes run at once.
    """
    serial = importlib.util.find_spec("serial") is not None
    boards, suites = [], {}
    armed = ("--arm", "--json")
    with cable() as (bench_port, board_port):
        ways = {"loop": (bus := loop(), bus, "2", BOARD, armed)}
        ways["short"] = (bus := loop(), bus, "2", SHORT, ())
        if serial:
            ways["slcan"] = (bench_port, board_port, "1", BOARD, armed)
        try:
            for name, (bench_bus, board_bus, tick_hz, words, options) in ways.items():
                boards.append(board(board_bus, tick_hz, words))
                suites[name] = conformance(bench_bus, tick_hz, *options)
            suites["nobody"] = conformance(loop(), "2")
            result = {
                name: (*suite.communicate(timeout=300), suite.returncode) for name, suite in suites.items()
            }
        finally:
            for process in (*boards, *suites.values()):
                process.kill()
                process.communicate()
    return result


@pytest.mark.parametrize("way", ["loop", "slcan"])
def test_the_stub_conforms(ended, way):
    if way not in ended:
        pytest.skip("pyserial, which serial adapters need, is not installed")
    output, errors, code = ended[way]
    assert errors == ""
    result = json.loads(output)
    assert {check["name"]: check["failure"] for check in result["checks"] if check["failure"]} == {}
    assert code == 0
    assert all(check["ran"] for check in result["checks"])


def test_without_arm_what_needs_power_is_not_run_and_a_short_lockout_is_found_all_the_same(ended):
    output, errors, code = ended["short"]
    assert (errors, code) == ("", 1)
    assert "FAILED  boot " in output
    assert "7 not run: they drive coils and need --arm" in output


def test_no_board_there_is_one_sentence(ended):
    _, errors, code = ended["nobody"]
    assert (errors, code) == ("torquer: no COIL board answers on this bus\n", 2)
