"""``torquer new``: a scenario for a user's satellite."""

import sys
from pathlib import Path
from typing import Any

import click

from torquer.cli.options import JSON, Number, examples, sentences
from torquer.cli.satellite_options import asked, satellite, satellite_options

EXAMPLES = examples(
    "torquer new my-satellite                       # asks, on a terminal",
    "torquer new my-3u --altitude-km 550 --inclination-deg 97.6 --mass-kg 4 --size-m 0.34 0.1 0.1",
    "torquer new my-50kg --tle elements.txt --inertia-kgm2 1.0 1.9 2.0 --levels-am2 0.5 2 8",
)


@click.command(epilog=EXAMPLES)
@click.argument("name")
@satellite_options
@click.option("--backoff", default="shared", show_default=True, type=click.Choice(["shared", "per_coil"]))
@click.option("--magnetometer-nt", default=200.0, show_default=True, type=Number(0.0), help="Noise.")
@click.option("--sun-deg", default=0.5, show_default=True, type=Number(0.0), help="Noise.")
@click.option(
    "--bounds",
    default="exact",
    show_default=True,
    type=click.Choice(["exact", "ordinary"]),
    help="exact: the onboard table is right but for magnetometer bias, residual dipole and torque; "
    "ordinary: no part of it is.",
)
@click.option("--out", "-o", type=click.Path(path_type=Path), help="The file. Default: NAME.toml.")
@JSON
@sentences
def new(
    name: str,
    tle: Path | None,
    backoff: str,
    bounds: str,
    out: Path | None,
    **figures: Any,  # noqa: ANN401  (as click gives them)
) -> int:
    """Write NAME.toml, a commented scenario for your own satellite, which flies at once.

    Without an orbit or a body it asks for them on a terminal.
    """
    from sim.new_scenario import command

    command.check_new(name, out or Path(f"{name}.toml"))
    if sys.stdin.isatty() and sys.stderr.isatty():
        figures, tle = asked(figures, tle)
    figures |= {"per_coil": backoff == "per_coil", "exact": bounds == "exact"}
    return command.new(satellite(name, tle, figures), out)
