"""``torquer report``: the report of a run, rebuilt."""

from pathlib import Path

import click

from torquer.cli.options import LAW_AGAIN, SIGN, VERIFY, report_failures, sentences


@click.command()
@click.argument("run", type=click.Path(path_type=Path))
@SIGN
@VERIFY
@LAW_AGAIN
@sentences
def report(run: Path, sign: Path | None, verify: Path | None, law: str | None) -> int:
    """Rebuild summary.json and report.html of a run; a run that was cut short is noted, and no failure."""
    from sim.report.verdict import Verdict
    from torquer.api.flight import report

    rebuilt = report(run, sign=sign, verify=verify, law=law, progress=True)
    for line in rebuilt.notes:
        click.echo(line)
    click.echo(str(rebuilt))
    click.echo(f"report: {rebuilt.report}")
    failed_in_flight = {name: why for name, why in rebuilt.failures.items() if name != Verdict.COMPLETE}
    return report_failures(failed_in_flight) or int(rebuilt.mismatched)
