"""``torquer sil``: a scenario with software in the loop."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sim.errors import HarnessError
from torquer.cli.options import BUSES, COMPRESS, SEEDS, SETTINGS, SIGN, report_failures, sentences

if TYPE_CHECKING:
    from sim.campaign.rerun import CampaignRun


@click.command()
@click.argument("scenario", required=False, metavar="[SCENARIO]")
@click.option("--bus", default="auto", show_default=True, help=BUSES + " or virtual.")
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option(
    "--orbits", type=click.FloatRange(min=0.0, min_open=True), help="Default: those of the scenario."
)
@click.option("--seed", type=SEEDS, help="Of all random streams. Default: 1.")
@click.option("--out", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
@click.option(
    "--from",
    "source",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Fly a run of this campaign again.",
)
@click.option("--run", type=click.IntRange(min=0), help="Its number. With --from.")
@COMPRESS
@SIGN
@SETTINGS
@sentences
def sil(
    scenario: str | None,
    bus: str,
    pace: str,
    orbits: float | None,
    seed: int | None,
    out: Path | None,
    compress: bool,
    source: Path | None,
    run: int | None,
    sign: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly SCENARIO (realsat): plant and flight software as two processes on a bus (virtual: in one)."""
    from sim.flight.record_flight import check_can_fly, ticks_of
    from sim.flight.sil import fly_processes, serve_bus
    from sim.progress import progress
    from sim.record import run_dir
    from sim.record.pace import parse_pace
    from sim.record.signature import private_key
    from sim.report.follow import follow
    from sim.scenario.schema import load, parse_settings

    key = None if sign is None else private_key(sign)
    again = _campaign_run(source, run, scenario, orbits, seed, settings)
    if again is not None:
        chosen, seed = again.scenario, again.seed
    else:
        chosen = load("realsat" if scenario is None else scenario, parse_settings(settings))
        seed = 1 if seed is None else seed
    chosen_pace = parse_pace(pace)
    ticks, path = ticks_of(chosen, orbits), out or run_dir.default_path(chosen)
    check_can_fly(chosen, seed)
    flying = f"flying {chosen.name}"
    if bus == "virtual":
        from sim.flight.virtual import fly_virtual

        run_dir.begin(path, chosen, seed, ticks, bus, chosen_pace, compress)
        with follow(path, ticks) as conclude:
            with progress(flying, ticks) as watch:
                fly_virtual(path, chosen, watch)
            with progress("replaying", ticks) as watch:
                summary = conclude(watch)
    else:
        with serve_bus(bus) as (spec, hub):
            kind = spec.partition(":")[0]
            run_dir.begin(path, chosen, seed, ticks, kind, chosen_pace, compress)
            if bus == "auto":
                click.echo(f"bus: {kind} (auto)", err=True)
            with follow(path, ticks) as conclude:
                with progress(flying, ticks) as watch:
                    fly_processes(path, chosen, spec, hub, watch)
                with progress("replaying", ticks) as watch:
                    summary = conclude(watch)
    from sim.record.binding import sign_run  # loaded after the flight, which does not need it
    from sim.report.summary import summary_text

    if key is not None:
        sign_run(path, key)
    click.echo(summary_text(summary))
    click.echo(f"report: {path / run_dir.REPORT}")
    equal = True
    if again is not None:
        from sim.campaign.rerun import compare

        equal, sentence = compare(again, path)
        click.echo(sentence)
    return report_failures(summary.get("failures", {})) or int(not equal)


def _campaign_run(
    source: Path | None,
    run: int | None,
    scenario: str | None,
    orbits: float | None,
    seed: int | None,
    settings: tuple[str, ...],
) -> "CampaignRun | None":
    """The run of a campaign that is to be flown; None if none is asked for."""
    if source is None and run is None:
        return None
    if source is None or run is None:
        raise HarnessError("--from DIR and --run NUMBER belong together")
    given = {"SCENARIO": scenario, "--orbits": orbits, "--seed": seed, "--set": settings or None}
    if wrong := [name for name, value in given.items() if value is not None]:
        raise HarnessError(f"{', '.join(wrong)}: with --from the run is as its campaign drew it")
    from sim.campaign.rerun import campaign_run

    return campaign_run(source, run)
