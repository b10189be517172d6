"""``torquer design``: gains from Floquet theory."""

import json
from pathlib import Path

import click

from torquer.cli.options import law_and_settings, sentences


@click.command()
@click.argument("scenario")
@click.option("--gains", nargs=2, type=float, metavar="K_W K_A", help="Evaluate these instead of searching.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON alone; pictures only with --out.")
@click.option("--write", is_flag=True, help="Write the gains into SCENARIO, a file.")
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder of pictures; default: runs/design-<scenario>."
)
@law_and_settings
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
    from sim.scenario.schema import load, parse_settings
    from torquer.api.design import design

    over = parse_settings(settings)
    if out is None and not as_json:
        out = Path("runs") / f"design-{load(scenario, over).name}"
    found = design(scenario, gains=gains, set=over, write=write, out=out, progress=True)
    click.echo(json.dumps(found.values, indent=2) if as_json else str(found))
    if found.pictures:
        click.echo(f"pictures: {', '.join(map(str, found.pictures))}", err=as_json)
    if found.written:
        click.echo(f"written: k_w and k_a of {found.written}", err=as_json)
    return int(not found.ok)
