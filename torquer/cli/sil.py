"""``torquer sil``: a scenario with software in the loop."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sim.errors import HarnessError
from torquer.cli.options import (
    COMPRESS,
    JSON,
    JUNIT,
    PACE,
    SEEDS,
    SIGN,
    Number,
    WholeNumber,
    bus_option,
    examples,
    law_and_settings,
    read_scenario,
    report_failures,
    scenario_argument,
    sentences,
)

if TYPE_CHECKING:
    from sim.campaign.command import CampaignRun


EXAMPLES = examples(
    "torquer sil                                             # the default scenario, ten orbits",
    "torquer sil microsat --bus virtual --orbits 3 --seed 2",
    "torquer sil my-satellite.toml --set coils.backoff=per_coil --set time.tick_hz=10",
    "torquer sil --from campaigns/tolerances --run 17        # a run of a campaign again",
)


@click.command(epilog=EXAMPLES)
@scenario_argument(required=False)
@bus_option(" or virtual.")
@PACE
@click.option("--orbits", type=Number(min=0.0, min_open=True), help="Default: those of the scenario.")
@click.option("--seed", type=SEEDS, help="Of all random streams. Default: 1.")
@click.option("--out", "-o", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
@click.option(
    "--from",
    "source",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Fly a run of this campaign again.",
)
@click.option("--run", type=WholeNumber(min=0), help="Its number. With --from.")
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
@JUNIT
@JSON
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
    junit: Path | None,
) -> int:
    """Fly SCENARIO (realsat): plant and flight software as two processes on a bus (virtual: in one)."""
    from sim.console import answer, detail, fail, say
    from sim.junit import prepare_junit, write_junit
    from torquer.api.flight import fly

    prepare_junit(junit)
    again = _campaign_run(source, run, scenario, orbits, seed, expected, settings)
    chosen = again.scenario if again else read_scenario(scenario or "realsat", settings)
    flown = fly(
        chosen,
        orbits=orbits,
        seed=again.seed if again else 1 if seed is None else seed,
        bus=bus,
        pace=pace,
        expect=expected,
        out=out,
        compress=compress,
        sign=sign,
        progress=True,
    )
    if not flown.concluded:
        fail(str(flown))
        return 1
    from sim.report.requirements.documents import suites  # loaded after the flight, which does not need it

    detail(f"files in {flown.path}: {', '.join(sorted(file.name for file in flown.path.iterdir()))}")
    say(str(flown))
    say(f"report: {flown.report}")
    answer({"run": flown.path, "report": flown.report, "summary": flown.summary})
    write_junit(junit, "torquer sil", suites(flown.summary))
    equal = again is None or _equals(again, flown.path)
    return report_failures(flown.failures) or int(not equal)


def _equals(again: "CampaignRun", path: Path) -> bool:
    """Whether the run is the campaign's, bit for bit, and say so."""
    from sim.campaign.command import compare_with_row
    from sim.console import answer, say

    equal, sentence = compare_with_row(again, path)
    say(sentence, failed=not equal)
    answer({"equal": equal})
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
    from sim.campaign.command import campaign_run

    return campaign_run(source, run)
