"""``torquer phasing``: fire each coil in both polarities, or take a log in which that was done, and judge."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fsw.input.schema import Nested
from fsw.table.table import FlightTable
from sim.bench.budgets import Budgets
from sim.bench.command import HilSettings, hil
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.commissioning.phasing import bench_words, words
from sim.commissioning.phasing.bench_log import bench_responses, read_recording
from sim.commissioning.phasing.judge import Known, Phasing, phasing
from sim.console import Console, answer, detail, say, speaking
from sim.errors import HarnessError
from sim.flight.virtual import fly_virtual
from sim.progress import progress
from sim.record import run_dir
from sim.record.destination import check_folder
from sim.record.pace import Pace
from sim.scenario.schema import Scenario, flight_table, scenario_of

LAW = "phasing"
SETTLED_S = 20.0
"""On a bench after the last pulse, so that a sample that is late shows it and what is there without it; but
no more than twice the back-off, which bounds how late a sample may be told to be."""
AFTER_S = 30.0
"""After the last pulse, so that what it did is seen."""
ANY_BUDGET = Budgets(1e9, 1e9, 10**9, 1e9, 1e9)


@dataclass(frozen=True, slots=True)
class BenchSetUp:
    """A bench: the bus, boards that are hardware, and whether coils may be driven."""

    bus: str
    real: frozenset[str]
    armed: bool
    deadman_s: float = 5.0


def of_csv(path: Path) -> int:
    """Say the responses in a recorded bench log, which tells no axis: exit code 1 where none is clear."""
    responses = bench_responses(read_recording(path))
    for line in bench_words.lines(responses):
        say(line)
    answer(bench_words.as_json(responses))
    return int(not any(response.latest_s() for response in responses))


def of_log(run_or_log: Path, scenario: str | None, settings: Nested, known: Known) -> int:
    """Judge a log; the scenario is that beside it, unless one is named.

    Raises:
        HarnessError: no such log, or no scenario for it.
        TableError: the scenario is not valid.
    """
    log, folder = run_dir.locate(run_or_log)
    return _judge(log, flight_table(run_dir.scenario_of_log(log, folder, scenario, settings)), known)


def of_flight(scenario: Scenario, rounds: int, seed: int, known: Known, out: Path | None) -> int:
    """Fly the scenario in simulation, send TC_LAW for the sequence, and judge.

    Raises:
        TableError: the scenario has no pulsed coils.
    """
    flown = with_sequence(scenario, rounds)
    with _folder(out) as folder:
        ticks = sequence_ticks(flown, rounds)
        run_dir.begin(folder, flown, seed, ticks, "virtual", Pace())
        with progress(f"phasing {scenario.name}", ticks) as watch:
            fly_virtual(folder, flown, watch)
        return _judge(folder / run_dir.BUS_LOG, flight_table(flown), known)


def on_bench(
    scenario: Scenario, rounds: int, seed: int, known: Known, bench: BenchSetUp, out: Path | None
) -> int:
    """Run the sequence in real time on a bench, and judge.

    Raises:
        BusError: the bus cannot be used, or a flight is in progress on it.
        HarnessError: it is not armed, or a node does not start.
    """
    if not bench.armed:
        raise HarnessError("--bus: phasing drives coils: allow it by --arm")
    flown = with_sequence(scenario, rounds)
    seconds = sequence_ticks(flown, rounds, at_rest=True) / flown.time.tick_hz
    with _folder(out) as folder:
        fixed = (True, seconds, "plant", bench.deadman_s, ANY_BUDGET, 1e9)
        with speaking(Console("hil", quiet=True)):  # of the bench only what failed is said
            code = hil(HilSettings(flown, bench.bus, bench.real, *fixed, seed, folder))
        return _judge(folder / run_dir.BUS_LOG, flight_table(flown), known) or code


def with_sequence(scenario: Scenario, rounds: int) -> Scenario:
    """The scenario with a telecommand that begins the sequence at once.

    Raises:
        TableError: its coils are driven continuously.
    """
    values = scenario.model_dump(mode="json", exclude_none=True)
    values["telecommand"] = [*values["telecommand"], {"message": "TC_LAW", "law": LAW, "at_s": 1.0}]
    gains = {**values["control"].get("gains", {}), LAW: {"rounds": float(rounds)}}
    values["control"] = {**values["control"], "gains": gains}
    values["requirement"] = []
    if scenario.coils.driver == "continuous":
        raise HarnessError("phasing needs pulsed coils: the scenario has coils.driver = 'continuous'")
    return scenario_of(values, scenario.name)


def sequence_ticks(scenario: Scenario, rounds: int, at_rest: bool = False) -> int:
    """Ticks of the whole sequence: the lockout after boot, then each coil in both polarities.

    Where the back-off is by coil, the three take turns. On a bench it ends with the last pulse.
    """
    coils = scenario.coils
    each_s = coils.pulse_s + coils.backoff_s / (1.0 if coils.shared else 3.0)
    recover_s = flight_table(scenario).modes.recover_s
    after_s = min(SETTLED_S, 2.0 * coils.backoff_s) if at_rest else coils.backoff_s + AFTER_S
    late_s = 4.0 / scenario.time.tick_hz  # until the board has reported that the coil is ready
    whole_s = max(coils.backoff_s, recover_s) + 1.0 + 6 * rounds * (each_s + late_s) + after_s
    return ceil(whole_s * scenario.time.tick_hz)


def _judge(log: Path, table: FlightTable, known: Known) -> int:
    """Say the verdict: exit code 1 where the wiring is not told, or not the table's."""
    detail(f"phasing from {log}")
    samples = read_samples(log, table.time.tick_hz)
    try:
        found = phasing(samples, table, _with_table(known, table))
    except HarnessError as error:
        raise HarnessError(f"{log}: {error}") from None
    _say(found, table)
    return int(found.wiring is None or found.wiring != words.of_table(table))


def _with_table(known: Known, table: FlightTable) -> Known:
    """With the coils' field by true dipole, where the table has it by output."""
    coils = table.calibration.coils
    if known.coil_field_nt_per_am2 is not None or coils is None or coils.field_nt_per_am2 is None:
        return known
    by_output = np.array(coils.field_nt_per_am2)
    dipoles = np.eye(3) if coils.matrix is None else np.array(coils.matrix)
    return Known(by_output @ np.linalg.inv(dipoles), known.field_around_nt, known.offset_nt, known.in_orbit)


def _say(found: Phasing, table: FlightTable) -> None:
    for line in words.lines(found, table):
        say(line)
    failed = found.wiring is None or found.wiring != words.of_table(table)
    say(words.verdict(found, table), failed=failed)
    answer(words.as_json(found, table))


@contextmanager
def _folder(kept: Path | None) -> Iterator[Path]:
    """The folder that is kept, or a temporary one."""
    if kept is not None:
        check_folder(kept)
        yield kept
        return
    with TemporaryDirectory() as folder:
        yield Path(folder) / "run"
