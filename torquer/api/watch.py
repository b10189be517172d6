"""``torquer.watch``: a bus, or a log at any pace, moment after moment."""

from collections.abc import Generator, Iterator
from math import inf
from os import PathLike
from types import TracebackType
from typing import Self

from pydantic import Field

from fsw.input.schema import Section
from sim.record.pace import parse_pace
from sim.watch import command
from sim.watch.command import WatchSession, check_whole
from sim.watch.moments import WatchedMoment, moments
from torquer.api.arguments import checked, path_text
from torquer.api.errors import one_sentence


class _WatchOptions(Section):
    pace: str
    every_s: float = Field(gt=0.0)
    silent_s: float | None = Field(gt=0.0)


class WatchedMoments(Iterator[WatchedMoment]):
    """What frames have shown, moment after moment; ``close``, or the end of a ``with``, leaves the bus."""

    def __init__(self, following: Generator[WatchedMoment]) -> None:
        self._following = following

    @one_sentence
    def __next__(self) -> WatchedMoment:
        """The next moment, once it has come."""
        return next(self._following)

    def close(self) -> None:
        """Watch no longer."""
        self._following.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@one_sentence
def watch(
    source: str | PathLike[str] = "auto",
    *,
    pace: str = "lockstep",
    scenario: str | PathLike[str] | None = None,
    every_s: float = 1.0,
    silent_s: float | None = None,
) -> WatchedMoments:
    """Watch a bus or a log as ``torquer watch`` does, moment after moment; it only listens.

    Args:
        source: a run, its directory, a log, or a bus: ``auto``, ``loop``, ``socketcan:NAME`` and so on.
        pace: of a log: ``lockstep``, as fast as it can be read, or ``realtime[:FACTOR]``.
        scenario: of the satellite, which predicts field and Sun; None: that of the run.
        every_s: seconds of the satellite's time between two moments, at least one.
        silent_s: seconds of no frame after which there is no more; None: a bus is waited for until Ctrl-C.

    Raises:
        InputError: there is no such log, bus or scenario.
        Error: while it is watched: the log was cut short.
    """
    options = checked(_WatchOptions, "watch", pace=pace, every_s=every_s, silent_s=silent_s)
    named = None if scenario is None else path_text(scenario, "scenario")
    watched = command.watch(path_text(source, "source"), parse_pace(options.pace), named)
    return WatchedMoments(_followed(watched, options))


def _followed(watched: WatchSession, options: _WatchOptions) -> Generator[WatchedMoment]:
    silent_s = inf if options.silent_s is None else options.silent_s
    yield from moments(watched.source, watched.view, options.every_s, silent_s)
    check_whole(watched.source)
