"""``torquer design``: gains from Floquet theory."""

from pathlib import Path

import click

from torquer.cli.options import SETTINGS, sentences


@click.command()
@click.argument("scenario")
@click.option("--gains", nargs=2, type=float, metavar="K_W K_A", help="Evaluate these instead of searching.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON alone; pictures only with --out.")
@click.option("--write", is_flag=True, help="Write the gains into SCENARIO, a file.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder of pictures; default: runs/design-<scenario>."
)
@SETTINGS
@sentences
def design(
    scenario: str,
    gains: tuple[float, float] | None,
    as_json: bool,
    write: bool,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Gains of the PD law for SCENARIO by Floquet theory: exponents, margins, maps, best gains."""
    from sim.design import command

    return command.design(scenario, settings, gains, as_json, write, out)
