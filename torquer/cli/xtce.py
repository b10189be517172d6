"""``torquer xtce``: the bus contract as XTCE."""

from pathlib import Path

import click

from torquer.cli.options import FORCE, TEXT_OUT, examples, sentences, write_text_out

EXAMPLES = examples(
    "torquer xtce > torquer.xml",
    "torquer xtce --out torquer.xml --force",
)


@click.command(epilog=EXAMPLES)
@TEXT_OUT
@FORCE
@sentences
def xtce(out: Path | None, force: bool) -> None:
    """Write the messages of the bus as XTCE 1.2, for Yamcs and other mission control systems."""
    from sim.export.xtce import xtce_text

    write_text_out(out, xtce_text(), force)
