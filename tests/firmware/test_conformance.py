"""The coil board in C conforms with docs/icd.md, as the stub does, at other tick rates and limits too."""

import pytest
from firmware_bench import FirmwareBench, loaded
from simulated_bus import SimulatedBus

from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import CHECKS, run_checks

WRAPS_SOON = 2**32 - 150_000
"""A reading of the board's clock after which it begins again at 0 in the middle of the checks."""


def failures(library, limits, tick_hz, clock_ms=0):
    bus = SimulatedBus(FirmwareBench(loaded(library), clock_ms))
    link = BoardLink(bus, BOARD_KINDS["coil"], tick_hz, clock=lambda: bus.now_s)
    results = run_checks(link, limits, armed=True)
    assert [result.name for result in results if result.ran] == [check.run.__name__ for check in CHECKS]
    return {result.name: result.failure for result in results if result.failure}


@pytest.mark.parametrize("clock_ms", [0, WRAPS_SOON], ids=["clock", "clock that wraps"])
def test_as_it_ships(library_of, clock_ms):
    assert failures(library_of(), BoardLimits(), 1, clock_ms) == {}


@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
@pytest.mark.parametrize("hz", [3, 10])
def test_at_other_tick_rates(library_of, hz, shared):
    assert failures(library_of(tick_hz=hz, shared=shared), BoardLimits(shared=shared), hz) == {}


@pytest.mark.parametrize("deadman_ms", [2000, 60_000])
@pytest.mark.parametrize(("pulse_ms", "backoff_ms"), [(2500, 7300), (700, 2000), (100, 1000), (1, 0)])
@pytest.mark.parametrize("hz", [1, 3])
def test_with_other_limits(library_of, hz, pulse_ms, backoff_ms, deadman_ms):
    library = library_of(tick_hz=hz, pulse_ms=pulse_ms, backoff_ms=backoff_ms, deadman_ms=deadman_ms)
    assert failures(library, BoardLimits(pulse_ms, backoff_ms, True, deadman_ms / 1000.0), hz) == {}


def test_the_limits_of_the_header_are_those_that_are_judged(library_of):
    """A board that is told another back-off is found: the header counts."""
    assert "boot" in failures(library_of(backoff_ms=95_000), BoardLimits(), 1)
