"""One run of a campaign: draw, fly in memory, score. What it gives depends on campaign and number alone."""

import gc
import os
import socket
import time
import traceback
from collections.abc import Iterator, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Protocol

import numpy as np

from fsw.input.schema import TableError
from sim.campaign.definition.campaign import Campaign, DrawnRun, StatisticsSection
from sim.campaign.definition.columns import Cell, cells, input_cells, requirement_cells
from sim.campaign.flight import RecordedFlight, record_scenario
from sim.campaign.results.store import RunRow, Status
from sim.campaign.runner import LOST
from sim.errors import HarnessError
from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.plant.errors import PlantError
from sim.record import run_dir
from sim.record.destination import check_folder
from sim.record.pace import LOCKSTEP
from sim.report.figures.attitude_arrays import axis1_errors, errors, law_attitude
from sim.report.figures.estimate_error import knowledge_errors
from sim.scenario.schema import flight_table, orbit_period_s
from sim.statistics.indices import index_histories, profile
from sim.value_types import Array

# --- What a campaign keeps of the histories of a run: its pointing indices, and its error over time


POINTS_AN_ORBIT = 60
MOST_POINTS = 600


@dataclass(frozen=True, slots=True)
class RunScore:
    """Figures by column; profiles of the indices and the RMS error by stretch of the run, in degrees."""

    figures: dict[str, float]
    profiles: dict[str, Array]
    error_deg: Array


def score(record: RecordedFlight, statistics: StatisticsSection) -> RunScore:
    """The score of a flight; a scenario that points axis 1 alone is judged by that."""
    scenario = record.scenario
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    q = law_attitude(record.truth["q_body_from_orbit"], scenario.body.law_axes)
    error = axis1_errors(q) if flight_table(scenario).modes.axis_only else errors(q)
    knowledge = knowledge_errors(record.truth, record.estimates)
    counted = slice(-max(1, round(statistics.last_orbits * ticks_per_orbit)), None)
    window = max(1, round(statistics.window_s * scenario.time.tick_hz))
    histories = index_histories(np.degrees(error[counted]), np.degrees(knowledge[counted]), window)
    figures = {}
    for name, values in histories.items():
        figures[f"{name}_deg_rms"] = float(np.sqrt(np.mean(values**2)))
        figures[f"{name}_deg_max"] = float(values.max())
    profiles = {name: profile(values) for name, values in histories.items()}
    points = min(len(error), MOST_POINTS, max(2, round(POINTS_AN_ORBIT * len(error) / ticks_per_orbit)))
    return RunScore(figures, profiles, _stretches(np.degrees(np.linalg.norm(error, axis=1)), points))


def _stretches(values: Array, count: int) -> Array:
    """The root mean square of each of ``count`` stretches."""
    starts = np.linspace(0, len(values), count, endpoint=False).astype(int)
    lengths = np.diff(np.append(starts, len(values)))
    result: Array = np.sqrt(np.add.reduceat(values**2, starts) / lengths)
    return result


# --- The run

ERROR_HISTORY = "error_deg"
"""Name of the pointing error over the time of a run among its profiles."""
LIMITS = "limits of the coils"
COLLECT_EVERY_S = 1.0
_uncollected_s = 0.0


class Keep(StrEnum):
    """Of which runs log and histories are kept."""

    NONE = "none"
    FAILURES = "failures"
    """Those that were not flown to their end, and those that miss a requirement."""
    ALL = "all"


@dataclass(frozen=True, slots=True)
class RunTask:
    """What a worker needs to fly any run of a campaign.

    Attributes:
        campaign: the campaign.
        keep: of which runs log and histories are kept.
        folder: where they are kept.
    """

    campaign: Campaign
    keep: Keep
    folder: Path

    def fly_all(self, runs: Sequence[int]) -> list[RunRow]:
        """Several runs, one after the other."""
        return [self.fly(run) for run in runs]

    def fly(self, run: int) -> RunRow:
        """Fly a run and score it. An error is the result of its run, and ends no other.

        Raises:
            HarnessError: log and histories cannot be kept.
            MemoryError: there is not enough memory, which is no result of the run.
        """
        began, drawn = time.monotonic(), self.campaign.draw(run)
        try:
            row = _flown(self.campaign, drawn)
        except (TableError, HarnessError, PlantError) as error:
            row = _failed(drawn, str(error))
        except MemoryError:  # of this machine, and no result of the run
            raise
        except Exception as error:  # a defect: the sentence says where, and the other runs are flown
            row = _failed(drawn, f"{type(error).__name__}: {error} ({_place(error)})")
        if self.keep is Keep.ALL or (self.keep is Keep.FAILURES and not row.success):
            # What has failed fails here too, at the same tick; its log up to there is what is wanted.
            fails_again = suppress(Exception) if row.status is Status.FAILED else nullcontext()
            with fails_again:
                keep_run(run_folder(self.folder, run), self.campaign, drawn)
        _collect_garbage(time.monotonic() - began)
        worker = f"{socket.gethostname()}:{os.getpid()}"
        return replace(row, wall_s=time.monotonic() - began, worker=worker)


def _collect_garbage(flown_s: float) -> None:
    """Collect the garbage of flights once they add up to a second: it takes longer than a short flight."""
    global _uncollected_s  # noqa: PLW0603  (of this process)
    gc.unfreeze()  # the flight has frozen what was loaded, including garbage of earlier flights
    _uncollected_s += flown_s
    if _uncollected_s >= COLLECT_EVERY_S:
        _uncollected_s = 0.0
        gc.collect()


def lost_run(campaign: Campaign, run: int, losses: int) -> RunRow:
    """The row of a run that no worker survives."""
    return _failed(campaign.draw(run), f"its worker process was lost {losses} times ({LOST})")


def run_folder(folder: Path, run: int) -> Path:
    """Where log and histories of a run are kept."""
    return folder / "runs" / f"{run}"


def keep_run(path: Path, campaign: Campaign, drawn: DrawnRun) -> None:
    """Fly a run once more, with log and histories in a run directory; an earlier attempt is replaced.

    Raises:
        TableError: as for the flight in memory.
        HarnessError: as for the flight in memory, or the directory cannot be written.
    """
    scenario = campaign.scenario(drawn)
    for folder in (path.parent, path):
        if folder.is_symlink():
            raise HarnessError(f"{folder} is a symbolic link, through which nothing is written")
    check_folder(path)
    for name in run_dir.FILES:
        (path / name).unlink(missing_ok=True)
    run_dir.begin(path, scenario, drawn.seed, ticks_of(scenario, None), "virtual", LOCKSTEP)
    fly_virtual(path, scenario, lambda tick: None)


def _flown(campaign: Campaign, drawn: DrawnRun) -> RunRow:
    record = record_scenario(campaign.scenario(drawn), drawn.seed)
    scored = score(record, campaign.statistics)
    summary = record.summary()
    found: dict[str, Cell] = {
        **input_cells(drawn.inputs),
        **cells(summary),
        **requirement_cells(summary, len(campaign.base["requirement"])),
        **scored.figures,
        "frames_sha256": record.digest.frames,
        "commands_sha256": record.digest.commands,
    }
    missed = [str(entry) for entry in campaign.requirements if not entry.met_by(found.get(entry.figure))]
    if not found["limits_ok"]:
        missed.append(LIMITS)
    profiles = {**scored.profiles, ERROR_HISTORY: scored.error_deg}
    return RunRow(
        run=drawn.run,
        status=Status.DONE,
        failure="",
        seed=drawn.seed,
        success=not missed,
        missed="; ".join(missed),
        cells=found,
        profiles={name: np.asarray(values, "<f4").tobytes() for name, values in profiles.items()},
    )


def _failed(drawn: DrawnRun, sentence: str) -> RunRow:
    inputs = input_cells(drawn.inputs)
    return RunRow(drawn.run, Status.FAILED, sentence, drawn.seed, success=False, missed="", cells=inputs)


def _place(error: Exception) -> str:
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{Path(frame.filename).name}:{frame.lineno}"


# --- What flies the runs of a campaign


class Executor(Protocol):
    """Flies runs somewhere. A run may be flown again when its worker is lost; its row comes once."""

    def rows(self, task: RunTask, runs: Sequence[int]) -> Iterator[RunRow]:
        """The rows of the runs, each as it is done, in any order.

        Raises:
            HarnessError: the executor itself is lost; runs without a row can be flown by another.
        """
