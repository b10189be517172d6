"""``torquer vectors``: a flight as golden vectors."""

from pathlib import Path

import click

from torquer.cli.options import FORCE, OUT_FILE, RUN_OR_LOG, examples, sentences

EXAMPLES = examples(
    "torquer vectors runs/microsat-20250320T120000Z --out microsat.jsonl",
    "torquer vectors runs/microsat-20250320T120000Z --out microsat.bin",
)


@click.command(epilog=EXAMPLES)
@RUN_OR_LOG
@OUT_FILE
@FORCE
@sentences
def vectors(run_or_log: Path, out: Path, force: bool) -> None:
    """Write what came in and went out in each tick of a flight, for unit tests of a flight software.

    FILE.jsonl has a tick a line, FILE.bin fixed records; docs/own-firmware.md says how they are read.
    """
    from sim.console import counted, say
    from sim.export.source import open_source
    from sim.export.vectors import write_vectors
    from sim.progress import note

    ticks, notes = write_vectors(open_source(run_or_log), out, force)
    for line in notes:
        note(f"note: {line}")
    say(f"written: {counted(ticks, 'tick')} in {out}")
