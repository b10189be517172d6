"""``torquer calibrate``: sensors and body from what was recorded."""

from pathlib import Path

import click

from torquer.cli.options import JSON, OUT_FILE, examples, sentences

EXAMPLES = examples(
    "torquer calibrate PASS.csv --tle tle.txt --out calibration.toml",
    "torquer calibrate PASS.csv --tle tle.txt --inertia-ratios 0.9987,1,0.178 --out cal.toml --page cal.html",
)


class Ratios(click.ParamType[tuple[float, ...]]):
    """Three positive numbers with commas between."""

    name = "X,Y,Z"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """The numbers."""
        try:
            numbers = tuple(float(word) for word in value.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != 3 or not all(1e-6 < number < 1e6 for number in numbers):
            self.fail(f"{value!r} is not three positive numbers with commas between", param, ctx)
        x, y, z = sorted(numbers)
        if x + y < z:
            self.fail(
                f"no body has the moments of inertia {value}: {x:g} + {y:g} is less than {z:g}", param, ctx
            )
        return numbers


@click.command(epilog=EXAMPLES)
@click.argument("recorded", metavar="PASS.csv", type=click.Path(path_type=Path))
@click.option(
    "--tle",
    required=True,
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Two-line element sets; of many the nearest is taken.",
)
@OUT_FILE
@click.option(
    "--page", metavar="FILE", type=click.Path(path_type=Path), help="Write the residuals as an HTML page too."
)
@click.option(
    "--inertia-ratios",
    "ratios",
    type=Ratios(),
    help="Moments of inertia about the body axes, in any unit. Default: a sphere's.",
)
@click.option(
    "--parameters",
    default="9",
    show_default=True,
    type=click.Choice(["9", "12"]),
    help="Of the magnetometer: offset and symmetric matrix, or a turn of its axes besides.",
)
@JSON
@sentences
def calibrate(
    recorded: Path, tle: Path, out: Path, page: Path | None, ratios: tuple[float, ...] | None, parameters: str
) -> int:
    """Calibrate magnetometer, Sun cells and body by telemetry in PASS.csv, recorded in orbit.

    The columns say quantity, axis and unit: utc_unix_s, mag_x_nt (or ut, mg, t), gyro_x_degps (or radps),
    sun_cell_NAME_raw (or ma, a), temperature_degc. Each value comes with its uncertainty and with the verdict
    whether the data tell it.
    """
    from sim.calibrate.command import calibrate_recorded

    return calibrate_recorded(recorded, tle, out, page, ratios, int(parameters))
