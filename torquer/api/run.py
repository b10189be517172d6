"""A run: what a flight has left in its directory, for programs."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.run_record import RunRecord
from sim.replay.command import ReplayReport
from sim.report.summary import summary_text
from sim.report.verdict import Verdict
from sim.scenario.law_named import with_law_named
from torquer.api.arguments import path_text
from torquer.api.audit import Audit, check
from torquer.api.errors import one_sentence
from torquer.api.export import Export, export
from torquer.api.laws import LawLike, checked_law, law_given
from torquer.api.printed import PrintedResult
from torquer.api.replay import replay
from torquer.api.scenarios import TypedScenario

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from torquer.api.plots import RunPlots

OF_EVERY_FLIGHT = {"scenario", "seed", "sim_seconds", "limits_ok"}
"""Keys of every summary; in a document without them nothing has failed because nothing is said."""


@dataclass(frozen=True)
class Run(PrintedResult):
    """The directory of a flight, which functions take as they take its path.

    What takes time is computed when it is first asked for, and kept.

    Attributes:
        path: the directory.
        law: the user law that it flew, or its name, which may be executed again; None: none.
        ended: why the flight ended before its time, as far as ``fly`` knows; empty otherwise.
        mismatched: whether ``torquer.report`` found a file that had been changed since it was written.
        notes: what it found, a line each; of ``torquer.fly``, who can replay the run if not everybody.
        figures: files that ``torquer.report`` has drawn for papers.
    """

    path: Path
    law: LawLike | None = None
    ended: str = ""
    mismatched: bool = False
    notes: tuple[str, ...] = ()
    figures: tuple[Path, ...] = ()

    @cached_property
    @one_sentence
    def record(self) -> RunRecord:
        """``run.json``: seed, bus, platform, digests."""
        return run_dir.read_run(self.path)

    @cached_property
    @one_sentence
    def scenario(self) -> TypedScenario:
        """The scenario that was flown, with all settings."""
        return TypedScenario.of(run_dir.read_scenario(self.path))

    @property
    def concluded(self) -> bool:
        """Whether there is a summary; of a flight that was interrupted ``torquer.report`` makes it."""
        return (self.path / run_dir.SUMMARY).is_file()

    @cached_property
    @one_sentence
    def summary(self) -> Mapping[str, Any]:
        """``summary.json``: pulses, duty, pointing, estimate, events, judged by the truth of the plant."""
        path = self.path / run_dir.SUMMARY
        if not self.concluded:
            why = self.failures[Verdict.COMPLETE.value]
            raise HarnessError(f"there is no {path.name} ({why}): torquer report {self.path} makes it")
        try:
            summary = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError) as error:
            raise HarnessError(f"{path}: cannot be read ({error})") from None
        if not isinstance(summary, dict) or not summary.keys() >= OF_EVERY_FLIGHT:
            raise HarnessError(f"{path}: no summary of a flight")
        return summary

    @property
    def failures(self) -> Mapping[str, str]:
        """What failed, a clause each by ``Verdict``: ``limits``, ``replay``, ``requirements`` and so on."""
        if self.concluded:
            failed: Mapping[str, str] = self.summary.get("failures", {})
            return failed
        why = self.record.get("ended", "the flight was interrupted")
        unfinished = f"{why}: the run is not complete, its files are in {self.path}"
        return {Verdict.COMPLETE.value: self.ended or unfinished}

    @property
    def ok(self) -> bool:
        """Nothing failed. Limits were kept, the replay is exact, the run complete, no requirement missed."""
        return not self.failures

    @property
    def report(self) -> Path:
        """The page ``report.html``."""
        return self.path / run_dir.REPORT

    @property
    def log(self) -> Path:
        """The log of the bus, in candump format."""
        return run_dir.bus_log(self.path)

    def replay(self, *, plant: bool = False, progress: bool = False) -> ReplayReport:
        """Replay the run through the flight software, or through the plant, as ``torquer.replay`` does."""
        return replay(self.path, plant=plant, law=self.law, progress=progress)

    def check(self) -> Audit:
        """Audit the limits of the coils in the log, as ``torquer.check`` does."""
        return check(self.path)

    def export(
        self,
        out: str | PathLike[str],
        *,
        format: str | None = None,
        force: bool = False,
        progress: bool = False,
    ) -> Export:
        """Write the run for another tool, as ``torquer.export`` does."""
        return export(self.path, out, format=format, force=force, law=self.law, progress=progress)

    @cached_property
    @one_sentence
    def truth(self) -> "xr.Dataset":
        """The histories of the plant, a row a tick, of attitude, rates, field, Sun, dipole, orbit, torques.

        Every variable has its unit in ``attrs["units"]``, its meaning in ``attrs["long_name"]``, and in its
        name the quantity, its frame and its unit. Needs ``torquer[data]``.
        """
        from torquer.api.datasets import truth  # noqa: PLC0415  an extra

        return truth(self.path, self.scenario, self.record)

    @cached_property
    @one_sentence
    def estimate(self) -> "xr.Dataset":
        """What the flight software estimated at every tick, from a replay of the log; NaN where it had none.

        Attitude, rates, their 1 sigma, the error against the plant's truth, validity and mode, with units as
        in ``truth``. A replay takes about as long as the flight. Needs ``torquer[data]``.
        """
        from torquer.api.datasets import estimate  # noqa: PLC0415  an extra

        with law_given(self.law) as named:
            return estimate(self.path, with_law_named(self.scenario, named)[0], self.record)

    @cached_property
    def plot(self) -> "RunPlots":
        """The figures for papers, ``run.plot.pointing()`` and so on, each of which gives its axes."""
        from torquer.api.plots import RunPlots  # noqa: PLC0415  matplotlib loads when something is drawn

        return RunPlots(self.path, self.scenario, self.law)

    @cached_property
    @one_sentence
    def pulses(self) -> "pd.DataFrame":
        """The pulses that the coil driver reports, by start. Needs ``torquer[data]``."""
        from torquer.api.datasets import pulses  # noqa: PLC0415  an extra

        return pulses(self.check().report, self.scenario)

    def __fspath__(self) -> str:
        return fspath(self.path)

    def __str__(self) -> str:
        return summary_text(dict(self.summary)) if self.concluded else self.failures[Verdict.COMPLETE.value]

    def __repr__(self) -> str:
        return f"<Run {self.path}>"


@one_sentence
def load(path: str | PathLike[str], *, law: LawLike | None = None) -> Run:
    """The run in a directory, flown here or elsewhere, complete or not.

    Args:
        path: the directory.
        law: the user law that the run flew, named or given again; without it none is executed.

    Raises:
        InputError: the directory holds no run.
    """
    folder = Path(path_text(path, "path"))
    run_dir.read_run(folder)
    return Run(folder, checked_law(law))
