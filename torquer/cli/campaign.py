"""``torquer campaign``: many runs of a scenario, dispersed."""

from pathlib import Path

import click

from torquer.cli.options import law_and_settings, sentences


@click.command()
@click.argument("source", metavar="CAMPAIGN.toml|SCENARIO|DIR")
@click.option("--runs", type=click.IntRange(1, 10**7), help="Default: those of the file; 100 of a scenario.")
@click.option(
    "--orbits", type=click.FloatRange(min=0.0, min_open=True), help="Of each run. Default: as the file says."
)
@click.option(
    "--seed", type=click.IntRange(0, 10**15), help="Of all random streams. Default: as the file says, 1."
)
@click.option("--workers", type=click.IntRange(min=1), help="Processes. Default: one a core.")
@click.option(
    "--scheduler", metavar="ADDRESS|FILE", help="Fly on this Dask cluster instead. Needs torquer[cluster]."
)
@click.option(
    "--keep",
    default="none",
    show_default=True,
    type=click.Choice(["failures", "all", "none"]),
    help="Runs whose log and histories are kept, in DIR/runs.",
)
@click.option("--retry", is_flag=True, help="Fly runs that failed again.")
@click.option("--parquet", is_flag=True, help="Export to DIR/results.parquet too. Needs torquer[parquet].")
@click.option("--out", type=click.Path(path_type=Path), help="Folder. Default: campaigns/<name>-<UTC time>.")
@law_and_settings
@sentences
def campaign(
    source: str,
    runs: int | None,
    orbits: float | None,
    seed: int | None,
    workers: int | None,
    scheduler: str | None,
    keep: str,
    retry: bool,
    parquet: bool,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly many runs, drawn from the dispersions of CAMPAIGN.toml; those of a SCENARIO differ by seed alone.

    The same command with the same --out, or with DIR in place of the file, flies what is missing.
    """
    from sim.campaign.command import PARQUET
    from sim.campaign.results.store import RESULTS
    from sim.scenario.schema import parse_settings
    from torquer.api.campaign import campaign

    done = campaign(
        source,
        runs=runs,
        orbits=orbits,
        seed=seed,
        set=parse_settings(settings),
        workers=workers,
        scheduler=scheduler,
        keep=keep,
        retry=retry,
        parquet=parquet,
        out=out,
        progress=True,
    )
    click.echo(str(done))
    click.echo(f"results: {done.path / RESULTS}{f', {PARQUET}' if parquet else ''}; page: {done.page}")
    for sentence in done.flown.complaints:
        click.echo(f"torquer: {sentence}", err=True)
    return int(not done.ok)
