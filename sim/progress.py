"""What stderr shows while something runs: a bar on a terminal, a line in a notebook or a log, and notes."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar

from fsw.input.error_text import line_text, lines_text
from sim.console import current

Watch = Callable[[int], None]

_SHOWN = ContextVar("shown", default=True)
_STANDING = ContextVar("standing", default=0)
"""Width of a line that is to be written over."""
LINE_EVERY_S = 0.5
"""Time between two states of the line in a notebook."""
NOTE_EVERY_S = 60.0
"""Time between two lines in a log; a run that is done before has none."""


@contextmanager
def shown(whether: bool) -> Iterator[None]:
    """Whether progress and notes are shown in the block; of other threads nothing changes."""
    before = _SHOWN.set(whether)
    try:
        yield
    finally:
        _SHOWN.reset(before)


def note(text: str) -> None:
    """A line on stderr, of what is no part of the result."""
    if _is_shown():
        width = _STANDING.get()  # of a notebook's line, which the note takes the place of
        line = f"\r{lines_text(text):{width}}" if width else lines_text(text)
        _STANDING.set(0)
        print(line, file=sys.stderr, flush=True)


@contextmanager
def progress(what: str, total: int, in_log: bool = True) -> Iterator[Watch]:
    """Yield a function to be called with the number of units done, of ``total``.

    Without ``in_log`` a log is left to the caller, who has more to say there.
    """
    what = line_text(what)
    if not _is_shown():
        yield lambda done: None
    elif sys.stderr.isatty():
        with _bar(what, total) as watch:
            yield watch
    elif _in_notebook():
        with _line(what, total) as watch:
            yield watch
    else:
        yield _notes(what, total) if in_log else lambda done: None


def _in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    kernel = sys.modules.get("ipykernel.kernelapp")
    return kernel is not None and bool(kernel.IPKernelApp.initialized())


def _is_shown() -> bool:
    return _SHOWN.get() and not current().quiet


@contextmanager
def _bar(what: str, total: int) -> Iterator[Watch]:
    from rich.console import Console  # noqa: PLC0415  (slow to load)
    from rich.progress import (  # noqa: PLC0415  (slow to load)
        BarColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        SpinnerColumn(),  # moves where one step takes long
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f}%"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done: bar.update(task, completed=done)


@contextmanager
def _line(what: str, total: int) -> Iterator[Watch]:
    """A line that is written over itself, as cells of notebooks show it."""
    written_s = 0.0

    def watch(done: int) -> None:
        nonlocal written_s
        if time.monotonic() - written_s >= LINE_EVERY_S:
            written_s = time.monotonic()
            line = f"{what}: {_percent(done, total)}"
            _STANDING.set(len(line))
            print(f"\r{line}", end="", file=sys.stderr, flush=True)

    try:
        yield watch
    finally:
        _STANDING.set(0)
    if written_s:
        print(f"\r{what}: done ", file=sys.stderr, flush=True)


def _notes(what: str, total: int) -> Watch:
    """A line now and then, for a run whose output goes to a file or to another program."""
    noted_s = time.monotonic()

    def watch(done: int) -> None:
        nonlocal noted_s
        if time.monotonic() - noted_s >= NOTE_EVERY_S:
            noted_s = time.monotonic()
            with suppress(BrokenPipeError):  # who read the log has gone; what runs is not theirs to end
                note(f"{what}: {_percent(done, total)}")

    return watch


def _percent(done: int, total: int) -> str:
    return f"{100.0 * done / max(total, 1):3.0f} %"
