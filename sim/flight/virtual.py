"""Flights on the virtual bus: plant and flight software in one process."""

import gc
from pathlib import Path

from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.table.own_law import LawError
from sim.flight.flight_loop import ProgressCallback
from sim.flight.record_flight import record_flight
from sim.flight.virtual_bus import VirtualBus
from sim.record import run_dir
from sim.scenario.schema import Scenario, flight_table


def fly_virtual(path: Path, scenario: Scenario, watch: ProgressCallback) -> None:
    """Fly with plant and flight software in this process; then unfreeze its garbage collection.

    Raises:
        LawError: the scenario's own law fails; ``run.json`` says so.
    """
    node = FlightNode(flight_config(flight_table(scenario)))
    try:
        record_flight(path, scenario, VirtualBus(node), watch, alone=True)
    except LawError as error:
        run_dir.update(path, ended=str(error))
        raise
    finally:
        gc.unfreeze()
