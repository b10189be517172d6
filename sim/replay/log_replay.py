"""Replay of a log through the flight software: its answers are compared with the logged ones.

Bit-exact: every frame and every state CRC equal; required on the platform of the run. Command-exact: every
COIL_FIRE and event equal, navigation within one unit of its signal; sufficient elsewhere.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fsw.core.config import FlightConfig
from fsw.node import TICKS_MODULO
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    FswBoot,
    NavAttitude,
    NavParameter,
    NavQuality,
    NavRate,
    PlantEnd,
    TickDone,
    intact,
)
from sim.record.candump import LogEntry, LogTruncatedError, More, read_log
from sim.replay.replayed_software import OnTick, ReplayedSoftware

FROM_FSW = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
UNITS: dict[int, tuple[float, ...]] = {
    NavAttitude.ID: (0.0, 2.0**-16, 2.0**-16, 2.0**-16),
    NavRate.ID: (0.0, 2.0**-19, 2.0**-19, 2.0**-19),
    NavQuality.ID: (0.0, 2.0**-14, 2.0**-22),
    NavParameter.ID: (0.0, 0.0, 1.0, 1.0),
}
"""The unit of each signal of the messages whose last bit may differ; 0 and absent: exact."""


@dataclass(frozen=True, slots=True)
class Difference:
    """Where log and replay first differ: the tick, the signal and both values."""

    tick: int
    signal: str
    logged: object
    replayed: object

    def __str__(self) -> str:
        """The difference as a clause of a sentence."""
        return (
            f"tick {self.tick}: {self.signal} is {self.logged} in the log and {self.replayed} in the replay"
        )


@dataclass(frozen=True, slots=True)
class ReplayResult:
    """The result of a replay.

    ``ended``: the log ends with a PLANT_END that fits. ``end_line`` is the last line read; ``cut``: the log
    is truncated inside the next.
    """

    ticks: int
    frames: int
    first_bit_difference: Difference | None
    first_command_difference: Difference | None
    ended: bool
    cut: bool
    end_line: int
    last_tick: int

    @property
    def bit_exact(self) -> bool:
        """Whether all frames and state CRCs agree, as far as the log goes."""
        return self.first_bit_difference is None

    @property
    def command_exact(self) -> bool:
        """Whether all commands agree, as far as the log goes."""
        return self.first_command_difference is None


def replay(
    log: Path,
    config: FlightConfig,
    on_tick: OnTick = lambda state: None,
    forged: bool = False,
    more: More | None = None,
    channel: str | None = None,
) -> ReplayResult:
    """Replay a log.

    Only a PLANT_END that is the last frame and fits the number of ticks is the end of the run; a stranger
    sent any other.

    Args:
        log: a candump log.
        config: of the flight software in the run.
        on_tick: called with the flight state after every replayed tick.
        forged: the scenario injects frames under identifiers of the flight software: such a frame between two
            answers is received, not compared.
        more: given where the log is still being written.
        channel: the one to read, of a log that has several.

    Raises:
        LogError: the file is not a candump log, or is no longer one after an alteration.
    """
    software = ReplayedSoftware(config, on_tick)
    differences: dict[bool, Difference] = {}
    frames = end_line = 0
    end: int | None = None
    doubt: tuple[bool, Difference] | None = None  # a broken frame is noise if the whole answer follows
    cut = False
    for entry in _whole_entries(log, more, channel):
        if entry is None:
            cut = True
            break
        end_line = entry.line
        frame = entry.frame
        end = PlantEnd.decode(frame.data).ticks if frame.can_id == PlantEnd.ID and intact(frame) else None
        if frame.can_id not in FROM_FSW:
            software.receive(frame)
            continue
        frames += 1
        if frame == software.boot and not software.expected:  # a plant that started late asked for it again
            software.reboot()
        elif not software.expected and (forged or not intact(frame)):
            software.receive(frame)
        elif not intact(frame) and frame != software.expected[0][1]:
            doubt = doubt or _difference(frame, deque(software.expected), max(software.last_tick, 0))
            software.receive(frame)
        elif not software.explains(frame):
            exact, difference = doubt or _difference(frame, software.expected, max(software.last_tick, 0))
            differences.setdefault(exact, difference)
            if exact:
                break
        elif not software.expected:
            doubt = None
    ticks = (software.last_tick + 1) % TICKS_MODULO
    tick = max(software.last_tick, 0)
    if end is not None and end != ticks and True not in differences:
        differences[True] = Difference(tick, "PLANT_END.ticks", end, ticks)
    elif end is not None and software.expected and True not in differences:
        tick, missing = software.expected[0]
        differences[True] = doubt[1] if doubt else Difference(tick, NAMES[missing.can_id], "missing", "there")
    first = min(differences.values(), key=lambda d: d.tick, default=None)
    return ReplayResult(
        software.ticks,
        frames,
        first,
        differences.get(True),
        end == ticks,
        cut,
        end_line,
        software.last_tick,
    )


def _whole_entries(log: Path, more: More | None, channel: str | None) -> Iterator[LogEntry | None]:
    """The entries; a last None where the log is cut inside a line."""
    try:
        yield from read_log(log, more, channel)
    except LogTruncatedError:
        yield None


def _difference(frame: Frame, expected: deque[tuple[int, Frame]], tick: int) -> tuple[bool, Difference]:
    """A logged frame that is not the next replayed one: whether a command differs, and where."""
    if not expected:
        return True, Difference(tick, NAMES[frame.can_id], "there", "missing")
    tick, replayed = expected.popleft()
    if frame.can_id != replayed.can_id:
        return True, Difference(tick, "the next frame", NAMES[frame.can_id], NAMES[replayed.can_id])
    message = CLASSES[frame.can_id]
    if len(frame.data) != message.LENGTH or (frame.can_id != TickDone.ID and not intact(frame)):
        return True, Difference(
            tick, f"{NAMES[frame.can_id]} as a whole", frame.data.hex(), replayed.data.hex()
        )
    logged_values = message.decode(frame.data).values()
    replayed_values = message.decode(replayed.data).values()
    differing = [
        index
        for index, pair in enumerate(zip(logged_values, replayed_values, strict=True))
        if pair[0] != pair[1]
    ]
    first = differing[0]
    signal = f"{NAMES[frame.can_id]}.{message.FIELDS[first]}"
    difference = Difference(tick, signal, logged_values[first], replayed_values[first])
    if frame.can_id in (TickDone.ID, FswBoot.ID):
        return message.FIELDS[first] == "tick", difference
    units = UNITS.get(frame.can_id, ())
    tolerated = all(
        index < len(units) and abs(logged_values[index] - replayed_values[index]) <= 1.001 * units[index]
        for index in differing
    )
    return not tolerated, difference
