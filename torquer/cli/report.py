"""``torquer report``: the report of a run, rebuilt."""

from pathlib import Path

import click

from torquer.cli.options import SIGN, VERIFY, report_failures, sentences


@click.command()
@click.argument("run", type=click.Path(path_type=Path))
@SIGN
@VERIFY
@sentences
def report(run: Path, sign: Path | None, verify: Path | None) -> int:
    """Rebuild summary.json and report.html of a run; a run that was cut short is noted, and no failure."""
    from sim.progress import progress
    from sim.record import run_dir
    from sim.record.binding import require_sources, sign_run
    from sim.record.signature import private_key, public_key, signature_path
    from sim.report.conclude import conclude
    from sim.report.summary import summary_text
    from sim.report.verdict import Verdict

    key = None if sign is None else private_key(sign)
    binding = require_sources(run, None if verify is None else public_key(verify))
    before = (run / run_dir.RUN).read_bytes()
    with progress("replaying", run_dir.read_run(run)["ticks"]) as watch:
        summary = conclude(run, watch)
    if key is not None:
        sign_run(run, key)
    elif signature_path(run / run_dir.RUN).exists() and (run / run_dir.RUN).read_bytes() != before:
        click.echo(f"note: {run_dir.RUN} is no longer what was signed: --sign KEY signs it again", err=True)
    for line in binding.lines:
        click.echo(line)
    click.echo(summary_text(summary))
    click.echo(f"report: {run / run_dir.REPORT}")
    failed: dict[str, str] = summary.get("failures", {})
    failed_in_flight = {name: clause for name, clause in failed.items() if name != Verdict.COMPLETE}
    return report_failures(failed_in_flight) or int(not binding.holds)
