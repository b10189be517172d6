"""``torquer dbc``: the bus contract as a DBC file."""

from pathlib import Path

import click

from torquer.cli.numbers import WholeNumber
from torquer.cli.options import OUT_FILE, examples, sentences

EXAMPLES = examples(
    "torquer dbc --out torquer.dbc",
    "torquer dbc --tick-hz 10 --out torquer.dbc --force",
)


@click.command(epilog=EXAMPLES)
@OUT_FILE
@click.option(
    "--tick-hz",
    type=WholeNumber(1, 100),
    default=1,
    show_default=True,
    help="Ticks a second, for the cycle times.",
)
@click.option("--force", is_flag=True, help="Replace FILE if it is there.")
@sentences
def dbc(out: Path, tick_hz: int, force: bool) -> None:
    """Write the messages of the bus as a DBC with cycle times, for CANalyzer, SavvyCAN, cantools."""
    from sim.console import say
    from sim.export.dbc import dbc_text
    from sim.export.destination import write_text

    write_text(out, dbc_text(tick_hz), force)
    say(f"written: {out}")
