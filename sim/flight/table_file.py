"""The onboard table of a scenario as a file, for flight software in a process of its own."""

from pathlib import Path

import tomli_w

from sim.scenario.schema import Scenario, flight_table

FLIGHT_TABLE = "flight.toml"


def write_flight_table(folder: Path, scenario: Scenario) -> Path:
    """Write the resolved table into a folder, and return its path.

    Raises:
        TableError: the scenario's ``[flight]`` holds what the onboard table does not take.
        OSError: it cannot be written.
    """
    path = folder / FLIGHT_TABLE
    values = flight_table(scenario).model_dump(mode="json", exclude_none=True)
    path.write_text(tomli_w.dumps(values), encoding="utf-8")
    return path
