"""The coil board in C as a program: it conforms in real time on both its buses, and keeps its limits.

The suites wait for most of their time: both run at once. By slcan a tick has a whole second, as python-can
reads byte by byte.
"""

import json
import os
import socket
import subprocess
import sys
from random import Random

import pytest
from coil_attack import Judge, Setup
from process_target import ProcessTarget, attack_in_real_time

pytestmark = [pytest.mark.long, pytest.mark.paced]

SECONDS = float(os.environ.get("TORQUER_ATTACK_SECONDS", "3"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))
LIMITS = ("--set", "coils.pulse_s=1.2", "--set", "coils.backoff_s=3.9", "--deadman-s", "2.0")


def conformance(bus, tick_hz):
    words = ("torquer", "hil", "--conformance", "coil", "--bus", bus, "--tick-hz", str(tick_hz), *LIMITS)
    command = [sys.executable, "-m", *words, "--arm", "--json"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def board(program, bus):
    return subprocess.Popen([str(program), bus], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def ended(program_of):
    """Output, errors and exit code of the suite on each bus."""
    limits = {"pulse_ms": 1200, "backoff_ms": 3900, "deadman_ms": 2000}
    with socket.create_server(("127.0.0.1", 0)) as free:
        loop = f"loop:{free.getsockname()[1]}"
    boards, suites = [], {}
    try:
        suites["loop"] = conformance(loop, 2)
        boards.append(board(program_of(tick_hz=2, **limits), loop))
        boards.append(board(program_of(tick_hz=1, **limits), "slcan"))
        suites["slcan"] = conformance(boards[-1].stderr.readline().split()[1], 1)
        return {name: (*suite.communicate(timeout=300), suite.returncode) for name, suite in suites.items()}
    finally:
        for process in (*boards, *suites.values()):
            process.kill()
            process.communicate()


@pytest.mark.parametrize("bus", ["loop", "slcan"])
def test_it_conforms(ended, bus):
    output, errors, code = ended[bus]
    if "pyserial" in errors:
        pytest.skip("pyserial, which serial adapters need, is not installed")
    assert errors == ""
    checks = json.loads(output)["checks"]
    assert {check["name"]: check["failure"] for check in checks if check["failure"]} == {}
    assert all(check["ran"] for check in checks)
    assert code == 0


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per coil"])
def test_no_attack_breaks_a_limit(program_of, shared):
    setup = Setup(10, 300, 2000, shared, 500)
    program, judge, random = program_of(**setup._asdict()), Judge(setup), Random(f"{SEED}/{shared}")
    target = ProcessTarget(lambda spec: [str(program), spec, "-"], judge, random)
    attacker = attack_in_real_time(target, setup, judge, random, SECONDS / 2)
    print(
        f"\n{SECONDS / 2:g} s, {'shared' if shared else 'per coil'}: {attacker.requests} requests, "
        f"{judge.pulses} pulses, longest {judge.longest_ms} ms, least gap {judge.least_gap_ms} ms, "
        f"{len(judge.violations)} violations"
    )
    assert judge.violations == []
    assert judge.pulses >= max(1.0, SECONDS / 20.0), "it was let fire: no proof by doing nothing"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((), "usage: coil_board loop:PORT|slcan [PINS]"),
        (("can0",), "the bus is loop:PORT or slcan"),
        (("loop:0",), "loop:PORT needs a port from 1 to 65535"),
        (("loop:x",), "loop:PORT needs a port from 1 to 65535"),
        (("slcan", "/no/such/folder/pins"), "the file for the pins cannot be written"),
    ],
)
def test_what_it_cannot_use_is_one_sentence(program_of, words, sentence):
    done = subprocess.run([str(program_of()), *words], check=False, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == f"coil_board: {sentence}"
