"""``torquer telemetry``: the flight filter over what a satellite recorded."""

from pathlib import Path

import click

from torquer.cli.options import JSON, Number, examples, say_report, sentences

EXAMPLES = examples(
    "torquer telemetry PASS.csv --tle tle.txt --calibration calibration.toml",
    "torquer telemetry PASS.csv --tle tle.txt --calibration calibration.toml --page pass.html --json",
)


@click.command(epilog=EXAMPLES)
@click.argument("recorded", metavar="PASS.csv", type=click.Path(path_type=Path))
@click.option(
    "--tle",
    required=True,
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Two-line element sets; of many the nearest is taken.",
)
@click.option(
    "--calibration",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="What `torquer calibrate` has written. Default: none, samples as they are.",
)
@click.option(
    "--start",
    "start_s",
    default=400.0,
    show_default=True,
    type=Number(min=20.0, max=100000.0),
    help="Seconds of field from which the filter starts.",
)
@click.option(
    "--page", metavar="FILE", type=click.Path(path_type=Path), help="Write an HTML page with pictures."
)
@JSON
@sentences
def telemetry(recorded: Path, tle: Path, calibration: Path | None, start_s: float, page: Path | None) -> int:
    """Run the flight filter, without gyros, over telemetry in PASS.csv that was recorded in orbit.

    It uses the magnetometer alone, and is judged by what it did not use: gyros, Sun cells, samples to come.
    Exit code 1: the motion cannot be determined, or what was not used speaks against it.
    """
    from torquer.api.telemetry import telemetry

    found = telemetry(recorded, tle=tle, calibration=calibration, start_s=start_s, page=page, progress=True)
    return say_report(found.found)
