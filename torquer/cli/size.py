"""``torquer size``: coil levels, and what pointing to expect."""

from pathlib import Path
from typing import Any

import click

from sim.errors import HarnessError
from torquer.cli.options import JSON, SETTINGS, examples, load_scenario, scenario_argument, sentences
from torquer.cli.satellite_options import satellite, satellite_options

EXAMPLES = examples(
    "torquer size microsat",
    "torquer size my-satellite.toml --set disturbance.torque_nm=[1e-7,1e-7,1e-7]",
    "torquer size --altitude-km 550 --inclination-deg 97.6 --mass-kg 4 --size-m 0.34 0.1 0.1",
)


@click.command(epilog=EXAMPLES)
@scenario_argument(required=False)
@satellite_options
@SETTINGS
@JSON
@sentences
def size(
    scenario: str | None,
    tle: Path | None,
    settings: tuple[str, ...],
    **figures: Any,  # noqa: ANN401  (as click gives them)
) -> int:
    """Coil levels that would do, and what pointing to expect of SCENARIO or of the satellite given.

    Exit code 1: the coils cannot balance the disturbance. Equations and how well they agree with flights are
    in docs/sizing.md.
    """
    from sim.console import warn
    from sim.new_scenario.command import figure_warnings, in_options, scenario_made, scenario_text
    from sim.scenario.schema import parse_settings
    from sim.sizing.command import size as command
    from sim.sizing.scenario_warnings import scenario_warnings

    usual = {"driver": "pulsed", "sun": "sensor"}
    given = [name for name, value in {"tle": tle, **figures}.items() if value != usual.get(name)]
    if scenario is not None and given:
        raise HarnessError(f"SCENARIO and --{given[0].replace('_', '-')} exclude each other")
    if scenario is not None:
        return command(load_scenario(scenario, settings))
    new_satellite = satellite("satellite", tle, figures)
    given_here = scenario_made(scenario_text(new_satellite, "satellite.toml"), parse_settings(settings))
    for doubt in (*figure_warnings(new_satellite, given_here), *scenario_warnings(given_here)):
        warn(in_options(doubt))
    return command(given_here)
