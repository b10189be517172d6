"""What is exported: a run, or a candump log alone."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from fsw.wire.messages import PlantEnd, intact
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.binding import Binding, compare
from sim.record.candump import LogEntry, LogTruncatedError, last_lines, read_log
from sim.record.run_record import RunRecord
from sim.scenario.law_named import with_law_named
from sim.scenario.schema import Scenario

LATEST_US = 7_258_118_400_000_000
"""The year 2200: nanoseconds since 1970 fit into 64 bits until 2262."""


class Source(NamedTuple):
    """A log, and where it is that of a run, the run's record, scenario and histories."""

    log: Path
    record: RunRecord | None
    scenario: Scenario | None
    truth: Path | None
    binding: Binding

    @property
    def identity(self) -> dict[str, int | str]:
        """What identifies the flight; empty for a log alone."""
        if self.record is None or self.scenario is None:
            return {}
        flown = {"torquer_version": self.record["torquer_version"]}
        return run_dir.identity(self.scenario, self.record["seed"]) | flown


def open_source(run_or_log: Path, law: str | None = None) -> Source:
    """Find what belongs to a run directory or to a log.

    Args:
        run_or_log: a run directory, or a log.
        law: the user law that the run flew, named again; without it none is executed.

    Raises:
        HarnessError: neither exists, or the run's own files cannot be read.
    """
    log, folder = run_dir.locate(run_or_log)
    binding = compare(folder, log, None)
    if run_or_log == log:
        return Source(log, None, None, None, binding)
    with binding.beside_errors():
        record, scenario = run_dir.read_run(folder), run_dir.read_scenario(folder)
        if law is not None:
            scenario, _ = with_law_named(scenario, law)
    truth = folder / run_dir.TRUTH
    return Source(log, record, scenario, truth if truth.exists() else None, binding)


class LogPass:
    """One pass over the entries of a log; ``notes`` then say in what it is not that of a whole flight.

    Args:
        log: a candump log.

    Raises:
        HarnessError: while it is read: the file is no candump log, or its time is beyond all formats.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        self.notes: list[str] = []

    def __iter__(self) -> Iterator[LogEntry]:
        last: LogEntry | None = None
        try:
            for entry in read_log(self._log):
                if entry.timestamp_us > LATEST_US:
                    raise HarnessError(f"{self._log}: line {entry.line} is stamped later than the year 2200")
                yield entry
                last = entry
        except LogTruncatedError as cut:
            self.notes.append(f"the log was cut short inside its line {cut.line}, which is left out")
            return
        if last is None or last.frame.can_id != PlantEnd.ID or not intact(last.frame):
            self.notes.append("the log has no end mark: the flight was cut short")

    def duration_us(self) -> int:
        """Time from the first to the last whole line."""
        first_us = next(iter(read_log(self._log))).timestamp_us
        stamps = [line[1:].partition(b")")[0] for line in last_lines(self._log)[-1:]]
        try:
            return max(0, *(round(1e6 * float(stamp)) - first_us for stamp in stamps), 0)
        except (ValueError, OverflowError):  # the last line is none of a log: that is found when it is read
            return 0


def histories(source: Source) -> tuple[Path, Scenario]:
    """The plant's histories and the scenario.

    Raises:
        HarnessError: there are none.
    """
    if source.truth is None or source.scenario is None:
        raise HarnessError(
            f"{source.log}: without {run_dir.TRUTH} there are no histories: export mcap, blf or asc"
        )
    return source.truth, source.scenario
