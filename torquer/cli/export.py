"""``torquer export``: a run in the format of another tool."""

from pathlib import Path

import click

from torquer.cli.options import FORCE, LAW_AGAIN, OUT_FILE, RUN_OR_LOG, examples, sentences

EXAMPLES = examples(
    "torquer export runs/microsat-20250320T120000Z --out run.mcap",
    "torquer export runs/microsat-20250320T120000Z --format parquet --out run.parquet",
)


@click.command(epilog=EXAMPLES)
@RUN_OR_LOG
@click.option(
    "--format",
    "name",
    type=click.Choice(["mcap", "blf", "asc", "csv", "parquet", "netcdf"]),
    help="Default: by the suffix of FILE.",
)
@OUT_FILE
@FORCE
@LAW_AGAIN
@sentences
def export(run_or_log: Path, name: str | None, out: Path, force: bool, law: str | None) -> int:
    """Write a run for Foxglove (mcap), CANalyzer and SavvyCAN (blf, asc), pandas or xarray.

    mcap, blf and asc hold the bus log, and a LOG alone will do; csv, parquet and netcdf the histories of
    plant and estimates, a row a tick. docs/export.md says what opens them.
    """
    from sim.console import say
    from torquer.api.export import export

    written = export(run_or_log, out, format=name, force=force, law=law, progress=True)
    say(str(written))
    return int(not written.ok)
