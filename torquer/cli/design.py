"""``torquer design``: gains from Floquet theory."""

from pathlib import Path

import click

from torquer.cli.options import JSON, examples, law_and_settings, scenario_argument, sentences

EXAMPLES = examples(
    "torquer design microsat",
    "torquer design microsat --gains 6.3e6 1600",
    "torquer design my-satellite.toml --write",
)


@click.command(epilog=EXAMPLES)
@scenario_argument()
@click.option("--gains", nargs=2, type=float, metavar="K_W K_A", help="Evaluate these instead of searching.")
@click.option("--write", is_flag=True, help="Write the gains into SCENARIO, a file.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of pictures; default: runs/design-<scenario>, with --json none.",
)
@law_and_settings
@JSON
@sentences
def design(
    scenario: str,
    gains: tuple[float, float] | None,
    write: bool,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Gains of the PD law for SCENARIO by Floquet theory: exponents, margins, maps, best gains."""
    from sim.console import answer, current, say
    from sim.scenario.schema import load, parse_settings
    from torquer.api.design import design

    over = parse_settings(settings)
    if out is None and not current().as_json:
        out = Path("runs") / f"design-{load(scenario, over).name}"
    found = design(scenario, gains=gains, set=over, write=write, out=out, progress=True)
    say(str(found), failed=not found.ok)
    answer(found.values)
    if found.pictures:
        say(f"pictures: {', '.join(map(str, found.pictures))}")
        answer({"pictures": found.pictures})
    if found.written:
        say(f"written: k_w and k_a of {found.written}")
        answer({"written": found.written})
    return int(not found.ok)
