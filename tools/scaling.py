"""Measure what a campaign costs beside its flights, and write docs/scaling.md: what 10^6 runs take.

Flights are measured with one and with two workers. Everything else is measured with workers that only sleep
for the time of a run and hand in the row of a real one, so that eight of them need no eight cores; and with
workers that do not even sleep, which shows how many rows a second can be taken in. Both through processes
and through a Dask scheduler with its workers, each a process of this machine. Needs the extra ``cluster``.
"""

import argparse
import os
import pickle
import platform
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from argument_types import count
from bench import environment
from jinja2 import Environment, StrictUndefined

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.executors.cluster import Cluster
from sim.campaign.executors.processes import Processes
from sim.campaign.one_run import Executor, Keep, RunTask
from sim.campaign.report.analysis import analyse
from sim.campaign.report.page import write_page
from sim.campaign.results.store import RESULTS, RunRow, open_results
from sim.errors import HarnessError
from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "scaling.md"
TEMPLATE = ROOT / "tools" / "scaling.md.j2"
CAMPAIGN = ROOT / "examples" / "campaigns" / "microsat.toml"
SLEEPERS = 8
RUNS = 1_000_000
CORES = (2, 100, 1000)
STARTS_S = 5.0
"""In it the workers of a cluster start."""


@dataclass(frozen=True, slots=True)
class SleepingTask(RunTask):
    """Sleeps for the time of a run instead of flying it, and hands in the same row under each number."""

    row: RunRow
    sleep_s: float

    def fly(self, run: int) -> RunRow:
        """Hand in the row."""
        time.sleep(self.sleep_s)
        return replace(self.row, run=run, seed=run)


class Taken(NamedTuple):
    """What it took to fly and store some runs: wall time, and processor time of the campaign's process."""

    runs: int
    wall_s: float
    own_s: float
    scheduler_s: float = 0.0

    @property
    def rate(self) -> float:
        """Rows a second."""
        return self.runs / self.wall_s


def store(executor: Executor, task: RunTask, runs: int, folder: Path) -> Taken:
    """Fly runs into the results of a folder, as ``torquer campaign`` does."""
    folder.mkdir()
    campaign = replace(task.campaign, runs=runs)
    with open_results(folder, campaign) as results:
        began_s, own_s = time.perf_counter(), time.process_time()
        for row in executor.rows(task, range(runs)):
            results.add(row)
        return Taken(runs, time.perf_counter() - began_s, time.process_time() - own_s)


@contextmanager
def cluster(workers: int) -> Iterator[tuple[Cluster, int]]:
    """A Dask scheduler and its workers, each a process; also the scheduler's process number."""
    with TemporaryDirectory() as folder, ExitStack() as processes:
        file = Path(folder, "scheduler.json")

        def start(module: str, *options: str) -> "subprocess.Popen[bytes]":
            command = [sys.executable, "-m", f"distributed.cli.{module}", *options]
            command += ["--scheduler-file", str(file), "--no-dashboard"]
            process = subprocess.Popen(command, cwd=folder, env=environment(), stderr=subprocess.DEVNULL)
            processes.callback(process.wait)
            processes.callback(process.terminate)
            return process

        scheduler = start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
        while not file.exists():
            if scheduler.poll() is not None:
                raise HarnessError(f"the Dask scheduler ended with exit code {scheduler.returncode}")
            time.sleep(0.1)
        for _ in range(workers):
            start("dask_worker", "--nthreads", "1", "--no-nanny")
        time.sleep(STARTS_S)
        yield Cluster(str(file)), scheduler.pid


def processor_s(pid: int) -> float:
    """Processor time of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Figures(NamedTuple):
    """All that is measured.

    ``alone`` and ``both``: flights with one worker and with two. ``sleeping`` and ``idle``: by executor,
    eight workers that sleep for the time of a run, and two that do not. ``row_bytes``: of a row on its way,
    ``stored_bytes``: in the results; ``page_s``, ``page_bytes``: to draw the page of ``page_runs`` runs.
    """

    run_s: float
    alone: Taken
    both: Taken
    sleeping: dict[str, Taken]
    idle: dict[str, Taken]
    row_bytes: int
    stored_bytes: float
    page_runs: int
    page_s: float
    page_bytes: float


def measure(flights: int, rows: int, rounds: int) -> Figures:
    """Everything, one after the other."""
    campaign = load_campaign(str(CAMPAIGN), {}, {})
    with TemporaryDirectory() as name:
        folder = Path(name)
        task = RunTask(campaign, Keep.NONE, folder)
        tell("flights with one worker")
        alone = store(Processes(1), task, flights, folder / "alone")
        tell("flights with two workers")
        both = store(Processes(2), task, 2 * flights, folder / "both")
        row = task.fly(0)
        asleep = SleepingTask(campaign, Keep.NONE, folder, row, row.wall_s)
        sleeping, idle = {}, {}
        for kind in ("processes", "Dask"):
            tell(f"{SLEEPERS} workers that sleep: {kind}")
            sleeping[kind] = on(kind, SLEEPERS, asleep, rounds * SLEEPERS, folder / f"asleep {kind}")
            tell(f"two workers that do nothing: {kind}")
            idle[kind] = on(kind, 2, replace(asleep, sleep_s=0.0), rows, folder / f"idle {kind}")
        tell("the page")
        stored = (folder / "idle processes" / RESULTS).stat().st_size / rows
        page_s, page_bytes = draw_page(folder / "idle processes", replace(campaign, runs=rows))
    return Figures(
        row.wall_s, alone, both, sleeping, idle, len(pickle.dumps(row)), stored, rows, page_s, page_bytes
    )


def on(kind: str, workers: int, task: RunTask, runs: int, folder: Path) -> Taken:
    """Store the rows of so many workers of a kind."""
    if kind == "processes":
        return store(Processes(workers), task, runs, folder)
    with cluster(workers) as (executor, scheduler):
        before_s = processor_s(scheduler)
        taken = store(executor, task, runs, folder)
        return taken._replace(scheduler_s=processor_s(scheduler) - before_s)


def draw_page(folder: Path, campaign: Campaign) -> tuple[float, float]:
    """Time for the page, and the memory that this process has grown by."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began_s = time.perf_counter()
    with open_results(folder, campaign) as results:
        write_page(folder / "campaign.html", campaign, analyse(campaign, results), version("torquer"))
    grown_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    return time.perf_counter() - began_s, 1e3 * grown_kb


def tell(what: str) -> None:
    """Say what is being measured."""
    print(what, file=sys.stderr, flush=True)


def page(figures: Figures) -> str:
    """The page: the template ``scaling.md.j2`` with the figures."""
    template = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    text = TEMPLATE.read_text(encoding="utf-8")
    return template.from_string(text).render(
        f=figures,
        page_a_run=figures.page_bytes / figures.page_runs,
        machine=f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}",
        version=version("torquer"),
        sleepers=SLEEPERS,
        runs=RUNS,
        cores=CORES,
    )


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--flights", type=count, default=4, help="of each worker")
    parser.add_argument("--rows", type=count, default=3000, help="taken in from workers that do nothing")
    parser.add_argument("--rounds", type=count, default=10, help="of the workers that sleep")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    figures = measure(options.flights, options.rows, options.rounds)
    replace_text(options.out, page(figures))
    print(options.out)


if __name__ == "__main__":
    main()
