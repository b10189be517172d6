"""Replay: the logged frames through the flight software again, its answers compared with the logged ones.

Two verdicts: bit-exact (every frame and every state CRC equal), required where the platform is the run's;
command-exact (every COIL_FIRE and event equal, navigation within one unit of its signal), enough elsewhere.
"""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fsw.core.config import FlightConfig
from fsw.core.state import FlightState
from fsw.io.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    FswBoot,
    NavAttitude,
    NavQuality,
    NavRate,
    PlantEnd,
    Sync,
    TickDone,
    intact,
)
from sim.harness.candump import LogEntry, LogTruncatedError, read_log

FROM_FSW = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
UNITS: dict[int, tuple[float, ...]] = {
    NavAttitude.ID: (0.0, 2.0**-16, 2.0**-16, 2.0**-16),
    NavRate.ID: (0.0, 2.0**-19, 2.0**-19, 2.0**-19),
    NavQuality.ID: (0.0, 2.0**-14, 2.0**-22),
}
"""What one unit of each signal is, for the messages whose last bit may differ; 0 and absent: exact."""

OnTick = Callable[[FlightState], None]


@dataclass(frozen=True, slots=True)
class Difference:
    """Where log and replay part: the tick, the signal and both values."""

    tick: int
    signal: str
    logged: object
    reflown: object

    def __str__(self) -> str:
        """One clause for the user."""
        return f"tick {self.tick}: {self.signal} is {self.logged} in the log and {self.reflown} in the replay"


@dataclass(frozen=True, slots=True)
class Replay:
    """What a replay showed.

    ``ended``: the log has its end mark. ``end_line`` is the last line read, ``cut`` says it was cut short.
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


def replay(log: Path, config: FlightConfig, on_tick: OnTick = lambda state: None) -> Replay:
    """Refly a log.

    Args:
        log: a candump log.
        config: what the flight software flew with.
        on_tick: called with the flight state after every reflown tick.

    Raises:
        LogError: the file is no candump log, or was altered so that it no longer is one.
    """
    node = FlightNode(config)
    boot = node.start()
    expected: deque[tuple[int, Frame]] = deque([(0, boot)])
    differences: dict[bool, Difference] = {}
    ticks = frames = end_line = 0
    last_tick = -1
    ended = cut = False
    entries = _whole_entries(log)
    for entry in entries:
        if entry is None:
            cut = True
            break
        end_line = entry.line
        frame = entry.frame
        ended = frame.can_id == PlantEnd.ID and intact(frame)
        if ended and (told := PlantEnd.decode(frame.data).ticks) != last_tick + 1:
            differences[True] = Difference(max(last_tick, 0), "PLANT_END.ticks", told, last_tick + 1)
            break
        if frame.can_id in FROM_FSW:
            frames += 1
            if (
                frame == boot and not expected and node.state.tick < 0
            ):  # asked for again by a plant that came late
                node.start()
                continue
            found = _difference(frame, expected, max(last_tick, 0))
            if found is not None:
                exact, difference = found
                differences.setdefault(exact, difference)
                if exact:
                    break
            continue
        before = node.state.tick
        answers = node.receive(frame)
        if frame.can_id == Sync.ID and node.state.tick != before:
            last_tick = node.state.tick
            ticks += 1
            expected.extend((last_tick, answer) for answer in answers)
            on_tick(node.state)
    if ended and expected and True not in differences:
        tick, frame = expected[0]
        differences[True] = Difference(tick, NAMES[frame.can_id], "missing", "there")
    first = min(differences.values(), key=lambda d: d.tick, default=None)
    return Replay(ticks, frames, first, differences.get(True), ended, cut, end_line, last_tick)


def _whole_entries(log: Path) -> Iterator[LogEntry | None]:
    """The entries; a last None where the log is cut inside a line."""
    try:
        yield from read_log(log)
    except LogTruncatedError:
        yield None


def _difference(
    frame: Frame, expected: deque[tuple[int, Frame]], tick: int
) -> tuple[bool, Difference] | None:
    """A logged frame against the next reflown one: None if equal, else (whether a command differs, where)."""
    if not expected:
        return True, Difference(tick, NAMES[frame.can_id], "there", "missing")
    tick, reflown = expected.popleft()
    if frame == reflown:
        return None
    if frame.can_id != reflown.can_id:
        return True, Difference(tick, "the next frame", NAMES[frame.can_id], NAMES[reflown.can_id])
    message = CLASSES[frame.can_id]
    if len(frame.data) != message.LENGTH or (frame.can_id != TickDone.ID and not intact(frame)):
        return True, Difference(
            tick, f"{NAMES[frame.can_id]} as a whole", frame.data.hex(), reflown.data.hex()
        )
    logged_values, reflown_values = message.decode(frame.data), message.decode(reflown.data)
    differing = [
        index
        for index, pair in enumerate(zip(logged_values, reflown_values, strict=True))
        if pair[0] != pair[1]
    ]
    first = differing[0]
    signal = f"{NAMES[frame.can_id]}.{message._fields[first]}"
    difference = Difference(tick, signal, logged_values[first], reflown_values[first])
    if frame.can_id in (TickDone.ID, FswBoot.ID):
        return message._fields[first] == "tick", difference
    units = UNITS.get(frame.can_id, ())
    tolerated = all(
        index < len(units) and abs(logged_values[index] - reflown_values[index]) <= 1.001 * units[index]
        for index in differing
    )
    return not tolerated, difference
