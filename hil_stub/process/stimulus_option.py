"""The stimulus of ``--stimulus``: numbers, a log or a run, a script, or readings on standard input."""

import os
import select
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import click

from fsw.input.gzip_text import open_text, stored
from fsw.input.toml_text import load_toml
from fsw.wire.candump_line import LONGEST
from hil_stub.sensors.stimulus import (
    COUNTS,
    NOTHING,
    Reading,
    SensorMessage,
    Stimulus,
    StimulusError,
    Values,
    constant,
    finite_numbers,
    recorded,
    scaled,
    scripted,
)

PIPE_PATIENCE_S = 1.0
"""How long a sensor waits for a reading on stdin; after that the sample is invalid."""


class PipedStimulus:
    """Readings as lines on stdin, ``tick``, the values, ``valid``: waits a bounded time for the tick.

    Args:
        scale: from the numbers of the lines to the reading.
        count: how many values a line has.
        descriptor: where the lines come from.
    """

    def __init__(self, scale: float, count: int, descriptor: int = 0) -> None:
        self._scale = scale
        self._count = count
        self._descriptor = descriptor
        self._partial = b""
        self._readings: dict[int, Reading] = {}

    def __call__(self, tick: int) -> Reading:
        """The reading at ``tick``; NOTHING if it does not come.

        Raises:
            StimulusError: a line is not a reading.
        """
        deadline = time.monotonic() + PIPE_PATIENCE_S
        while tick not in self._readings:
            left_s = deadline - time.monotonic()
            if left_s <= 0.0 or not self._fill(left_s):
                return NOTHING
        self._readings = {at: reading for at, reading in self._readings.items() if at >= tick}
        return self._readings[tick]

    def _fill(self, timeout_s: float) -> bool:
        if not select.select((self._descriptor,), (), (), timeout_s)[0]:
            return False
        text = os.read(self._descriptor, 65536)
        *lines, self._partial = (self._partial + text).split(b"\n")
        if len(self._partial) > LONGEST:
            raise _no_reading(self._partial, self._count)
        for line in lines:
            tick, values, valid = _piped(line, self._count)
            self._readings[tick] = Reading(scaled(values, self._scale), valid)
        return bool(text)


def _piped(line: bytes, count: int) -> tuple[int, Values, bool]:
    """Tick, values and validity of a line."""
    words = line.split()
    if len(words) != count + 2 or not words[0].isdigit() or words[-1] not in (b"0", b"1"):
        raise _no_reading(line, count)
    tick, *values, valid = words
    try:
        return int(tick), finite_numbers(list(map(float, values)), count), valid == b"1"
    except (ValueError, StimulusError):
        raise _no_reading(line, count) from None


def _no_reading(line: bytes, count: int) -> StimulusError:
    shown = line[:60].decode("ascii", "backslashreplace")
    return StimulusError(
        f"a line on stdin must be a tick, {COUNTS[count]} finite numbers and 1 (valid) or 0, not '{shown}'"
    )


def stimulus_of(
    words: tuple[str, ...],
    key: str,
    message: SensorMessage,
    tick_hz: int,
    scale: float,
    convert: Callable[[Values], Values],
    count: int = 3,
) -> Stimulus:
    """The stimulus of the option's words: ``count`` numbers, a log or a run, a script, or ``-`` for stdin."""
    try:
        if len(words) == count:
            return constant(convert(finite_numbers([_number(word, count) for word in words], count)))
        if words == ("-",):
            return PipedStimulus(scale, count)
        if len(words) != 1:
            raise StimulusError(
                f"must be {COUNTS[count]} numbers, a run, a log, a script that ends in .toml, or -"
            )
        path = Path(words[0])
        if path.suffix == ".toml":
            return scripted(_toml(path).get("step"), key, tick_hz, convert, count)
        return recorded(_lines(stored(path / "bus.log") if os.path.isdir(path) else path), message, scale)
    except StimulusError as error:
        raise click.UsageError(f"--stimulus {' '.join(words)}: {error}") from None
    except OSError as error:
        raise click.UsageError(f"--stimulus {' '.join(words)}: cannot be read: {error.strerror}") from None


def stimulus_words(first: str | None, rest: tuple[str, ...], default: str) -> tuple[str, ...]:
    """The words after ``--stimulus``; without it the default, and no other argument."""
    if first is not None:
        return (first, *rest)
    if rest:
        raise click.UsageError(f"No such option or argument: {rest[0]}")
    return tuple(default.split())


def _number(word: str, count: int) -> float:
    try:
        return float(word)
    except ValueError:
        raise StimulusError(f"must be {COUNTS[count]} finite numbers") from None


def _toml(path: Path) -> dict[str, object]:
    try:
        return load_toml(path)
    except ValueError as error:
        raise StimulusError(f"cannot be read as TOML: {error}") from None


def _lines(log: Path) -> Iterator[bytes]:
    """The lines of a log; one longer than any frame's comes in pieces, none of which is a frame."""
    with open_text(log) as file:
        while line := file.readline(LONGEST):
            yield line
