"""``torquer check``: the audit of the actuator limits in a log."""

from pathlib import Path

import click

from torquer.cli.options import RUN_OR_LOG, VERIFY, sentences


@click.command()
@RUN_OR_LOG
@click.option("--backoff", type=click.Choice(["shared", "per_coil"]), help="Limits of a bare log.")
@VERIFY
@sentences
def check(run_or_log: Path, backoff: str | None, verify: Path | None) -> int:
    """Audit the actuator limits in a candump log, independently of the controller."""
    from torquer.api.audit import check

    audit = check(run_or_log, backoff=backoff, verify=verify, progress=True)
    click.echo(str(audit))
    return int(not audit.ok)
