"""``torquer report``: the report of a run, rebuilt."""

from pathlib import Path

import click

from torquer.cli.options import JSON, JUNIT, LAW_AGAIN, SIGN, VERIFY, examples, report_failures, sentences

EXAMPLES = examples(
    "torquer report runs/microsat-20250320T120000Z",
    "torquer report runs/microsat-20250320T120000Z --json   # summary.json and the verdicts",
    "torquer report runs/microsat-20250320T120000Z --figures pdf   # for a paper",
)


@click.command(epilog=EXAMPLES)
@click.argument("run", type=click.Path(path_type=Path))
@SIGN
@VERIFY
@LAW_AGAIN
@click.option(
    "--figures",
    type=click.Choice(["pdf", "svg"]),
    help="Draw figures for papers into RUN/figures too, in vector graphics.",
)
@JUNIT
@JSON
@sentences
def report(
    run: Path,
    sign: Path | None,
    verify: Path | None,
    law: str | None,
    figures: str | None,
    junit: Path | None,
) -> int:
    """Rebuild summary.json and report.html of a run; a run that was cut short is noted, and no failure."""
    from sim.console import answer, say
    from sim.junit import prepare_junit, write_junit
    from sim.report.paper.kind import FOLDER
    from sim.report.requirements.documents import suites
    from sim.report.verdict import Verdict
    from torquer.api.flight import report

    prepare_junit(junit)
    rebuilt = report(run, sign=sign, verify=verify, law=law, figures=figures, progress=True)
    for line in rebuilt.notes:
        say(line, failed=rebuilt.mismatched)
    say(str(rebuilt))
    say(f"report: {rebuilt.report}")
    if figures is not None:
        names = ", ".join(file.name for file in rebuilt.figures) or "nothing to draw"
        say(f"figures: {rebuilt.path / FOLDER}: {names}")
        answer({"figures": rebuilt.figures})
    answer({"run": rebuilt.path, "report": rebuilt.report, "summary": rebuilt.summary})
    answer({"binding": rebuilt.notes})
    write_junit(junit, "torquer report", suites(rebuilt.summary))
    failed_in_flight = {name: why for name, why in rebuilt.failures.items() if name != Verdict.COMPLETE}
    return report_failures(failed_in_flight) or int(rebuilt.mismatched)
