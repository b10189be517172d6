"""``torquer sil``: a scenario with software in the loop."""

from pathlib import Path

import click

from torquer.cli.options import BUSES, SEEDS, SETTINGS, SIGN, report_failures, sentences


@click.command()
@click.argument("scenario", default="realsat")
@click.option("--bus", default="auto", show_default=True, help=BUSES + " or virtual.")
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option(
    "--orbits", type=click.FloatRange(min=0.0, min_open=True), help="Default: those of the scenario."
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--out", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
@SIGN
@SETTINGS
@sentences
def sil(
    scenario: str,
    bus: str,
    pace: str,
    orbits: float | None,
    seed: int,
    out: Path | None,
    sign: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly SCENARIO: plant and flight software as two processes on a bus (virtual: in one)."""
    from sim.flight.record_flight import check_can_fly, ticks_of
    from sim.flight.sil import fly_processes, serve_bus
    from sim.progress import progress
    from sim.record import run_dir
    from sim.record.pace import parse_pace
    from sim.record.signature import private_key
    from sim.scenario.schema import load, parse_settings

    key = None if sign is None else private_key(sign)
    chosen, chosen_pace = load(scenario, parse_settings(settings)), parse_pace(pace)
    ticks, path = ticks_of(chosen, orbits), out or run_dir.default_path(chosen)
    check_can_fly(chosen, seed)
    flying = f"flying {chosen.name}"
    if bus == "virtual":
        from sim.flight.virtual import fly_virtual

        run_dir.begin(path, chosen, seed, ticks, bus, chosen_pace)
        with progress(flying, ticks) as watch:
            fly_virtual(path, chosen, watch)
    else:
        with serve_bus(bus) as (spec, hub):
            kind = spec.partition(":")[0]
            run_dir.begin(path, chosen, seed, ticks, kind, chosen_pace)
            if bus == "auto":
                click.echo(f"bus: {kind} (auto)", err=True)
            with progress(flying, ticks) as watch:
                fly_processes(path, chosen, spec, hub, watch)
    from sim.record.binding import sign_run  # loaded after the flight, which does not need it
    from sim.report.conclude import conclude
    from sim.report.summary import summary_text

    with progress("replaying", ticks) as watch:
        summary = conclude(path, watch)
    if key is not None:
        sign_run(path, key)
    click.echo(summary_text(summary))
    click.echo(f"report: {path / run_dir.REPORT}")
    return report_failures(summary.get("failures", {}))
