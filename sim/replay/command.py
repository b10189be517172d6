"""``torquer replay``: a log through the flight software, through the plant, or onto a bus."""

import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import groupby, islice, zip_longest
from pathlib import Path
from typing import Any, NamedTuple

from fsw.bus.open_bus import open_bus
from fsw.input.own_code import display
from fsw.input.schema import Nested
from fsw.node import TICKS_MODULO
from fsw.table.config import flight_config
from fsw.wire.candump_line import format_time
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, Sync, TickDone
from sim.errors import HarnessError
from sim.faults.section import forge_answers, make_plant
from sim.flight.fsw_answers import has_answer
from sim.progress import progress
from sim.record import run_dir
from sim.record.binding import Binding, compare
from sim.record.candump import LogEntry, LogTruncatedError, read_log
from sim.record.log_index import check_against_index
from sim.record.run_record import RunRecord
from sim.record.signature import PublicKey
from sim.replay.log_replay import ReplayResult, replay
from sim.scenario.assemble import effects_of, plant_config
from sim.scenario.law_named import with_law_named
from sim.scenario.schema import Scenario, flight_table
from sim.scenario.telecommands import uplink

LONGEST_PAUSE_S = 86_400.0
"""In a log that is played onto a bus: a longer pause means that it was not recorded in one piece."""


class LoggedRun(NamedTuple):
    """The run that a log is of: its scenario, its run.json where there is one, and the check of its files.

    ``law`` is the user law that was named again; without it none is executed, and without ``effects``
    no user effect.
    """

    scenario: Scenario
    record: RunRecord | None
    binding: Binding
    law: str | None = None
    effects: bool = False
    channel: str | None = None

    @property
    def ticks(self) -> int:
        """Number of ticks of the run; 0 where it is unknown."""
        return self.record["ticks"] if self.record else 0

    def miscounted(self, ticks: int) -> list[str]:
        """What is wrong with a log of so many ticks, a line: that it has none, or not those of its run."""
        if ticks == 0:
            return ["nothing was replayed: the log has no tick"]
        flown = self.record["flown"]["ticks"] if self.record and self.record["complete"] else ticks
        if (flown - ticks) % TICKS_MODULO == 0:
            return []
        return [f"differs: the log ends after {ticks} ticks, and {run_dir.RUN} names {flown}"]


@dataclass(frozen=True, slots=True)
class ReplayReport:
    """What a replay has found.

    Attributes:
        ok: what was replayed is as exact as this platform allows, and log and files are those of the run.
        lines: the result in words, a line each.
        result: of a replay through the flight software; None for the others.
    """

    ok: bool
    lines: tuple[str, ...]
    result: ReplayResult | None = None

    def __str__(self) -> str:
        """The lines."""
        return "\n".join(self.lines)


def locate(
    run_or_log: Path,
    scenario: str | None,
    settings: Nested,
    key: PublicKey | None = None,
    law: str | None = None,
    effects: bool = False,
    channel: str | None = None,
) -> tuple[Path, LoggedRun]:
    """The log and its run; with a key, the run must be signed by its private half.

    Raises:
        HarnessError: no such log, or no scenario for it.
        TableError: the scenario is not valid.
    """
    log, folder = run_dir.locate(run_or_log)
    binding = compare(folder, log, key)
    with binding.beside_errors():
        next(read_log(log, channel=channel))  # a file that is not a log is reported first
        record = run_dir.read_run(folder) if (folder / run_dir.RUN).is_file() else None
        judged_by = run_dir.scenario_of_log(log, folder, scenario, settings)
        return log, LoggedRun(judged_by, record, binding, law, effects, channel)


def through_flight_software(log: Path, run: LoggedRun) -> ReplayReport:
    """Compare the answers of the flight software; the log must be complete."""
    if run.record is not None and "flight_software" in run.record:
        raise HarnessError(
            f"{log}: another flight software has flown, whose answers this one cannot give again: "
            "--plant replays the plant"
        )
    scenario, note = with_law_named(run.scenario, run.law, of_run=False)
    config = flight_config(flight_table(scenario))
    with progress("replaying", run.ticks) as watch:
        result = replay(
            log,
            config,
            lambda state: watch(state.tick),
            forge_answers(run.scenario.fault),
            channel=run.channel,
        )
    if not result.frames:
        raise HarnessError(f"{log}: no frame of the flight software in it: nothing to compare")
    same_platform = run.record is None or run.record["platform"] == run_dir.fingerprint()
    exact = result.bit_exact or (result.command_exact and not same_platform)
    holds, binding_lines = _binding(log, run)
    lines = [*([f"note: {note}"] if note else []), *_found(result, _needed(run.record)), *binding_lines]
    if not result.bit_exact:
        lines += _without_state(log, run.channel)
    if result.command_exact and not result.ended:
        how = "inside a line" if result.cut else "without its end mark"
        end = f"after line {result.end_line}, at tick {max(result.last_tick, 0)}"
        lines.append(f"incomplete: the log ends {how} {end}")
    miscounted = run.miscounted(result.last_tick + 1 if result.ticks else 0) if result.ended else []
    return ReplayReport(exact and holds and result.ended and not miscounted, (*lines, *miscounted), result)


def _needed(record: RunRecord | None) -> str:
    """How exact the replay of a run has to be, and why."""
    here = run_dir.fingerprint()
    if record is None or record["platform"] == here:
        return "bit-exact is required: the platform is the run's"
    there = record["platform"].get("algebra")
    if there is not None and there != here["algebra"]:
        return f"{there} computed the filter's matrices, here {here['algebra']} does: commands count alone"
    return "another platform than the run's"


def _found(result: ReplayResult, needed: str) -> list[str]:
    """How exact a replay is, in words; none of a whole log without a tick."""
    if result.bit_exact and result.ended and not result.ticks:
        return []
    if result.bit_exact:
        return [f"bit-exact: {result.ticks} ticks, {result.frames} frames, every state CRC equal"]
    if result.command_exact:
        return [f"command-exact, not bit-exact ({needed}): {result.first_bit_difference}"]
    lines = [f"differs: {result.first_bit_difference}"]
    if result.first_command_difference != result.first_bit_difference:
        lines.append(f"first command that differs: {result.first_command_difference}")
    return lines


def _without_state(log: Path, channel: str | None) -> list[str]:
    """That the log is of a flight software which gives no CRC of its state, where it is."""
    entries = read_log(log, channel=channel)
    dones = (one.frame for one in entries if one.frame.can_id == TickDone.ID)
    first = next((frame for frame in dones if len(frame.data) == TickDone.LENGTH), None)
    if first is None or TickDone.decode(first.data).state_crc:
        return []
    return ["its TICK_DONE gives no CRC of the state (0): another flight software has flown"]


def through_plant(log: Path, run: LoggedRun) -> ReplayReport:
    """Feed the recorded commands to the plant: its frames must be those of the log."""
    if run.record is None:
        raise HarnessError(f"{log}: --plant needs the seed: no {run_dir.RUN} beside it")
    if run.scenario.effect and not run.effects:
        named = ", ".join(display(effect.use) for effect in run.scenario.effect)
        raise HarnessError(f"{log}: the run has user effects ({named}): --effects executes them")
    effects = effects_of(run.scenario)
    plant = make_plant(plant_config(run.scenario, run.record["seed"]), run.scenario.fault, effects)
    commands_of = uplink(run.scenario.telecommand, run.scenario.time.tick_hz)
    ticks = 0
    with progress("replaying", run.ticks) as watch:
        for logged, is_last in _by_time(log, run.channel):
            if is_last and logged == [plant.end()]:
                holds, lines = _binding(log, run)
                miscounted = run.miscounted(ticks)
                equal = [f"plant reproduced: {ticks} ticks, every frame equal"] if ticks else []
                return ReplayReport(holds and not miscounted, (*equal, *lines, *miscounted))
            sent = plant.begin_tick()
            begin = _beginning(logged, sent)
            end = begin + len(sent)
            difference = _difference(sent, logged[begin:end])
            if difference is not None:
                _, lines = _binding(log, run)
                return ReplayReport(False, (f"differs: tick {ticks}: {difference}", *lines))
            for frame in _without_own(logged[:begin], commands_of(ticks)) + logged[end:]:
                plant.receive(frame)
            plant.slips += not has_answer(logged, ticks)
            plant.end_tick()
            ticks += 1
            watch(ticks)
    _, lines = _binding(log, run)
    end_line = f"incomplete: the log ends without its end mark at tick {max(ticks - 1, 0)}"
    return ReplayReport(False, (*lines, end_line))


def _binding(log: Path, run: LoggedRun) -> tuple[bool, list[str]]:
    """Whether index and run.json agree with the log, and what they say about it."""
    voucher = check_against_index(log)
    lines = [f"{'note' if voucher.holds else 'index'}: {voucher.sentence}"] if voucher.sentence else []
    return voucher.holds and run.binding.holds, lines + run.binding.lines


def _beginning(logged: list[Frame], sent: list[Frame]) -> int:
    """Where the frames of the plant begin in a tick: SYNC is the last of them, others may precede them."""
    own = [index for index, frame in enumerate(logged) if frame == sent[-1]]
    any_sync = [index for index, frame in enumerate(logged) if frame.can_id == Sync.ID]
    sync = next(iter(own + any_sync), len(sent))
    return max(0, sync + 1 - len(sent))


def _without_own(before: list[Frame], commands: list[Frame]) -> list[Frame]:
    """The frames before those of the plant, without the scenario's telecommands, which it sends with them."""
    first = len(before) - len(commands)
    return before[:first] if first >= 0 and before[first:] == commands else before


def _difference(sent: list[Frame], logged: list[Frame]) -> str | None:
    """The first frame that the plant does not send as logged."""
    for own, other in zip_longest(sent, logged):
        if own != other:
            name = NAMES.get((own or other).can_id, "a frame")
            texts = [frame.data.hex() if frame else "missing" for frame in (other, own)]
            return f"{name} is {texts[0]} in the log and {texts[1]} from the plant"
    return None


def play(log: Path, run: LoggedRun, spec: str) -> ReplayReport:
    """Send every frame of the log onto a bus, spaced as its timestamps are.

    Raises:
        HarnessError: the log pauses for longer than a day.
        BusError: the bus cannot be used.
    """
    first_us, last_us = _playable(log, run.channel)
    bus = open_bus(spec)
    try:
        with progress(f"playing onto {spec}", last_us - first_us) as watch:
            began = time.monotonic()
            for stamp_us, group in groupby(
                read_log(log, channel=run.channel), key=lambda entry: entry.timestamp_us
            ):
                watch(stamp_us - first_us)
                time.sleep(max(0.0, began + (stamp_us - first_us) / 1e6 - time.monotonic()))
                bus.send([entry.frame for entry in group])
    finally:
        bus.close()
    return ReplayReport(run.binding.holds, tuple(run.binding.lines))


def _by_time(log: Path, channel: str | None) -> Iterator[tuple[list[Frame], bool]]:
    """The frames after FSW_BOOT, grouped by time stamp, and whether they are the last of the log."""
    groups = groupby(_after_boot(log, channel), key=lambda entry: entry.timestamp_us)
    frames = ([entry.frame for entry in group] for _, group in groups)
    before = next(frames, None)
    for after in frames:
        assert before is not None
        yield before, False
        before = after
    if before is not None:
        yield before, True


def _playable(log: Path, channel: str | None) -> tuple[int, int]:
    """First and last timestamp [us] of a log that can be played."""
    first_us = last_us = next(read_log(log, channel=channel)).timestamp_us
    with suppress(LogTruncatedError):
        for entry in read_log(log, channel=channel):
            pause_s = (entry.timestamp_us - last_us) / 1e6
            if pause_s > LONGEST_PAUSE_S:
                raise HarnessError(
                    f"{log}: at {format_time(entry.timestamp_us)} it pauses for {pause_s:.0f} s"
                )
            last_us = entry.timestamp_us
    return first_us, last_us


def _after_boot(log: Path, channel: str | None) -> Iterator[LogEntry]:
    """The whole entries after FSW_BOOT, up to where the log is cut."""
    with suppress(LogTruncatedError):
        yield from islice(read_log(log, channel=channel), 1, None)


# --- The result of a replay for programs


def as_json(report: ReplayReport) -> dict[str, Any]:
    """Whether it is as exact as it must be and, for a replay through the flight software, how exact."""
    values: dict[str, Any] = {"ok": report.ok, "lines": report.lines}
    result = report.result
    if result is None:
        return values
    return values | {
        "bit_exact": result.bit_exact,
        "command_exact": result.command_exact,
        "ticks": result.ticks,
        "frames": result.frames,
        "first_bit_difference": _text(result.first_bit_difference),
        "first_command_difference": _text(result.first_command_difference),
        "complete": result.ended,
    }


def _text(difference: object) -> str | None:
    return None if difference is None else str(difference)
