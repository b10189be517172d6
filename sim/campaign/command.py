"""``torquer campaign``: fly the runs that have no result yet, then show all results."""

import os
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from shlex import quote
from typing import Literal

from pydantic import Field

from fsw.input.schema import Nested, Section, TableError
from fsw.table.config import flight_config
from sim.campaign.code_digest import code_digest
from sim.campaign.definition.campaign import FILE, SCENARIO, Campaign
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.definition.columns import Cell
from sim.campaign.executors.cluster import Cluster
from sim.campaign.executors.processes import Processes
from sim.campaign.flight import digest_of
from sim.campaign.one_run import Executor, Keep, RunTask
from sim.campaign.report.analysis import CampaignAnalysis, analyse
from sim.campaign.report.verdicts import CampaignVerdict, verdicts
from sim.campaign.results.store import (
    CODE,
    DIGESTS,
    LOCK,
    RESULTS,
    Results,
    RunRow,
    Status,
    check_parquet,
    export,
    open_results,
    read_results,
)
from sim.console import detail, warn
from sim.errors import HarnessError
from sim.progress import note, progress
from sim.record import run_dir
from sim.record.destination import check_folder, new_folder
from sim.scenario.schema import Scenario, flight_table, scenario_of
from sim.signals import EndedBySignal
from sim.sizing.scenario_warnings import scenario_warnings

PAGE, PARQUET = "campaign.html", "results.parquet"
LINE_EVERY_S = 60.0
"""Time between two lines of progress where there is no bar."""


@dataclass(frozen=True, slots=True)
class FlownCampaign:
    """A campaign whose runs have been flown.

    Attributes:
        folder: it holds results and page.
        campaign: as it was flown.
        analysis: the statistics of its runs.
        failed: runs that have no result.
        broken: runs that broke the limits of the coils.
    """

    folder: Path
    campaign: Campaign
    analysis: CampaignAnalysis
    failed: tuple[int, ...]
    broken: tuple[int, ...]

    @property
    def ok(self) -> bool:
        """Every run was flown and kept the limits of the coils; no requirement of the campaign is missed."""
        return not self.complaints

    @property
    def verdicts(self) -> list[CampaignVerdict]:
        """Of the requirements and the limits on indices."""
        return verdicts(self.campaign, self.analysis)

    @property
    def complaints(self) -> list[str]:
        """What is not ok, a sentence each."""
        sentences = []
        if self.failed:
            why = next(iter(self.analysis.failures.values()))
            sentences.append(f"{_listed(self.failed)} failed (the first: {why}); --retry flies again")
        if self.broken:
            sentences.append(f"{_listed(self.broken)} broke the limits of the coils")
        sentences += [str(one) for one in self.verdicts if one.met is False]
        return sentences


class CampaignOptions(Section):
    """How the runs of a campaign are flown, and what is kept of them.

    Attributes:
        workers: processes; None: as many as there are cores.
        scheduler: of a Dask cluster, by address or file; None: processes.
        keep: of which runs log and histories are kept.
        retry: whether failed runs are flown again.
        parquet: whether the results are exported.
    """

    workers: int | None = Field(default=None, ge=1)
    scheduler: str | None = None
    keep: Literal["failures", "all", "none"] = "none"
    retry: bool = False
    parquet: bool = False


def campaign(
    source: str, over: Nested, settings: Nested, options: CampaignOptions, out: Path | None
) -> FlownCampaign:
    """Fly a campaign, or what is left of it.

    Args:
        source: a campaign file, a scenario, or the folder of a campaign that is to be continued.
        over: runs, orbits and seed that were given.
        settings: laid over the scenario of all runs.
        options: how the runs are flown, and what is kept of them.
        out: folder; None: that of ``source``, or ``campaigns/<name>-<UTC time>``.

    Raises:
        TableError: the campaign file or the scenario is not valid.
        HarnessError: the folder or the cluster cannot be used.
    """
    if Path(source).is_dir():
        _check_resumable(source, over, settings, out)
        out = Path(source)
    if options.parquet:
        check_parquet()
    chosen = load_campaign(source, over, settings)
    nominal = scenario_of(chosen.base, source)
    if nominal.own_law is not None:
        flight_config(flight_table(nominal), source)  # a fault of it would be that of every run
    doubts = scenario_warnings(nominal)
    for doubt in (*doubts, *warnings_of_runs(chosen, doubts)):
        warn(doubt)
    folder = out or new_folder(Path("campaigns"), chosen.name)
    check_folder(folder, (FILE, SCENARIO, RESULTS, LOCK, PAGE, *([PARQUET] if options.parquet else [])))
    workers = options.workers or os.cpu_count() or 1
    executor: Executor = Cluster(options.scheduler) if options.scheduler else Processes(workers)
    with open_results(folder, chosen) as results:
        chosen = replace(chosen, runs=max([chosen.runs, *(run + 1 for run in results.runs())]))
        chosen.write(folder)
        there = set(results.runs(Status.DONE) if options.retry else results.runs())
        missing = [run for run in range(chosen.runs) if run not in there]
        if missing:
            _check_code(folder, results)
        detail(f"{len(missing)} of {chosen.runs} runs are not in {folder}")
        task = RunTask(chosen, Keep(options.keep), folder.absolute())
        try:
            _fly(executor, task, missing, results)
        except (KeyboardInterrupt, EndedBySignal):
            _say_how_to_resume(folder, chosen, results)
            raise
        return _conclude(folder, chosen, results, options.parquet)


SAMPLED = 20
"""Runs that are looked at before the first one flies."""


def warnings_of_runs(chosen: Campaign, of_nominal: Sequence[str]) -> list[str]:
    """What is most likely wrong in the first runs as they are drawn, and not in the scenario itself.

    One of those that differ in their numbers alone, and in how many of these runs there is one.
    """
    known = {_without_numbers(doubt) for doubt in of_nominal}
    found: dict[str, list[tuple[int, str]]] = {}
    looked_at = range(min(SAMPLED, chosen.runs) if chosen.disperse else 0)
    for run in looked_at:
        with suppress(TableError):  # values that are not allowed: its row will say so
            for doubt in scenario_warnings(chosen.scenario(chosen.draw(run))):
                if (words := _without_numbers(doubt)) not in known:
                    found.setdefault(words, []).append((run, doubt))
    return [
        f"in {len(doubts)} of the first {len(looked_at)} runs, as in run {doubts[0][0]}: {doubts[0][1]}"
        for doubts in found.values()
    ]


def _without_numbers(sentence: str) -> str:
    return re.sub(r"-?\d[\d.]*(e[+-]?\d+)?", "", sentence)


def _check_resumable(source: str, over: Nested, settings: Nested, out: Path | None) -> None:
    if not (Path(source) / FILE).is_file():
        raise HarnessError(f"{source} is a folder without a campaign: it has no {FILE}")
    if settings or out or over.keys() - {"runs"}:
        raise HarnessError(
            f"{source} is a campaign that has begun: of its options only the number of runs can change"
        )


def _check_code(folder: Path, results: Results) -> None:
    """The runs to be flown must be of the code that the others are of."""
    theirs, ours = results.meta("torquer_version"), version("torquer")
    if theirs != ours:
        raise HarnessError(f"{folder} was begun by torquer {theirs}, this is {ours}: choose another --out")
    begun = results.all_meta().get(CODE)
    if begun is None:
        warn(
            f"{folder} does not say by which code of torquer {ours} it was begun, which may differ from this"
        )
    elif begun != code_digest():
        raise HarnessError(
            f"{folder} was begun by other code of torquer {ours} or of its libraries, of digest {begun}, "
            f"this is {code_digest()}: choose another --out"
        )


def _fly(executor: Executor, task: RunTask, missing: list[int], results: Results) -> None:
    if not missing:
        return
    with _watch(task.campaign.name, len(missing)) as take:
        for row in executor.rows(task, missing):
            results.add(row)
            take(row)


@contextmanager
def _watch(name: str, total: int) -> Iterator[Callable[[RunRow], None]]:
    """A bar on a terminal; elsewhere a line every ``LINE_EVERY_S``, with the time left."""
    began = said = time.monotonic()
    done = failed = 0
    with progress(f"flying {name}", total, in_log=False) as bar:

        def take(row: RunRow) -> None:
            nonlocal done, failed, said
            done, failed = done + 1, failed + (row.status is Status.FAILED)
            bar(done)
            now = time.monotonic()
            if not sys.stderr.isatty() and (now - said >= LINE_EVERY_S or done == total):
                said, rate = now, 60.0 * done / (now - began)
                line = f"{done} of {total} runs, {failed} failed"
                if done > 1:  # the others that flew beside the first are not counted yet
                    line += f", {rate:.1f} a minute, {(total - done) / rate:.1f} min left"
                note(line)

        yield take


def _say_how_to_resume(folder: Path, chosen: Campaign, results: Results) -> None:
    there = len(results.runs())
    note(
        f"{there} of {chosen.runs} runs are in {folder}; torquer campaign {quote(str(folder))} flies the rest"
    )


def _conclude(folder: Path, chosen: Campaign, results: Results, parquet: bool) -> FlownCampaign:
    """Page and export."""
    if parquet:
        export(results, folder / PARQUET)
    analysis = analyse(chosen, results)
    _draw(folder / PAGE, chosen, analysis, results.meta("torquer_version"))
    broken = [int(str(run)) for run, kept in results.each(("run", "limits_ok"), Status.DONE) if not kept]
    failed = results.runs(Status.FAILED)
    return FlownCampaign(folder, chosen, analysis, tuple(failed), tuple(broken))


def _draw(path: Path, chosen: Campaign, analysis: CampaignAnalysis, begun_by: str) -> None:
    """Write the page; one that cannot be made takes no verdict with it, and leaves no earlier page."""
    from sim.campaign.report.page import write_page  # noqa: PLC0415  matplotlib loads when something is drawn

    try:
        write_page(path, chosen, analysis, begun_by)
    except Exception as error:  # a defect of the page: the verdicts do not depend on it
        path.unlink(missing_ok=True)
        warn(f"{path} was not made: {type(error).__name__}: {error}; the verdicts are those of all runs")


def _listed(runs: tuple[int, ...]) -> str:
    names = ", ".join(map(str, runs[:5])) + (f" and {len(runs) - 5} more" if len(runs) > 5 else "")
    return f"run {names}" if len(runs) == 1 else f"runs {names}"


# --- A run of a campaign flown once more by itself, and whether it is the same to the last bit


@dataclass(frozen=True, slots=True)
class CampaignRun:
    """A run as its campaign drew it, and the row that the campaign has of it; None if it has none."""

    folder: Path
    run: int
    scenario: Scenario
    seed: int
    row: dict[str, Cell] | None


def campaign_run(folder: Path, run: int) -> CampaignRun:
    """A run of the campaign in a folder.

    Raises:
        HarnessError: there is no campaign, or it has no such run.
        TableError: the values that were drawn for the run are not allowed.
    """
    if not (folder / FILE).is_file():
        raise HarnessError(f"--from {folder}: it has no {FILE}")
    campaign = load_campaign(str(folder), {}, {})
    if not 0 <= run < campaign.runs:
        raise HarnessError(f"--run {run}: the campaign in {folder} has the runs 0 to {campaign.runs - 1}")
    drawn = campaign.draw(run)
    with read_results(folder) as results:
        row = results.row(run)
    return CampaignRun(folder, run, campaign.scenario(drawn), drawn.seed, row)


def compare_with_row(flown: CampaignRun, path: Path) -> tuple[bool, str]:
    """Whether the run directory ``path`` has the frames that the campaign saw, and a sentence that says so.

    Frames are compared by their digests; where only the commands are equal, the platforms may differ.
    """
    name = f"run {flown.run} of {flown.folder}"
    if flown.row is None or flown.row["status"] != Status.DONE:
        return True, f"{name} has no result to compare with"
    digest = digest_of(run_dir.bus_log(path))
    frames, commands = (flown.row[column] for column in DIGESTS)
    if digest.frames == frames:
        return True, f"equal to {name} bit for bit: SHA-256 of all frames {digest.frames[:16]}"
    if digest.commands == commands:
        return (
            False,
            f"equal to {name} in every command, but not bit for bit: is it another platform or version?",
        )
    return (
        False,
        f"NOT equal to {name}: SHA-256 of the commands {digest.commands[:16]}, there {str(commands)[:16]}",
    )
