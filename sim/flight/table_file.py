"""The onboard table of a scenario as a file, for flight software in a process of its own."""

from pathlib import Path

from fsw.table import table as onboard
from sim.scenario.schema import Scenario, flight_table
from sim.scenario.written import toml_of

FLIGHT_TABLE = "flight.toml"


def write_flight_table(folder: Path, scenario: Scenario) -> Path:
    """Write the resolved table into a folder, and return its path.

    Raises:
        TableError: the scenario's ``[flight]`` holds what the onboard table does not take, or the table could
            not be read again.
        OSError: it cannot be written.
    """
    path = folder / FLIGHT_TABLE
    source = f"onboard table of scenario {scenario.name}"
    text = toml_of(flight_table(scenario), lambda values: onboard.flight_table(values, source), source)
    path.write_text(text, encoding="utf-8")
    return path
