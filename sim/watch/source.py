"""Where frames come from: a bus, on which nothing is ever sent, or a log, at any pace."""

from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep
from typing import NamedTuple, Protocol

from fsw.bus.interface import Bus, BusClosed, BusError
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import open_bus, resolve
from fsw.wire.frame import Frame
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.candump import LogTruncatedError, read_log
from sim.record.pace import Pace
from sim.scenario.schema import Scenario
from sim.watch.flight_view import MOST_HAPPENINGS, FlightView

BATCH_S = 0.1
"""Frames are handed on in batches of this time at most [s]."""
MOST_GAP_S = 3600.0
"""A longer gap between two lines of a log is passed over."""


class Batch(NamedTuple):
    """Frames, each with the time at which it came, and the time now, by the clock of the source [s]."""

    frames: list[tuple[Frame, float]]
    now_s: float


class FrameSource(Protocol):
    """Frames as they come. The clock of a bus is that of this machine, that of a log its timestamps."""

    name: str

    @property
    def waits_for(self) -> str:
        """What must come before there is a first frame, in a sentence."""

    def batches(self) -> Iterator[Batch]:
        """The frames since the last batch, none if none came, until there are no more."""


class BusSource:
    """The frames of a bus. A loop bus that nobody hosts is waited for, not hosted: it would end with us.

    Args:
        spec: as of ``open_bus``.

    Raises:
        BusError: there is no such bus.
    """

    def __init__(self, spec: str) -> None:
        self.name = resolve(spec)
        self._bus: Bus | None = None
        if not self.name.startswith("loop:"):
            self._bus = open_bus(self.name)

    @property
    def waits_for(self) -> str:
        """Somebody who hosts the bus, or who sends."""
        if self._bus is None:
            return f"waits for somebody who hosts {self.name}, as torquer sil --bus loop does"
        return f"waits for the first frame on {self.name}: plant, flight software and boards are silent"

    def batches(self) -> Iterator[Batch]:
        """Until the bus is closed."""
        try:
            while True:
                if self._bus is None:
                    self._bus = _joined(self.name)
                frames = [] if self._bus is None else _received(self._bus)
                yield Batch(frames, monotonic())
        except BusClosed:
            return
        finally:
            if self._bus is not None:
                self._bus.close()


def _joined(name: str) -> Bus | None:
    """The loop bus, if somebody hosts it by now."""
    try:
        return LoopLink(int(name.removeprefix("loop:")), timeout_s=BATCH_S, may_host=False)
    except BusError as error:
        if "no hub answers" in str(error):
            return None
        raise


def _received(bus: Bus) -> list[tuple[Frame, float]]:
    frames: list[tuple[Frame, float]] = []
    deadline = monotonic() + BATCH_S
    while (left_s := deadline - monotonic()) > 0.0 and (frame := bus.receive(left_s)) is not None:
        frames.append((frame, monotonic()))
    return frames


class LogSource:
    """The frames of a log, by their timestamps.

    Args:
        path: a run directory or a log.
        pace: how many times faster than it was flown; without a factor as fast as it can be read.

    Raises:
        HarnessError: there is no such log.
    """

    def __init__(self, path: Path, pace: Pace) -> None:
        folder = path.is_dir()
        self.path = run_dir.bus_log(path) if folder else path
        if not self.path.is_file():
            raise HarnessError(f"{path}: no {run_dir.BUS_LOG} in it" if folder else f"{path}: no such file")
        self.name = str(path)
        self._factor = pace.factor
        self.cut_short = False

    @property
    def waits_for(self) -> str:
        """Its first line."""
        return f"waits for the first frame of {self.name}"

    def scenario(self) -> Scenario | None:
        """That of the run, if the log is in one."""
        beside = self.path.parent / run_dir.SCENARIO
        return run_dir.read_scenario(self.path.parent) if beside.is_file() else None

    def batches(self) -> Iterator[Batch]:
        """Until the end of the log.

        Raises:
            LogError: a line is no line of a log.
        """
        frames: list[tuple[Frame, float]] = []
        due_s = handed_s = monotonic()
        before_s = None
        try:
            for entry in read_log(self.path):
                time_s = entry.timestamp_us * 1e-6
                if self._factor is not None and before_s is not None and time_s > before_s:
                    due_s += min(time_s - before_s, MOST_GAP_S) / self._factor
                while (wait_s := due_s - monotonic()) > 0.0 and self._factor is not None:
                    yield Batch(frames, before_s or time_s)
                    frames, handed_s = [], monotonic()
                    sleep(min(wait_s, BATCH_S))
                if monotonic() - handed_s > BATCH_S:
                    yield Batch(frames, before_s or time_s)
                    frames, handed_s = [], monotonic()
                frames.append((entry.frame, time_s))
                before_s = time_s
        except LogTruncatedError:
            self.cut_short = True
        yield Batch(frames, before_s or 0.0)


def batches(source: FrameSource, view: FlightView) -> Iterator[None]:
    """Hand on the frames of a source as they come.

    Stops after each batch, and within it before anything that happened since the last stop is forgotten.
    """
    for batch in source.batches():
        yield from _parts(view, batch)
        yield


def take_batch(view: FlightView, batch: Batch) -> None:
    """Take the frames of a batch."""
    for _ in _parts(view, batch):
        pass


def _parts(view: FlightView, batch: Batch) -> Iterator[None]:
    """Take the frames of a batch; stops whenever as much has happened as is kept."""
    reported = view.happened
    for frame, time_s in batch.frames:
        view.take(frame, time_s)
        if view.happened - reported == MOST_HAPPENINGS:
            reported = view.happened
            yield
    view.load.pass_time(batch.now_s)
