"""``torquer dbc``: the bus contract as a DBC file."""

from pathlib import Path

import click

from torquer.cli.options import FORCE, TEXT_OUT, WholeNumber, examples, sentences, write_text_out

EXAMPLES = examples(
    "torquer dbc > torquer.dbc",
    "torquer dbc --tick-hz 10 --out torquer.dbc --force",
)


@click.command(epilog=EXAMPLES)
@TEXT_OUT
@click.option(
    "--tick-hz",
    type=WholeNumber(1, 100),
    default=1,
    show_default=True,
    help="Ticks a second, for the cycle times.",
)
@FORCE
@sentences
def dbc(out: Path | None, tick_hz: int, force: bool) -> None:
    """Write the messages of the bus as a DBC with cycle times, for CANalyzer, SavvyCAN, cantools."""
    from sim.export.dictionary import dbc_text

    write_text_out(out, dbc_text(tick_hz), force)
