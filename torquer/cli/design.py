"""``torquer design``: gains from Floquet theory."""

from pathlib import Path

import click

from torquer.cli.completions import of_laws
from torquer.cli.options import JSON, WholeNumber, examples, law_and_settings, scenario_argument, sentences

EXAMPLES = examples(
    "torquer design microsat",
    "torquer design microsat --gains 6.3e6 1600",
    "torquer design my-satellite.toml --write",
    "torquer design my-satellite.toml --laws pd,lqr,sliding",
)


@click.command(epilog=EXAMPLES)
@scenario_argument()
@click.option("--gains", nargs=2, type=float, metavar="K_W K_A", help="Evaluate these instead of searching.")
@click.option("--write", is_flag=True, help="Write the gains into SCENARIO, a file.")
@click.option(
    "--laws",
    metavar="A,B|all",
    shell_complete=of_laws,
    help="Search the gains of these laws by flights.",
)
@click.option(
    "--keep",
    type=click.Path(path_type=Path),
    help="With --laws: their file; gains that it has stay if they still fly as well. "
    "Default: SCENARIO-gains.toml.",
)
@click.option("--flights", type=WholeNumber(min=4), help="With --laws: flights for each. Default: 24.")
@click.option(
    "--out",
    "-o",
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
    laws: str | None,
    keep: Path | None,
    flights: int | None,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Gains of the PD law for SCENARIO by Floquet theory: exponents, margins, maps, best gains.

    With --laws those of any law, by flights of the rigid body under rules that are the same for all, borne
    out by whole flights.
    """
    from sim.console import answer, current, say
    from sim.scenario.schema import load, parse_settings

    over = parse_settings(settings)
    _check_together(
        laws, {"--gains": gains, "--write": write, "--out": out}, {"--keep": keep, "--flights": flights}
    )
    name = load(scenario, over).name
    if laws is not None:
        from sim.tuning.command import design_laws

        kept = design_laws(scenario, over, laws, keep, flights)
        answer({"gains": kept.rows})
        return 0
    from torquer.api.design import design  # loaded once the scenario is known to be sound: it takes a second

    if out is None and not current().as_json:
        out = Path("runs") / f"design-{name}"
    found = design(scenario, gains=gains, set=over, write=write, out=out, progress=True)
    say(str(found), failed=not found.ok)
    answer(found.values)
    if found.pictures:
        say(f"pictures: {', '.join(map(str, found.pictures))}")
        answer({"pictures": found.pictures})
    if found.written:
        which = "the best for a continuous dipole" if gains is None else "those given"
        say(f"written: k_w and k_a of {found.written}, {which}")
        answer({"written": found.written})
    return int(not found.ok)


def _check_together(laws: str | None, of_one: dict[str, object], of_many: dict[str, object]) -> None:
    """Refuse options of the other search: they would have no effect."""
    for option in (option for option, given in of_one.items() if given and laws is not None):
        raise click.UsageError(f"{option} has no effect with --laws: the gains go to --keep")
    for option in (option for option, given in of_many.items() if given and laws is None):
        raise click.UsageError(f"{option} belongs to --laws")
