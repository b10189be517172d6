"""Telecommands of a scenario that a run is too short for."""

from sim.scenario.schema import Scenario

ROUNDING_S = 1e-9


def unsent_telecommands(scenario: Scenario, ticks: int) -> list[str]:
    """A sentence for each telecommand that is not sent in so many ticks: its time is after the last SYNC."""
    last_s = (ticks - 1) / scenario.time.tick_hz
    return [
        f"telecommand[{place}], {telecommand.message} at {telecommand.at_s:g} s, will not be sent: "
        f"the last tick is at {last_s:g} s"
        for place, telecommand in enumerate(scenario.telecommand)
        if telecommand.at_s > last_s + ROUNDING_S
    ]
