"""``python -m sim.plant``: the plant as a process on a bus. It keeps the log and the plant's histories."""

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from threading import Thread

import click

from fsw.bus.interface import BusError
from fsw.bus.open_bus import open_bus, resolve
from fsw.input import command_line
from fsw.input.schema import TableError
from fsw.input.sentence import sentence
from sim.harness import run_dir
from sim.harness.answers import CounterpartError, Patience
from sim.harness.errors import DISK_FULL, FlightError, HarnessError
from sim.harness.pace import parse_pace
from sim.harness.progress import progress
from sim.harness.scenario import Scenario, load, parse_settings
from sim.harness.signals import EndedBySignal, endings_raised
from sim.harness.sil import check_plant, record, ticks_of
from sim.plant.errors import PlantError

WAITING_SAID_S = 30.0
"""How often it is said that nobody has come yet."""


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
@click.option("--patience", type=(float, float), default=(60.0, 20.0), hidden=True)
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
    patience: tuple[float, float],
    parent: int | None,
) -> None:
    """Fly SCENARIO against a flight software on the same bus: waits for its FSW_BOOT, then begins tick 0."""
    if parent is not None:
        _end_with(parent)
    try:
        with endings_raised():
            chosen = load(scenario, parse_settings(settings))
            if into is not None:
                _fly_for_parent(into, chosen, bus, patience)
            else:
                _fly(chosen, bus, orbits, seed, pace, out)
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
    except EndedBySignal as end:
        if parent is None:
            click.echo(f"plant: {end}", err=True)
        sys.exit(end.exit_code if parent is None else 1)


def _fly_for_parent(path: Path, scenario: Scenario, bus: str, patience: tuple[float, float]) -> None:
    """Fly the run that was begun there; what is wrong with the flight software run.json tells the parent."""
    boot_s, answer_s = patience
    try:
        record(path, scenario, open_bus(bus), patience=Patience(boot_s, answer_s, answer_s))
    except CounterpartError as error:
        run_dir.update(path, ended=str(error))
        sys.exit(1)


def _fly(scenario: Scenario, bus: str, orbits: float | None, seed: int, pace: str, out: Path | None) -> None:
    """A whole flight: its verdict is the exit code."""
    ticks, chosen_pace, spec = ticks_of(scenario, orbits), parse_pace(pace), resolve(bus)
    check_plant(scenario, seed)
    link = open_bus(spec)
    directory = out or run_dir.default_path(scenario)
    run_dir.begin(directory, scenario, seed, ticks, spec.partition(":")[0], chosen_pace)
    click.echo(f"plant on {spec}: waiting for the flight software", err=True)
    with progress(f"flying {scenario.name}", ticks) as watch:
        record(directory, scenario, link, watch, waiting=_still_waiting())
    from sim.harness.conclude import conclude  # noqa: PLC0415  (the flight does not wait for it)
    from sim.harness.verdict import flight_failed  # noqa: PLC0415

    with progress("replaying", ticks) as watch:
        summary = conclude(directory, watch)
    click.echo(f"flown: {directory}", err=True)
    if "failures" in summary:
        raise FlightError(flight_failed(summary["failures"]))


def _still_waiting() -> Callable[[float], None]:
    """Says now and then that the flight software is still waited for."""
    next_s = WAITING_SAID_S

    def say(waited_s: float) -> None:
        nonlocal next_s
        if waited_s >= next_s:
            next_s += WAITING_SAID_S
            click.echo(f"plant: no flight software yet, after {waited_s:.0f} s", err=True)

    return say


if __name__ == "__main__":
    sys.exit(command_line.run(main, "sim.plant"))
