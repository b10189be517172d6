"""What the laws of a comparison are judged by: the quantity that they are meant to control on this body."""

from sim.report.figures.controlled import SETTLED_DEG, Controlled, controlled
from sim.scenario.schema import Scenario, flight_table
from sim.tuning.applicable import aims_of
from sim.tuning.cost import BY_RATE

WORDS = {"spin": "spin rate about axis 1", "rate": "rate"}


def yardstick(scenario: Scenario) -> Controlled:
    """Body axis 1 or the whole attitude; where the laws meant for the body do not point, a rate.

    It is that of the scenario's first requirement on a rate, by the error under which it has settled there:
    relative to the orbital frame less the spin reference, or the component about axis 1 alone.

    Raises:
        TableError: the scenario's own law cannot be loaded.
    """
    if flight_table(scenario).modes.axis_only:
        return Controlled("axis", "axis 1 from the vertical", "deg", SETTLED_DEG)
    if not aims_of(scenario) <= BY_RATE:
        return Controlled("attitude", "whole attitude", "deg", SETTLED_DEG)
    for required in scenario.requirement:
        if required.what in WORDS:
            return Controlled(required.what, WORDS[required.what], "deg/s", required.settled_degps)
    return controlled(scenario)
