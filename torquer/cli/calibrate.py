"""``torquer calibrate``: sensors, coils and body from what they sent, or what was recorded."""

from pathlib import Path

import click

from torquer.cli.options import JSON, SCENARIO_OF_LOG, SETTINGS, examples, say_report, sentences

EXAMPLES = examples(
    "torquer calibrate RUN --out calibration.toml --page calibration.html    # flown with law phasing",
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
        from sim.commissioning.calibrate.command import fault_of_ratios

        if len(numbers) != 3:
            self.fail(f"{value!r} is not three positive numbers with commas between", param, ctx)
        if fault := fault_of_ratios(numbers):
            self.fail(fault, param, ctx)
        return numbers


@click.command(epilog=EXAMPLES)
@click.argument("source", metavar="RUN|LOG|PASS.csv", type=click.Path(path_type=Path))
@SCENARIO_OF_LOG
@click.option(
    "--tle",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Two-line element sets of a PASS.csv; of many the nearest is taken.",
)
@click.option("--out", "-o", metavar="FILE", type=click.Path(path_type=Path), help="The file to write.")
@click.option(
    "--page", metavar="FILE", type=click.Path(path_type=Path), help="Write the residuals as an HTML page too."
)
@click.option(
    "--inertia-ratios",
    "ratios",
    type=Ratios(),
    help="Of a PASS.csv: moments of inertia about the body axes, in any unit. Default: a sphere's.",
)
@click.option(
    "--parameters",
    default="9",
    show_default=True,
    type=click.Choice(["9", "12"]),
    help="Of a PASS.csv: offset and symmetric matrix, or a turn of the axes besides.",
)
@SETTINGS
@JSON
@sentences
def calibrate(
    source: Path,
    scenario: str | None,
    tle: Path | None,
    out: Path | None,
    page: Path | None,
    ratios: tuple[float, ...] | None,
    parameters: str,
    settings: tuple[str, ...],
) -> int:
    """Calibrate sensors, coils and body by a RUN or LOG with pulses, or by telemetry in PASS.csv.

    Of a log: magnetometer by twelve numbers, the coils' field, delay and dipoles; --out writes the tables
    [calibration] and [uncertainty], in a scenario under [flight]. Exit code 1: it does not tell everything.

    Of PASS.csv: magnetometer, Sun cells and body. The columns say quantity, axis and unit: utc_unix_s,
    mag_x_nt (or ut, mg, t), gyro_x_degps (or radps), sun_cell_NAME_raw (or ma, a), temperature_degc. Each
    value comes with its uncertainty and with the verdict whether the data tell it. Exit code 1: they do not
    tell the magnetometer; cells and body are left out of the file where they are not determined.
    """
    from sim.scenario.schema import parse_settings
    from torquer.api.calibrate import calibrate

    found = calibrate(
        source,
        scenario=scenario,
        set=parse_settings(settings),
        tle=tle,
        inertia_ratios=ratios,
        parameters=int(parameters),
        out=out,
        page=page,
        progress=True,
    )
    return say_report(found.found)
