"""``torquer campaign``: many runs of a scenario, dispersed."""

from pathlib import Path

import click

from torquer.cli.completions import of_scenarios
from torquer.cli.options import JSON, JUNIT, Number, WholeNumber, examples, law_and_settings, sentences

EXAMPLES = examples(
    "torquer campaign cubesat3u --runs 20 --orbits 3 --out series",
    "torquer campaign series --runs 40                       # fly what is missing, and 20 more",
    "torquer campaign campaign.toml --junit campaign.xml     # with dispersions: docs/campaigns.md",
)


@click.command(epilog=EXAMPLES)
@click.argument("source", metavar="CAMPAIGN.toml|SCENARIO|DIR", shell_complete=of_scenarios)
@click.option("--runs", type=WholeNumber(1, 10**7), help="Default: those of the file; 100 of a scenario.")
@click.option("--orbits", type=Number(min=0.0, min_open=True), help="Of each run. Default: as the file says.")
@click.option(
    "--seed", type=WholeNumber(0, 10**15), help="Of all random streams. Default: as the file says, 1."
)
@click.option("--workers", "-n", type=WholeNumber(min=1), help="Processes. Default: one a core.")
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
@click.option(
    "--out", "-o", type=click.Path(path_type=Path), help="Folder. Default: campaigns/<name>-<UTC time>."
)
@law_and_settings
@JUNIT
@JSON
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
    junit: Path | None,
) -> int:
    """Fly many runs, drawn from the dispersions of CAMPAIGN.toml; those of a SCENARIO differ by seed alone.

    The same command with the same --out, or with DIR in place of the file, flies what is missing.
    """
    from sim.campaign.command import PARQUET
    from sim.campaign.report.documents import suites
    from sim.campaign.results.store import RESULTS
    from sim.console import answer, fail, say
    from sim.junit import prepare_junit, write_junit
    from sim.scenario.schema import parse_settings
    from torquer.api.campaign import campaign

    prepare_junit(junit)
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
    say(str(done))
    page = f"; page: {done.page}" if done.page.is_file() else ""
    say(f"results: {done.path / RESULTS}{f', {PARQUET}' if parquet else ''}{page}")
    for sentence in done.flown.complaints:
        fail(sentence)
    flown = done.flown
    answer({**done.statistics, "folder": done.path, "page": done.page, "limits_broken": flown.broken})
    write_junit(junit, "torquer campaign", suites(flown.verdicts, flown.analysis, flown.broken))
    return int(not done.ok)
