"""``torquer sil``: a scenario with software in the loop."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from fsw.input.error_text import error_text
from sim.errors import HarnessError
from torquer.cli.options import BUSES, COMPRESS, SEEDS, SIGN, law_and_settings, report_failures, sentences

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
@click.option(
    "--expect",
    "expected",
    multiple=True,
    metavar="INDEX<VALUE",
    help="A requirement beside the scenario's, such as 'ape<2' or 'settling.axis<3'; judged at the end.",
)
@COMPRESS
@SIGN
@law_and_settings
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
    expected: tuple[str, ...],
    sign: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly SCENARIO (realsat): plant and flight software as two processes on a bus (virtual: in one)."""
    from sim.scenario.schema import parse_settings
    from torquer.api.flight import fly

    again = _campaign_run(source, run, scenario, orbits, seed, expected, settings)
    flown = fly(
        again.scenario if again else "realsat" if scenario is None else scenario,
        orbits=orbits,
        seed=again.seed if again else 1 if seed is None else seed,
        bus=bus,
        pace=pace,
        set=parse_settings(settings),
        expect=expected,
        out=out,
        compress=compress,
        sign=sign,
        progress=True,
    )
    if not flown.concluded:
        click.echo(f"torquer: {error_text(flown)}", err=True)
        return 1
    click.echo(str(flown))
    click.echo(f"report: {flown.report}")
    equal = again is None or _equals(again, flown.path)
    return report_failures(flown.failures) or int(not equal)


def _equals(again: "CampaignRun", path: Path) -> bool:
    """Whether the run is the campaign's, bit for bit, and say so."""
    from sim.campaign.rerun import compare

    equal, sentence = compare(again, path)
    click.echo(sentence)
    return equal


def _campaign_run(
    source: Path | None,
    run: int | None,
    scenario: str | None,
    orbits: float | None,
    seed: int | None,
    expected: tuple[str, ...],
    settings: tuple[str, ...],
) -> "CampaignRun | None":
    """The run of a campaign that is to be flown; None if none is asked for."""
    if source is None and run is None:
        return None
    if source is None or run is None:
        raise HarnessError("--from DIR and --run NUMBER belong together")
    given = {
        "SCENARIO": scenario,
        "--orbits": orbits,
        "--seed": seed,
        "--expect": expected or None,
        "--set": settings or None,
    }
    if wrong := [name for name, value in given.items() if value is not None]:
        raise HarnessError(f"{', '.join(wrong)}: with --from the run is as its campaign drew it")
    from sim.campaign.rerun import campaign_run

    return campaign_run(source, run)
