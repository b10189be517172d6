"""``torquer phasing``: which way coils and magnetometer are wired."""

from pathlib import Path
from typing import TypeVar

import click
from click.core import ParameterSource

from fsw.bus.open_bus import KINDS
from torquer.cli.completions import of_buses
from torquer.cli.options import (
    JSON,
    SCENARIO_OF_LOG,
    SEEDS,
    SETTINGS,
    Number,
    WholeNumber,
    examples,
    load_scenario,
    say_report,
    sentences,
)

EXAMPLES = examples(
    "torquer phasing microsat --set coils.wiring=[1,-2,3]    # in simulation: coil 2 is reversed",
    "torquer phasing microsat --bus socketcan:can0 --real coil,magnetometer --arm --field-nt 20000 0 -30000",
    "torquer phasing runs/microsat-20250320T120000Z          # a log with pulses",
    "torquer phasing mag_and_command.csv                     # a recorded bench log",
)

Value = TypeVar("Value")


@click.command(epilog=EXAMPLES)
@click.argument("source", metavar="SCENARIO|RUN|LOG|CSV")
@SCENARIO_OF_LOG
@click.option("--bus", shell_complete=of_buses, help=f"On a bench instead of in simulation: auto, {KINDS}.")
@click.option("--real", metavar="A,B", help="Boards that are hardware: coil, magnetometer, sun.")
@click.option("--arm", is_flag=True, help="Let coils be driven on the bench.")
@click.option("--at-rest", is_flag=True, help="A log of a bench: the satellite did not move.")
@click.option(
    "--rounds", default=1, show_default=True, type=WholeNumber(1, 100), help="Pulses of each polarity."
)
@click.option("--field-nt", type=(float, float, float), help="Field around the bench, body axes.")
@click.option(
    "--offset-nt",
    default=1000.0,
    show_default=True,
    type=Number(0.0, 1e5),
    help="Largest offset of the magnetometer, by axis: --field-nt is compared so closely.",
)
@click.option(
    "--coil-field-nt-per-am2",
    "coil_field",
    type=float,
    help="Field of each coil at the magnetometer, along its axis. Default: the table's.",
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of the plant.")
@click.option("--out", "-o", type=click.Path(path_type=Path), help="Keep the run in this folder.")
@SETTINGS
@JSON
@sentences
def phasing(
    source: str,
    scenario: str | None,
    bus: str | None,
    real: str | None,
    arm: bool,
    at_rest: bool,
    rounds: int,
    field_nt: tuple[float, float, float] | None,
    offset_nt: float,
    coil_field: float | None,
    seed: int,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Which way coils and magnetometer are wired: from pulses of each coil in both polarities.

    Of a SCENARIO the sequence is commanded in simulation, or on a bench with --bus; a RUN, LOG or CSV is
    judged as it is. Exit code 1: the wiring is not the table's, or cannot be determined; of a CSV, which
    tells no axis, that no reading responds to a command.
    """
    from sim.commissioning.phasing.command import is_scenario
    from sim.scenario.schema import parse_settings
    from torquer.api.phasing import phasing

    if is_scenario(source) and scenario is None:
        load_scenario(source, settings)  # says what is most likely wrong in it
    found = phasing(
        source,
        scenario=scenario,
        set=parse_settings(settings),
        bus=bus,
        real=real,
        arm=arm,
        at_rest=at_rest,
        rounds=_given("rounds", rounds),
        field_nt=field_nt,
        offset_nt=_given("offset_nt", offset_nt),
        coil_field_nt_per_am2=coil_field,
        seed=_given("seed", seed),
        out=out,
        progress=True,
    )
    return say_report(found.found)


def _given(name: str, value: Value) -> Value | None:
    """The value of an option; None where the command line does not give it."""
    source = click.get_current_context().get_parameter_source(name)
    return None if source is ParameterSource.DEFAULT else value
