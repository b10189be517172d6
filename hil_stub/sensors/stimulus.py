"""The stimulus of a sensor on a bench, tick by tick: a constant, a recorded log, or a script."""

from collections.abc import Callable, Iterable
from math import ceil, hypot, isfinite
from typing import NamedTuple

from fsw.wire.candump_line import LineReader
from fsw.wire.messages import MagField, SunVector, Sync, intact

Vec3 = tuple[float, float, float]


class Reading(NamedTuple):
    """What the instrument reads: a field [T] or the unit vector to the Sun, body axes."""

    vector: Vec3
    valid: bool


NOTHING = Reading((0.0, 0.0, 0.0), False)

Stimulus = Callable[[int], Reading]
"""The reading at a tick."""


class StimulusError(Exception):
    """A stimulus that cannot be used; the message is one sentence for the user."""


def constant(vector: Vec3) -> Stimulus:
    """The same at every tick."""
    return lambda tick: Reading(vector, True)


def recorded(lines: Iterable[bytes], message: type[MagField] | type[SunVector], scale: float) -> Stimulus:
    """The samples of the sensor in a candump log, at the same ticks; nothing where it was silent or broken.

    Args:
        lines: of the log; what is no frame of ours is passed over.
        message: of the sensor.
        scale: from the signals of that message to the reading.

    Raises:
        StimulusError: the log holds not one sample of this sensor before a ``SYNC``.
    """
    readings: dict[int, Reading] = {}
    reader, latest = LineReader(), NOTHING
    for line in lines:
        logged = reader.read(line)
        if logged is None or not intact(frame := logged[2]):
            continue
        if frame.can_id == message.ID:
            valid, x, y, z, _ = message.decode(frame.data)
            latest = Reading(scaled((x, y, z), scale), bool(valid))
        elif frame.can_id == Sync.ID:
            if latest is not NOTHING:
                readings[Sync.decode(frame.data).tick] = latest
            latest = NOTHING
    if not readings:
        raise StimulusError(f"the log holds no {message.__name__} of any tick")
    return lambda tick: readings.get(tick, NOTHING)


def scripted(steps: object, key: str, tick_hz: int, convert: Callable[[Vec3], Vec3]) -> Stimulus:
    """The stimulus of a script: the value of ``key`` in the last step that has begun and has that key.

    Args:
        steps: tables with ``t_s``, the time from which they hold, rising from 0; three numbers under ``key``,
            or false for an invalid sample.
        key: the sensor's.
        tick_hz: ticks a second.
        convert: the numbers of the script into a reading.

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
        last_s = t_s
        if key in step:
            reading = _reading(step[key], convert, f"step {number}: {key}")
            begun.append((ceil(t_s * tick_hz - 1e-9), reading))

    def at(tick: int) -> Reading:
        return next((reading for first, reading in reversed(begun) if first <= tick), NOTHING)

    return at


def scaled(vector: Vec3, factor: float) -> Vec3:
    """The vector times a factor."""
    x, y, z = vector
    return (x * factor, y * factor, z * factor)


def direction(vector: Vec3) -> Vec3:
    """The unit vector along ``vector``.

    Raises:
        StimulusError: it is zero.
    """
    x, y, z = vector
    length = hypot(x, y, z)
    if length == 0.0:
        raise StimulusError("must be a direction: give three numbers that are not all 0")
    return (x / length, y / length, z / length)


def three_numbers(values: object) -> Vec3:
    """Three finite numbers.

    Raises:
        StimulusError: it is something else.
    """
    numbers = values if isinstance(values, list | tuple) else ()
    if len(numbers) != 3 or not all(type(v) in (int, float) and isfinite(v) for v in numbers):
        raise StimulusError("must be three finite numbers")
    x, y, z = map(float, numbers)
    return (x, y, z)


def _time(step: object) -> float | None:
    """When a step begins; None if it does not say, or not properly."""
    t_s = step.get("t_s") if isinstance(step, dict) else None
    if not isinstance(t_s, int | float) or isinstance(t_s, bool) or not isfinite(t_s) or t_s < 0.0:
        return None
    return float(t_s)


def _reading(value: object, convert: Callable[[Vec3], Vec3], name: str) -> Reading:
    if value is False:
        return NOTHING
    try:
        return Reading(convert(three_numbers(value)), True)
    except StimulusError as error:
        raise StimulusError(f"{name} {error}, or false for nothing") from None
