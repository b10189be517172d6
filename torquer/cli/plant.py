"""``torquer plant``: the plant alone, on a bus with the flight software of another process."""

from collections.abc import Callable
from pathlib import Path

import click

from torquer.cli.options import BUSES, COMPRESS, SEEDS, law_and_settings, sentences

WAITING_NOTE_S = 30.0
"""Interval of the notes that there is no flight software yet."""


@click.command()
@click.argument("scenario", default="realsat")
@click.option("--bus", default="auto", show_default=True, help=BUSES)
@click.option(
    "--orbits",
    type=click.FloatRange(min=0.0, min_open=True),
    help="How long to fly; default: as in the scenario.",
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option("--out", type=click.Path(path_type=Path), help="Run directory; default runs/<scenario>-<time>.")
@COMPRESS
@law_and_settings
@sentences
def plant(
    scenario: str,
    bus: str,
    orbits: float | None,
    seed: int,
    pace: str,
    out: Path | None,
    compress: bool,
    settings: tuple[str, ...],
) -> None:
    """Fly SCENARIO against a flight software on the same bus: waits for its FSW_BOOT, then begins tick 0."""
    from fsw.bus.open_bus import open_bus, resolve
    from sim.errors import FlightError
    from sim.flight.record_flight import check_plant, record_flight, ticks_of
    from sim.progress import progress
    from sim.record import run_dir
    from sim.record.pace import parse_pace
    from sim.report.conclude import conclude
    from sim.report.verdict import flight_failed
    from sim.scenario.schema import load, parse_settings

    chosen = load(scenario, parse_settings(settings))
    ticks, chosen_pace, spec = ticks_of(chosen, orbits), parse_pace(pace), resolve(bus)
    check_plant(chosen, seed)
    link = open_bus(spec)
    directory = run_dir.begin(out, chosen, seed, ticks, spec.partition(":")[0], chosen_pace, compress)
    click.echo(f"plant on {spec}: waiting for the flight software", err=True)
    with progress(f"flying {chosen.name}", ticks) as watch:
        record_flight(directory, chosen, link, watch, waiting=_still_waiting())
    with progress("replaying", ticks) as watch:
        summary = conclude(directory, watch, chosen.own_law)
    click.echo(f"run: {directory}", err=True)
    if "failures" in summary:
        raise FlightError(flight_failed(summary["failures"]))


def _still_waiting() -> Callable[[float], None]:
    """A function that prints from time to time that the plant still waits for the flight software."""
    next_s = WAITING_NOTE_S

    def note(waited_s: float) -> None:
        nonlocal next_s
        if waited_s >= next_s:
            next_s += WAITING_NOTE_S
            click.echo(f"plant: no flight software yet, after {waited_s:.0f} s", err=True)

    return note
