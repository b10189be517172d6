"""A flight of a scenario as it is, as the search of gains judges it."""

from sim.campaign.flight import record_scenario
from sim.scenario.schema import Scenario, orbit_period_s
from sim.tuning.flown import FlownMotion


def fly_whole(scenario: Scenario, seed: int, orbits: float) -> FlownMotion:
    """Fly it with filter, boards and bus.

    Raises:
        TableError: no plant or flight software can have these numbers.
        HarnessError: the flight cannot be flown.
    """
    truth = record_scenario(scenario, seed, orbits).truth
    return FlownMotion(
        orbit_period_s(scenario), truth["t_s"], truth["q_body_from_orbit"], truth["omega_body_orbit_radps"]
    )
