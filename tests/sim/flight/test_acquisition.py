"""A satellite whose coils are weak beside its gains is caught, and does not tumble on."""

import pytest

from fsw.wire.messages import Mode
from sim.campaign.flight import record_scenario
from sim.scenario.schema import load


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 13, 905])
def test_a_6u_turned_by_40_deg_points_within_two_orbits(seed):
    """Where the attitude's term had no limit, it tumbled on for seven orbits and more by these seeds."""
    flown = record_scenario(load("cubesat6u"), seed, 2.0)
    assert flown.estimates.mode[-1] == Mode.POINT
