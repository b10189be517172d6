"""``torquer.scenarios``: the scenarios that ship."""

from sim.scenario.schema import Scenario, shipped


def scenarios() -> dict[str, Scenario]:
    """The scenarios that ship, by name."""
    return {scenario.name: scenario for scenario in shipped()}
