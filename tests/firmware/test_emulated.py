"""The coil board in C on an emulated Cortex-M3 conforms, keeps its limits under attack, and is small."""

import subprocess
from random import Random

import pytest
from coil_attack import SETUPS, Judge, Setup, attack
from emulated_board import CROSS, NO_EMULATOR, EmulatedStep, EmulatedTarget, build_images, has_emulator
from firmware_bench import FirmwareBench
from process_target import attack_in_real_time
from simulated_bus import SimulatedBus

from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import run_checks

pytestmark = [pytest.mark.long, pytest.mark.skipif(not has_emulator(), reason=NO_EMULATOR)]

FAST = Setup(10, 300, 2000, True, 500)


@pytest.fixture
def stepping(tmp_path):
    """Makes the board with these limits, in a test's hands."""
    steps = []

    def start(**limits):
        steps.append(EmulatedStep(build_images(tmp_path, **limits) / "harness.elf"))
        return FirmwareBench(steps[-1])

    yield start
    for step in steps:
        step.close()


def test_it_conforms(stepping):
    bus = SimulatedBus(stepping())
    link = BoardLink(bus, BOARD_KINDS["coil"], 1, clock=lambda: bus.now_s)
    results = run_checks(link, BoardLimits(), armed=True)
    assert {result.name: result.failure for result in results if result.failure} == {}


@pytest.mark.parametrize(
    "setup", [SETUPS["as it flies"], SETUPS["fast, per coil"]], ids=["as it flies", "fast"]
)
def test_no_attack_breaks_a_limit(stepping, setup):
    _, judge = attack(setup, stepping(**setup._asdict()), 3000, 20150327)
    assert judge.violations == []
    assert (judge.longest_ms, judge.least_gap_ms) == (setup.pulse_ms, setup.backoff_ms)


@pytest.mark.paced
def test_its_interrupt_ends_pulses_in_real_time(tmp_path):
    judge, random = Judge(FAST), Random("emulated")
    target = EmulatedTarget(build_images(tmp_path, **FAST._asdict()) / "coil_board.elf", judge, random)
    attack_in_real_time(target, FAST, judge, random, 4.0)
    assert judge.violations == []
    assert judge.pulses > 0


def test_its_core_fits_a_small_processor(tmp_path):
    build = build_images(tmp_path)
    rows = subprocess.run(
        [f"{CROSS}size", "-t", str(build / "libcoil_board.a")], check=True, capture_output=True, text=True
    )
    text, data, bss, *_ = rows.stdout.splitlines()[-1].split()
    assert (int(data), int(bss)) == (0, 0), "all that it remembers is the caller's"
    assert int(text) < 4096
