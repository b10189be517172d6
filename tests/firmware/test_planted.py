"""Each error planted in the coil board in C is found by the conformance suite, by the check for it."""

from random import Random

import pytest
from c_compiler import has_compiler
from coil_attack import Setup, attack
from firmware_bench import NO_COMPILER, FirmwareBench, loaded
from planted_firmware import PLANTED, UNSEEN, compile_planted
from simulated_bus import SimulatedBus
from twins import Twins

from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import run_checks

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not has_compiler(), reason=NO_COMPILER),
]


def found_in(library, error):
    """The checks of the suite that fail, and why."""
    told = dict(error.limits)
    bus = SimulatedBus(FirmwareBench(loaded(library)))
    link = BoardLink(bus, BOARD_KINDS["coil"], told.get("tick_hz", 1), clock=lambda: bus.now_s)
    limits = BoardLimits(
        told.get("pulse_ms", 3000),
        told.get("backoff_ms", 100_000),
        bool(told.get("shared", 1)),
        told.get("deadman_ms", 5000) / 1000.0,
    )
    return {result.name: result.failure for result in run_checks(link, limits, armed=True) if result.failure}


@pytest.mark.parametrize("error", PLANTED.values(), ids=PLANTED)
def test_the_suite_finds_a_planted_error(tmp_path, error):
    found = found_in(compile_planted(tmp_path, error), error)
    assert error.finds in found, found


@pytest.mark.parametrize("error", UNSEEN.values(), ids=UNSEEN)
def test_what_no_bus_shows_is_found_beside_the_stub(tmp_path, error):
    setup = Setup(10, 300, 2000, True, 500)
    error = error._replace(limits=tuple(setup._asdict().items()))
    twins = Twins(
        setup, compile_planted(tmp_path / "fast", error), Random("planted"), clock_ms=2**32 - 60_000
    )
    with pytest.raises(AssertionError, match=r"^on "):
        attack(setup, twins, 20_000, "planted")
    ours = error._replace(limits=())
    assert found_in(compile_planted(tmp_path / "ours", ours), ours) == {}, (
        "the suite finds it: it is no such error"
    )
