"""``torquer report``: the reports of runs, rebuilt, and the requirements of several against each other."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from torquer.cli.options import JSON, JUNIT, LAW_AGAIN, SIGN, VERIFY, examples, report_failures, sentences

if TYPE_CHECKING:
    from torquer.api.run import Run

EXAMPLES = examples(
    "torquer report runs/microsat-20250320T120000Z",
    "torquer report runs/microsat-20250320T120000Z --json   # summary.json and the verdicts",
    "torquer report runs/microsat-20250320T120000Z --figures pdf   # for a paper",
    "torquer report runs/*/ --out requirements.html         # the requirements against all runs",
)


@click.command(epilog=EXAMPLES)
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--out",
    "-o",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="The page of several runs. Default: requirements.html in the folder that holds them.",
)
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
    runs: tuple[Path, ...],
    out: Path | None,
    sign: Path | None,
    verify: Path | None,
    law: str | None,
    figures: str | None,
    junit: Path | None,
) -> int:
    """Rebuild summary.json and report.html of each RUN; one that was cut short is noted, and no failure.

    Of several runs it also makes a page of their requirements against the runs: verdict, value and margin.
    """
    from sim.console import say
    from sim.junit import prepare_junit
    from torquer.api import flight

    if len(runs) == 1 and out is not None:
        raise click.UsageError("--out is for several runs: that of one stands in its folder")
    prepare_junit(junit)
    page = _prepared_page(runs, out) if len(runs) > 1 else None
    rebuilt = []
    for path in runs:
        rebuilt.append(flight.report(path, sign=sign, verify=verify, law=law, figures=figures, progress=True))
        for line in rebuilt[-1].notes:
            say(line if page is None else f"{path}: {line}", failed=rebuilt[-1].mismatched)
    return (
        _report_one(rebuilt[0], figures, junit)
        if page is None
        else _report_several(rebuilt, figures, page, junit)
    )


def _report_one(rebuilt: "Run", figures: str | None, junit: Path | None) -> int:
    from sim.console import answer, say
    from sim.junit import write_junit
    from sim.report.requirements.documents import suites

    say(str(rebuilt))
    say(f"report: {rebuilt.report}")
    _say_figures(rebuilt, figures)
    if figures is not None:
        answer({"figures": rebuilt.figures})
    answer({"run": rebuilt.path, "report": rebuilt.report, "summary": rebuilt.summary})
    answer({"binding": rebuilt.notes})
    write_junit(junit, "torquer report", suites(rebuilt.summary))
    return report_failures(_failed_in_flight(rebuilt)) or int(rebuilt.mismatched)


def _say_figures(rebuilt: "Run", figures: str | None) -> None:
    from sim.console import say
    from sim.record.run_dir import FIGURES

    if figures is not None:
        names = ", ".join(file.name for file in rebuilt.figures) or "nothing to draw"
        say(f"figures: {rebuilt.path / FIGURES}: {names}")


def _report_several(rebuilt: "Sequence[Run]", figures: str | None, page: Path, junit: Path | None) -> int:
    """Requirements against runs: lines, page, JSON, and JUnit with the suites of each run."""
    from sim.console import answer, fail, say
    from sim.junit import write_junit
    from sim.report.requirements.documents import suites
    from sim.report.requirements.matrix import (
        judged_runs,
        matrix,
        matrix_json,
        matrix_lines,
        write_matrix_page,
    )
    from sim.report.verdict import flight_failed

    judged = judged_runs([(one.path, one.summary) for one in rebuilt], page)
    rows = matrix(judged)
    for line in matrix_lines(rows, judged):
        say(line)
    for one in rebuilt:
        _say_figures(one, figures)
    write_matrix_page(page, rows, judged)
    say(f"page: {page}")
    named = list(zip((run.name for run in judged), rebuilt, strict=True))
    answer(
        {
            "page": page,
            "runs": [
                {"run": one.path, "report": one.report, "summary": one.summary, "binding": one.notes}
                for one in rebuilt
            ],
            "requirements": matrix_json(rows, judged),
        }
    )
    write_junit(
        junit,
        "torquer report",
        {f"{name}: {suite}": cases for name, one in named for suite, cases in suites(one.summary).items()},
    )
    for name, one in named:
        if failures := _failed_in_flight(one):
            fail(f"{name}: {flight_failed(failures)}")
    return int(any(_failed_in_flight(one) or one.mismatched for one in rebuilt))


def _failed_in_flight(rebuilt: "Run") -> dict[str, str]:
    from sim.report.verdict import Verdict

    return {name: why for name, why in rebuilt.failures.items() if name != Verdict.COMPLETE}


def _prepared_page(runs: Sequence[Path], out: Path | None) -> Path:
    """Where the page of several runs is written, checked with them before any is rebuilt.

    Raises:
        UsageError: a run is named twice.
        HarnessError: one is no run, or the page cannot be written.
    """
    from sim.record import run_dir
    from sim.report.requirements.matrix import PAGE
    from sim.result_files import check_results

    whole = [os.path.realpath(run) for run in runs]
    for place, run in enumerate(runs):
        if whole[place] in whole[:place]:
            raise click.UsageError(f"{run} is named twice")
        run_dir.read_run(run)
    page = out or Path(os.path.relpath(os.path.commonpath([os.path.dirname(run) for run in whole]))) / PAGE
    check_results({"--out": page}, {})
    return page
