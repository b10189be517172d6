"""The stimulus of a sensor on a bench, tick by tick: a constant, a recorded log, or a script."""

from collections.abc import Callable, Iterable
from math import ceil, hypot, inf, isfinite
from typing import Final, final

from fsw.wire.candump_line import LineReader
from fsw.wire.messages import MagField, SunCells, SunVector, Sync, intact
from fsw.wire.value import Value

Values = tuple[float, ...]
"""Three components of a vector, or the currents of six cells."""
COUNTS: Final = {3: "three", 6: "six"}
"""Numbers of a reading, in words."""
STEP_KEYS: Final = ("t_s", "field_nt", "sun", "cells")
"""Keys of a step of a script, which may hold readings of several sensors."""


@final
class Reading(Value):
    """What the instrument reads: a field [T] or the unit vector to the Sun, body axes; currents of cells."""

    FIELDS = ("numbers", "valid")
    __slots__ = FIELDS

    def __init__(self, numbers: Values, valid: bool) -> None:
        self.numbers = numbers
        self.valid = valid


NOTHING: Final = Reading((0.0, 0.0, 0.0), False)
"""Of cells too: the board then sends no current."""

SensorMessage = type[MagField] | type[SunVector] | type[SunCells]
Stimulus = Callable[[int], Reading]
"""The reading at a tick."""


class StimulusError(Exception):
    """A stimulus that cannot be used; the message is one sentence for the user."""


def constant(values: Values) -> Stimulus:
    """The same at every tick."""
    return lambda tick: Reading(values, True)


def recorded(lines: Iterable[bytes], message: SensorMessage, scale: float) -> Stimulus:
    """The samples of the sensor in a candump log, at the same ticks; nothing where it was silent or broken.

    Args:
        lines: of the log; what is not one of our frames is skipped.
        message: of the sensor.
        scale: from the signals of that message to the reading.

    Raises:
        StimulusError: the log holds no sample of this sensor before a ``SYNC``.
    """
    readings: dict[int, Reading] = {}
    reader, latest = LineReader(), NOTHING
    for line in lines:
        logged = reader.read(line)
        if logged is None or not intact(frame := logged[2]):
            continue
        if frame.can_id == message.ID:
            valid, *values, _ = message.decode(frame.data).values()
            latest = Reading(scaled(tuple(values), scale), bool(valid))
        elif frame.can_id == Sync.ID:
            if latest is not NOTHING:
                readings[Sync.decode(frame.data).tick] = latest
            latest = NOTHING
    if not readings:
        raise StimulusError(f"the log holds no {message.__name__} of any tick")
    return lambda tick: readings.get(tick, NOTHING)


def scripted(
    steps: object, key: str, tick_hz: int, convert: Callable[[Values], Values], count: int = 3
) -> Stimulus:
    """The stimulus of a script: the value of ``key`` in the last step that has begun and has that key.

    Args:
        steps: tables with ``t_s``, the time from which they hold, rising from 0; numbers under ``key``, or
            false for an invalid sample.
        key: the sensor's; other keys than ``STEP_KEYS`` are refused.
        tick_hz: ticks a second.
        convert: the numbers of the script into a reading.
        count: how many numbers.

    Raises:
        StimulusError: a step of another form.
    """
    if not isinstance(steps, list) or not steps:
        raise StimulusError("a script needs at least one [[step]]")
    begun: list[tuple[int, Reading]] = []
    last_s = -1.0
    for number, step in enumerate(steps, 1):
        t_s = _time(step)
        if t_s is None or t_s <= last_s:
            raise StimulusError(f"step {number}: t_s must be a time in seconds, later than the step before")
        if strange := sorted(set(step) - set(STEP_KEYS)):
            raise StimulusError(
                f"step {number}: {', '.join(strange)} is not known: {', '.join(STEP_KEYS)} are"
            )
        last_s = t_s
        if key in step:
            reading = _reading(step[key], convert, count, f"step {number}: {key}")
            begun.append((ceil(t_s * tick_hz - 1e-9), reading))

    def at(tick: int) -> Reading:
        return next((reading for first, reading in reversed(begun) if first <= tick), NOTHING)

    return at


def scaled(values: Values, factor: float) -> Values:
    """The values times a factor."""
    return tuple([value * factor for value in values])


def currents(values: Values) -> Values:
    """Currents of cells as they are.

    Raises:
        StimulusError: one is negative.
    """
    if min(values) < 0.0:
        raise StimulusError("must be currents in parts of full sunlight, none below 0")
    return values


def direction(vector: Values) -> Values:
    """The unit vector along ``vector``.

    Raises:
        StimulusError: it is zero, or so large that its length is infinite.
    """
    length = hypot(*vector)
    if not 0.0 < length < inf:
        raise StimulusError("must be a direction: give three numbers that are not all 0, nor near 1e308")
    return tuple([component / length for component in vector])


def finite_numbers(values: object, count: int) -> Values:
    """``count`` finite numbers.

    Raises:
        StimulusError: it is something else.
    """
    numbers = values if isinstance(values, list | tuple) else ()
    if len(numbers) != count or not all(type(v) in (int, float) and isfinite(v) for v in numbers):
        raise StimulusError(f"must be {COUNTS[count]} finite numbers")
    return tuple(map(float, numbers))


def three(values: Values) -> tuple[float, float, float]:
    """The components of a vector."""
    x, y, z = values
    return (x, y, z)


def _time(step: object) -> float | None:
    """When a step begins; None if ``t_s`` is missing or wrong."""
    t_s = step.get("t_s") if isinstance(step, dict) else None
    if not isinstance(t_s, int | float) or isinstance(t_s, bool) or not isfinite(t_s) or t_s < 0.0:
        return None
    return float(t_s)


def _reading(value: object, convert: Callable[[Values], Values], count: int, name: str) -> Reading:
    if value is False:
        return NOTHING
    try:
        return Reading(convert(finite_numbers(value, count)), True)
    except StimulusError as error:
        raise StimulusError(f"{name} {error}, or false for nothing") from None
