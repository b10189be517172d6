import pytest

from sim.harness.faults.checks import bounds_of
from sim.harness.faults.rig import Rig, prepared


@pytest.fixture
def bounds():
    """What flights of the default scenario are judged by."""
    return bounds_of(prepared("microsat", ())[0])


@pytest.fixture
def rig():
    """Makes a rig of the default scenario, with settings laid over it."""

    def make(*settings, seed=1):
        return Rig(*prepared("microsat", settings), seed)

    return make


@pytest.fixture
def flown(rig):
    """Flies so many ticks under one fault: the record."""

    def fly(fault, ticks, first=0, end=None, settings=()):
        bench = rig(*settings)
        bench.inject(fault, first, end)
        for _ in range(ticks):
            bench.tick()
        return bench.finish()

    return fly
