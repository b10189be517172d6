"""``python -m sim.plant``: the plant as a process on a bus. It keeps the log and the plant's histories."""

import os
import signal
import sys
import time
from pathlib import Path
from threading import Thread
from types import FrameType

import click

from fsw.io import command_line
from fsw.io.bus import BusError
from fsw.io.open_bus import open_bus, resolve
from fsw.io.schema import TableError
from fsw.io.sentence import sentence
from sim.harness import run_dir
from sim.harness.errors import DISK_FULL, HarnessError
from sim.harness.options import parse_pace
from sim.harness.scenario import load, parse_settings
from sim.harness.sil import check_plant, record, ticks_of
from sim.plant.errors import PlantError


def _end(signum: int, frame: FrameType | None) -> None:
    sys.exit(1)


def _end_with(parent: int) -> None:
    """End this process soon after the one that started it."""

    def wait() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGTERM)

    Thread(target=wait, daemon=True).start()


@click.command()
@click.argument("scenario", default="microsat")
@click.option(
    "--bus", default="auto", show_default=True, help="socketcan:NAME, loop[:PORT], slcan:PORT or auto."
)
@click.option(
    "--orbits",
    type=click.FloatRange(min=0.0, min_open=True),
    help="How long to fly; default as the scenario says.",
)
@click.option(
    "--seed", default=1, show_default=True, type=click.IntRange(0, 2**64 - 1), help="Of all random streams."
)
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option("--out", type=click.Path(path_type=Path), help="Run directory; default runs/<scenario>-<time>.")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Override a key of the scenario.")
@click.option("--into", type=click.Path(path_type=Path), hidden=True)
@click.option("--parent", type=int, hidden=True)
def main(
    scenario: str,
    bus: str,
    orbits: float | None,
    seed: int,
    pace: str,
    out: Path | None,
    settings: tuple[str, ...],
    into: Path | None,
    parent: int | None,
) -> None:
    """Fly SCENARIO against a flight software on the same bus: waits for its FSW_BOOT, then begins tick 0."""
    signal.signal(signal.SIGTERM, _end)
    if parent is not None:
        _end_with(parent)
    try:
        chosen = load(scenario, parse_settings(settings))
        if into is not None:
            record(into, chosen, open_bus(bus))
            return
        ticks, chosen_pace, spec = ticks_of(chosen, orbits), parse_pace(pace), resolve(bus)
        check_plant(chosen, seed)
        link = open_bus(spec)
        directory = out or run_dir.default_path(chosen)
        run_dir.begin(directory, chosen, seed, ticks, spec.partition(":")[0], chosen_pace)
        click.echo(f"plant on {spec}: waiting for the flight software", err=True)
        record(directory, chosen, link)
        from sim.harness.conclude import conclude  # noqa: PLC0415  (the flight does not wait for it)

        conclude(directory)
        click.echo(f"flown: {directory}", err=True)
    except (TableError, BusError, HarnessError, PlantError) as error:
        click.echo(f"plant: {sentence(error)}", err=True)
        sys.exit(getattr(error, "exit_code", 2))
    except OSError as error:
        if error.errno not in DISK_FULL:
            raise
        click.echo(f"plant: the disk takes no more ({error.strerror}); what was done is kept", err=True)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    sys.exit(command_line.run(main, "sim.plant"))
