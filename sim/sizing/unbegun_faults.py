"""Faults of a scenario that a run is too short for."""

from math import ceil

from sim.scenario.schema import Scenario


def unbegun_faults(scenario: Scenario, ticks: int) -> list[str]:
    """A sentence for each fault that does not begin in so many ticks: its first tick is after the last."""
    tick_hz = scenario.time.tick_hz
    return [
        f"fault[{place}], {fault.kind} at {fault.at_s:g} s, will not begin: "
        f"the last tick is at {(ticks - 1) / tick_hz:g} s"
        for place, fault in enumerate(scenario.fault)
        if ceil(fault.at_s * tick_hz) >= ticks
    ]
