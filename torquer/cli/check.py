"""``torquer check``: the audit of the actuator limits in a log."""

from pathlib import Path

import click

from torquer.cli.options import CHANNEL, JSON, JUNIT, RUN_OR_LOG, VERIFY, examples, sentences

EXAMPLES = examples(
    "torquer check runs/microsat-20250320T120000Z",
    "torquer check candump.log --backoff per_coil   # a log without its scenario",
    "torquer check RUN --junit check.xml --quiet    # in CI",
)


@click.command(epilog=EXAMPLES)
@RUN_OR_LOG
@click.option("--backoff", type=click.Choice(["shared", "per_coil"]), help="Limits of a bare log.")
@click.option(
    "--clock",
    type=click.Choice(["both", "ticks"]),
    default="both",
    show_default=True,
    help="ticks: by ticks alone, of a simulation whose ticks are not real time.",
)
@CHANNEL
@VERIFY
@JUNIT
@JSON
@sentences
def check(
    run_or_log: Path,
    backoff: str | None,
    clock: str,
    channel: str | None,
    verify: Path | None,
    junit: Path | None,
) -> int:
    """Audit the actuator limits in a candump log, independently of the controller."""
    from sim.audit.documents import as_json, suites
    from sim.console import answer, say
    from sim.junit import prepare_junit, write_junit
    from torquer.api.audit import check

    prepare_junit(junit)
    audit = check(run_or_log, backoff=backoff, clock=clock, channel=channel, verify=verify, progress=True)
    say(str(audit), failed=not audit.ok)
    answer(as_json(audit.report))
    write_junit(junit, "torquer check", suites(audit.report))
    return audit.report.exit_code
