"""``torquer phasing``: which way coils and magnetometer are wired."""

from pathlib import Path

import click
from click.core import ParameterSource

from fsw.bus.open_bus import KINDS
from sim.errors import HarnessError
from torquer.cli.completions import of_buses
from torquer.cli.numbers import Number, WholeNumber
from torquer.cli.options import JSON, SEEDS, SETTINGS, examples, load_scenario, sentences

EXAMPLES = examples(
    "torquer phasing microsat --set coils.wiring=[1,-2,3]    # in simulation: coil 2 is reversed",
    "torquer phasing microsat --bus socketcan:can0 --real coil,magnetometer --arm --field-nt 20000 0 -30000",
    "torquer phasing runs/microsat-20250320T120000Z          # a log with pulses",
    "torquer phasing mag_and_command.csv                     # a recorded bench log",
)

OF_A_BENCH = ("real", "arm")
OF_A_FLIGHT = ("bus", *OF_A_BENCH, "rounds", "seed", "out")
OF_A_LOG = ("scenario", "settings", "at_rest", "field_nt", "offset_nt", "coil_field")
"""Options by what they say something of."""


@click.command(epilog=EXAMPLES)
@click.argument("source", metavar="SCENARIO|RUN|LOG|CSV")
@click.option("--scenario", metavar="SCENARIO", help="Of a log that has none beside it.")
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
@click.option("--out", type=click.Path(path_type=Path), help="Keep the run in this folder.")
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
    judged as it is. Exit code 1: the wiring is not the table's, or cannot be told; of a CSV, which tells no
    axis, that no reading responds to a command.
    """
    import numpy as np

    from sim.bench.command import real_boards
    from sim.commissioning.phasing import command
    from sim.commissioning.phasing.bench_log import is_bench_log
    from sim.commissioning.phasing.judge import Known
    from sim.scenario.schema import parse_settings

    path = Path(source)
    known = Known(
        None if coil_field is None else coil_field * np.eye(3),
        None if field_nt is None else np.array(field_nt),
        offset_nt,
        in_orbit=not at_rest and bus is None,
    )
    if is_bench_log(path):
        _refuse((*OF_A_FLIGHT, *OF_A_LOG), f"{source} is a recorded bench log, which is judged by itself")
        return command.of_csv(path)
    if path.suffix != ".toml" and path.exists():
        _refuse(OF_A_FLIGHT, "a log is judged as it is; name a SCENARIO to fly or for a bench")
        return command.of_log(path, scenario, parse_settings(settings), known)
    if scenario is not None:
        raise HarnessError(f"--scenario: {source} is no log, but a scenario itself")
    if bus is None:
        _refuse(OF_A_BENCH, "without --bus the SCENARIO is flown in simulation")
    chosen = load_scenario(source, settings)
    if bus is None:
        return command.of_flight(chosen, rounds, seed, known, out)
    bench = command.BenchSetUp(bus, real_boards(real), arm)
    return command.on_bench(chosen, rounds, seed, known, bench, out)


def _refuse(names: tuple[str, ...], why: str) -> None:
    """Refuse options that would do nothing.

    Raises:
        HarnessError: the command line gives one of them.
    """
    context = click.get_current_context()
    given = [
        one.opts[0]
        for one in context.command.params
        if one.name in names and context.get_parameter_source(one.name) is not ParameterSource.DEFAULT
    ]
    if given:
        raise HarnessError(f"{', '.join(given)}: {why}")
