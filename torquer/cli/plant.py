"""``torquer plant``: the plant alone, on a bus with the flight software of another process."""

from collections.abc import Callable
from pathlib import Path

import click

from torquer.cli.options import (
    COMPRESS,
    PACE,
    SEEDS,
    Number,
    bus_option,
    examples,
    law_and_settings,
    load_scenario,
    scenario_argument,
    sentences,
)

EXAMPLES = examples(
    "torquer plant microsat --bus socketcan:vcan0 --orbits 1",
    "torquer plant microsat --bus loop --pace realtime:10",
)

WAITING_NOTE_S = 30.0
"""Interval of the notes that there is no flight software yet."""


@click.command(epilog=EXAMPLES)
@scenario_argument("realsat")
@bus_option()
@click.option(
    "--orbits",
    type=Number(min=0.0, min_open=True),
    help="How long to fly; default: as in the scenario.",
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@PACE
@click.option(
    "--out", "-o", type=click.Path(path_type=Path), help="Run directory; default runs/<scenario>-<time>."
)
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
    from sim.progress import note, progress
    from sim.record import run_dir
    from sim.record.pace import parse_pace
    from sim.report.conclude import conclude
    from sim.report.verdict import flight_failed

    chosen = load_scenario(scenario, settings)
    ticks, chosen_pace, spec = ticks_of(chosen, orbits), parse_pace(pace), resolve(bus)
    check_plant(chosen, seed)
    link = open_bus(spec)
    directory = run_dir.begin(out, chosen, seed, ticks, spec.partition(":")[0], chosen_pace, compress)
    note(f"plant on {spec}: waiting for the flight software")
    with progress(f"flying {chosen.name}", ticks) as watch:
        record_flight(directory, chosen, link, watch, waiting=_still_waiting())
    with progress("replaying", ticks) as watch:
        summary = conclude(directory, watch, chosen.own_law)
    note(f"run: {directory}")
    if "failures" in summary:
        raise FlightError(flight_failed(summary["failures"]))


def _still_waiting() -> Callable[[float], None]:
    """A function that prints from time to time that the plant still waits for the flight software."""
    from sim.progress import note

    next_s = WAITING_NOTE_S

    def still_waiting(waited_s: float) -> None:
        nonlocal next_s
        if waited_s >= next_s:
            next_s += WAITING_NOTE_S
            note(f"plant: no flight software yet, after {waited_s:.0f} s")

    return still_waiting
