"""``torquer compare``: control laws side by side."""

from pathlib import Path

import click

from torquer.cli.completions import of_laws
from torquer.cli.options import (
    JSON,
    SEEDS,
    Number,
    WholeNumber,
    examples,
    law_and_settings,
    load_scenario,
    scenario_argument,
    sentences,
)

EXAMPLES = examples(
    "torquer compare microsat",
    "torquer compare cubesat6u --laws pd,mpc --driver pulsed --orbits 3",
)


@click.command(epilog=EXAMPLES)
@scenario_argument("microsat")
@click.option(
    "--laws",
    metavar="A,B",
    shell_complete=of_laws,
    help="Laws, aims or all, beside one of your own. Default: all that are meant for the body.",
)
@click.option(
    "--driver", default="both", show_default=True, type=click.Choice(["pulsed", "continuous", "both"])
)
@click.option(
    "--gains",
    default="best",
    show_default=True,
    metavar="best|scenario|FILE",
    help="Those found for the body that ship, the scenario's, or of `torquer design --laws`.",
)
@click.option("--orbits", type=Number(min=0.0, min_open=True), help="Default: those of the scenario.")
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--workers", "-n", type=WholeNumber(min=1), help="Processes. Default: one a core.")
@click.option(
    "--out", "-o", type=click.Path(path_type=Path), help="Folder. Default: compare/<scenario>-<UTC time>."
)
@law_and_settings
@JSON
@sentences
def compare(
    scenario: str,
    laws: str | None,
    driver: str,
    gains: str,
    orbits: float | None,
    seed: int,
    workers: int | None,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Fly every applicable control law on SCENARIO, all else the same: table and picture."""
    from sim.console import answer, fail, say
    from sim.flight.record_flight import ticks_of
    from sim.scenario.schema import parse_settings

    load_scenario(scenario, settings, lambda chosen: ticks_of(chosen, orbits))
    from torquer.api.compare import compare  # once the scenario is known to be sound: it takes a second

    compared = compare(
        scenario,
        laws=laws,
        driver=driver,
        gains=gains,
        orbits=orbits,
        seed=seed,
        set=parse_settings(settings),
        workers=workers,
        out=out,
        progress=True,
    )
    say(str(compared))
    first, *others = compared.found.files
    say(f"files: {first}, {', '.join(file.name for file in others)}")
    answer({**compared.values, "files": compared.found.files})
    for sentence in compared.failures:
        fail(sentence)
    return int(not compared.ok)
