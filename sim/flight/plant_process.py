"""``python -m sim.flight.plant_process RUN``: the plant as a process that ``torquer sil`` starts."""

import os
import signal
import sys
import time
from pathlib import Path
from threading import Thread

import click

from fsw.bus.interface import BusError
from fsw.bus.open_bus import host_bus, open_bus
from fsw.input import command_line
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from sim.errors import HarnessError
from sim.flight.fsw_answers import CounterpartError, Patience
from sim.flight.record_flight import record_flight
from sim.plant.errors import PlantError
from sim.record import run_dir
from sim.record.run_record import FrameRecord, UnheardRecord
from sim.signals import EndedBySignal, raise_on_signals


@click.command()
@click.argument("path", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--bus", required=True)
@click.option("--patience", type=(float, float), required=True, help="For the boot, for an answer [s].")
@click.option(
    "--host", type=int, multiple=True, help="Serve the loop bus: descriptors of listener and first clients."
)
@click.option("--parent", type=int, required=True, help="Process whose end ends this one.")
def main(path: Path, bus: str, patience: tuple[float, float], host: tuple[int, ...], parent: int) -> None:
    """Fly the run that was begun in RUN; if the flight software fails, run.json says why."""
    _exit_with(parent)
    boot_s, answer_s = patience
    try:
        with raise_on_signals():
            scenario = run_dir.read_scenario(path)
            link = host_bus(*host) if host else open_bus(bus)
            record_flight(path, scenario, link, patience=Patience(boot_s, answer_s, answer_s))
    except CounterpartError as error:
        run_dir.update(path, ended=str(error), unheard=_unheard(error))
        sys.exit(1)
    except (TableError, BusError, HarnessError, PlantError) as error:
        click.echo(f"plant: {error_text(error)}", err=True)
        sys.exit(getattr(error, "exit_code", 2))
    except KeyboardInterrupt:
        sys.exit(130)
    except EndedBySignal as error:
        if isinstance(error.__cause__, CounterpartError) and error.__cause__.unheard:
            run_dir.update(path, unheard=_unheard(error.__cause__))
        sys.exit(1)


def _unheard(error: CounterpartError) -> UnheardRecord:
    frames: list[FrameRecord] = [{"id": one.can_id, "data": one.data.hex().upper()} for one in error.unheard]
    return {"tick": error.tick, "frames": frames}


def _exit_with(parent: int) -> None:
    """End this process soon after the one that started it."""

    def wait() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGTERM)

    Thread(target=wait, daemon=True).start()


if __name__ == "__main__":
    sys.exit(command_line.run(main, "sim.flight.plant_process"))
