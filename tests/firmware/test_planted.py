"""Each error planted in the coil board in C is found by the conformance suite, by the check for it."""

import pytest
from firmware_bench import NO_COMPILER, FirmwareBench, has_compiler, loaded
from planted_firmware import PLANTED, compile_planted
from simulated_bus import SimulatedBus

from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import run_checks

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not has_compiler(), reason=NO_COMPILER),
]


@pytest.mark.parametrize("error", PLANTED.values(), ids=PLANTED)
def test_a_planted_error_is_found(tmp_path, error):
    told = dict(error.limits)
    bus = SimulatedBus(FirmwareBench(loaded(compile_planted(tmp_path, error))))
    link = BoardLink(bus, BOARD_KINDS["coil"], told.get("tick_hz", 1), clock=lambda: bus.now_s)
    limits = BoardLimits(
        told.get("pulse_ms", 3000),
        told.get("backoff_ms", 100_000),
        bool(told.get("shared", 1)),
        told.get("deadman_ms", 5000) / 1000.0,
    )
    found = {result.name: result.failure for result in run_checks(link, limits, armed=True) if result.failure}
    assert error.finds in found, found
