"""``torquer xtce``: the bus contract as XTCE."""

from pathlib import Path

import click

from torquer.cli.options import OUT_FILE, examples, sentences

EXAMPLES = examples(
    "torquer xtce --out torquer.xml",
    "torquer xtce --out torquer.xml --force",
)


@click.command(epilog=EXAMPLES)
@OUT_FILE
@click.option("--force", is_flag=True, help="Replace FILE if it is there.")
@sentences
def xtce(out: Path, force: bool) -> None:
    """Write the messages of the bus as XTCE 1.2, for Yamcs and other mission control systems."""
    from sim.console import say
    from sim.export.destination import write_text
    from sim.export.xtce import xtce_text

    write_text(out, xtce_text(), force)
    say(f"written: {out}")
