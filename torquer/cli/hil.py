"""``torquer hil``: the flight software in real time against boards."""

from pathlib import Path

import click

from sim.errors import HarnessError
from torquer.cli.options import (
    JSON,
    SEEDS,
    Number,
    WholeNumber,
    bus_option,
    examples,
    law_and_settings,
    load_scenario,
    scenario_argument,
    sentences,
)

EXAMPLES = examples(
    "torquer hil microsat --seconds 60                       # all boards as stubs",
    "torquer hil microsat --bus socketcan:can0 --real coil   # not armed: coils stay off",
    "torquer hil microsat --bus socketcan:can0 --conformance coil --arm",
)

BUDGET = Number(0.0)
"""Below zero it would be broken in any run."""


@click.command(epilog=EXAMPLES)
@scenario_argument("microsat")
@bus_option()
@click.option("--real", metavar="A,B", help="Boards that are hardware: coil, magnetometer, sun, cells.")
@click.option("--arm", is_flag=True, help="Let coils be driven; without it no request reaches the bus.")
@click.option(
    "--seconds",
    default=60.0,
    show_default=True,
    type=Number(0.0, 1e6, min_open=True),
    help="How long.",
)
@click.option("--tick-hz", type=WholeNumber(1, 100), help="Ticks a second. Default: the scenario's.")
@click.option(
    "--stimulus", default="plant", show_default=True, help="What sensors see: plant, RUN, LOG or FILE.toml."
)
@click.option(
    "--jitter-ms", default=10.0, show_default=True, type=BUDGET, help="Budget of SYNC's jitter, p99."
)
@click.option("--latency-ms", type=BUDGET, help="Budget of SYNC to TICK_DONE, p99. Default: half a tick.")
@click.option(
    "--slips",
    default=0,
    show_default=True,
    type=WholeNumber(0),
    help="Budget of ticks without answer or sample.",
)
@click.option(
    "--load-percent", default=50.0, show_default=True, type=BUDGET, help="Budget of the bus load, mean."
)
@click.option(
    "--memory-percent",
    default=2.0,
    show_default=True,
    type=BUDGET,
    help="Budget of each process' growth once warm.",
)
@click.option(
    "--warm-s",
    default=60.0,
    show_default=True,
    type=Number(0.0),
    help="From when on memory is judged, in a longer run.",
)
@click.option(
    "--deadman-s",
    default=5.0,
    show_default=True,
    type=Number(0.1, 3600.0),
    help="The coil board's dead-man.",
)
@click.option(
    "--conformance",
    type=click.Choice(["coil", "magnetometer", "sun", "cells"]),
    help="Instead, check one board, alone on the bus, against docs/icd.md; its limits are SCENARIO's.",
)
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of the plant.")
@click.option("--out", "-o", type=click.Path(path_type=Path), help="Write log and numbers into this folder.")
@law_and_settings
@JSON
@sentences
def hil(
    scenario: str,
    bus: str,
    real: str | None,
    arm: bool,
    seconds: float,
    tick_hz: int | None,
    stimulus: str,
    jitter_ms: float,
    latency_ms: float | None,
    slips: int,
    load_percent: float,
    memory_percent: float,
    warm_s: float,
    deadman_s: float,
    conformance: str | None,
    seed: int,
    out: Path | None,
    settings: tuple[str, ...],
) -> int:
    """SCENARIO in real time: flight software against boards, each its own process or real hardware."""
    rate = (f"time.tick_hz={tick_hz}",) if tick_hz is not None else ()
    if conformance is not None and out is not None:
        raise HarnessError("--out: a conformance run writes no log")
    if conformance is not None:
        from sim.conformance.command import conformance as conform
        from sim.scenario.schema import load, parse_settings

        chosen = load(scenario, parse_settings((*settings, *rate)))  # of its limits, none is a mistake
        return conform(chosen, conformance, bus, arm, deadman_s)
    from sim.bench import command

    chosen = load_scenario(scenario, (*settings, *rate), lambda chosen: command.ticks_in(chosen, seconds))
    from sim.bench.budgets import Budgets

    half_ms = 500.0 / chosen.time.tick_hz
    latency = half_ms if latency_ms is None else latency_ms
    budgets = Budgets(jitter_ms, latency, slips, load_percent, memory_percent)
    boards = command.real_boards(real)
    run_settings = command.HilSettings(
        chosen, bus, boards, arm, seconds, stimulus, deadman_s, budgets, warm_s, seed, out
    )
    return command.hil(run_settings)
