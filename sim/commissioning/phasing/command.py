"""``torquer phasing``: fire each coil in both polarities, or take a log in which that was done, and judge."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fsw.input.schema import Nested
from fsw.table.table import FlightTable
from sim.bench.budgets import Budgets
from sim.bench.command import HilSettings, hil, real_boards
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.commissioning.phasing import bench_words, words
from sim.commissioning.phasing.bench_log import bench_responses, is_bench_log, read_recording
from sim.commissioning.phasing.judge import PhasingPremises, phasing
from sim.commissioning.report import CommissioningReport, ReportLine, in_lines
from sim.console import Console, detail, speaking
from sim.errors import HarnessError, refuse
from sim.flight.virtual import fly_virtual
from sim.progress import progress
from sim.record import run_dir
from sim.record.destination import check_folder
from sim.record.pace import Pace
from sim.scenario.schema import Scenario, flight_table, load, scenario_of

LAW = "phasing"
SETTLED_S = 20.0
"""On a bench after the last pulse, so that a sample that is late shows it and what is there without it; but
no more than twice the back-off, which bounds how late a sample may be found to be."""
AFTER_S = 30.0
"""After the last pulse, so that what it did is seen."""
ANY_BUDGET = Budgets(1e9, 1e9, 10**9, 1e9, 1e9)
OFFSET_NT = 1000.0
OF_A_BENCH = ("real", "arm")
OF_A_FLIGHT = ("bus", *OF_A_BENCH, "rounds", "seed", "out")
OF_A_LOG = ("scenario", "settings", "at_rest", "field_nt", "offset_nt", "coil_field_nt_per_am2")
"""Options by what they say something of."""
OPTIONS = {"settings": "set"}
"""Those that the command line calls otherwise."""


@dataclass(frozen=True, slots=True)
class BenchSetUp:
    """A bench: the bus, boards that are hardware, and whether coils may be driven."""

    bus: str
    real: frozenset[str]
    armed: bool
    deadman_s: float = 5.0


@dataclass(frozen=True, slots=True)
class PhasingOptions:
    """How wiring is determined; what is None, False or empty is not given.

    Attributes:
        scenario: of a log that has none beside it, its name or path.
        settings: laid over the scenario.
        bus: of a bench.
        real: its boards that are hardware, with commas between.
        arm: coils may be driven on it.
        at_rest: a log is of a bench: the satellite did not move.
        rounds: pulses of each polarity; None: 1.
        field_nt: field around the bench, body axes.
        offset_nt: largest offset of the magnetometer, by axis; None: 1000.
        coil_field_nt_per_am2: field of each coil at the magnetometer, along its axis; None: the table's.
        seed: of the plant; None: 1.
        out: folder in which the run is kept.
    """

    scenario: str | None = None
    settings: Nested = field(default_factory=dict)
    bus: str | None = None
    real: str | None = None
    arm: bool = False
    at_rest: bool = False
    rounds: int | None = None
    field_nt: tuple[float, float, float] | None = None
    offset_nt: float | None = None
    coil_field_nt_per_am2: float | None = None
    seed: int | None = None
    out: Path | None = None

    @property
    def premises(self) -> PhasingPremises:
        """What phasing may presume."""
        along, around = self.coil_field_nt_per_am2, self.field_nt
        return PhasingPremises(
            None if along is None else along * np.eye(3),
            None if around is None else np.array(around),
            OFFSET_NT if self.offset_nt is None else self.offset_nt,
            in_orbit=not self.at_rest and self.bus is None,
        )

    def refuse(self, names: Iterable[str], why: str) -> None:
        """Refuse options that would do nothing.

        Raises:
            HarnessError: one of them is given.
        """
        of = set(names)
        refuse({f"--{OPTIONS.get(name, name).replace('_', '-')}": name in of for name in _given(self)}, why)


def _given(options: PhasingOptions) -> Iterator[str]:
    """The names of those that are given."""
    for one in fields(options):
        value = getattr(options, one.name)
        if value is not None and value is not False and value != {}:
            yield one.name


def is_scenario(source: str) -> bool:
    """Whether what phasing is to judge is a scenario, and no recording or log."""
    path = Path(source)
    return not is_bench_log(path) and (path.suffix == ".toml" or not path.exists())


def phase(source: str | Scenario, options: PhasingOptions) -> CommissioningReport:
    """Tell the wiring of a scenario, in simulation or on a bench, or in a run, log or bench recording.

    Raises:
        HarnessError: an option that would do nothing, or no log, bench or scenario of that kind.
        TableError: the scenario is not valid.
        BusError: the bus cannot be used.
    """
    if isinstance(source, str) and is_bench_log(Path(source)):
        why = f"{source} is a recorded bench log, which is judged by itself"
        options.refuse((*OF_A_FLIGHT, *OF_A_LOG), why)
        return of_csv(Path(source))
    if isinstance(source, str) and not is_scenario(source):
        options.refuse(OF_A_FLIGHT, "a log is judged as it is; name a SCENARIO to fly or for a bench")
        return of_log(Path(source), options.scenario, options.settings, options.premises)
    if options.scenario is not None:
        raise HarnessError(f"--scenario: {source} is no log, but a scenario itself")
    if options.bus is None:
        options.refuse(OF_A_BENCH, "without --bus the SCENARIO is flown in simulation")
    chosen, rounds, seed = load(source, options.settings), options.rounds or 1, options.seed
    seed = 1 if seed is None else seed
    if options.bus is None:
        return of_flight(chosen, rounds, seed, options.premises, options.out)
    bench = BenchSetUp(options.bus, real_boards(options.real), options.arm)
    return on_bench(chosen, rounds, seed, options.premises, bench, options.out)


def of_csv(path: Path) -> CommissioningReport:
    """The responses in a recorded bench log, which tells no axis; ok where one is clear."""
    responses = bench_responses(read_recording(path))
    lines = tuple(in_lines(bench_words.lines(responses)))
    return CommissioningReport(
        lines, bench_words.as_json(responses), any(one.latest_s() for one in responses)
    )


def of_log(
    run_or_log: Path, scenario: str | None, settings: Nested, premises: PhasingPremises
) -> CommissioningReport:
    """Judge a log; the scenario is that beside it, unless one is named.

    Raises:
        HarnessError: no such log, or no scenario for it.
        TableError: the scenario is not valid.
    """
    log, folder = run_dir.locate(run_or_log)
    return _judge(log, flight_table(run_dir.scenario_of_log(log, folder, scenario, settings)), premises)


def of_flight(
    scenario: Scenario, rounds: int, seed: int, premises: PhasingPremises, out: Path | None
) -> CommissioningReport:
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
        return _judge(folder / run_dir.BUS_LOG, flight_table(flown), premises)


def on_bench(
    scenario: Scenario,
    rounds: int,
    seed: int,
    premises: PhasingPremises,
    bench: BenchSetUp,
    out: Path | None,
) -> CommissioningReport:
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
        found = _judge(folder / run_dir.BUS_LOG, flight_table(flown), premises)
        return replace(found, ok=found.ok and not code)


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


def _judge(log: Path, table: FlightTable, premises: PhasingPremises) -> CommissioningReport:
    """The verdict; ok where the wiring is determined, and is the table's."""
    detail(f"phasing from {log}")
    samples = read_samples(log, table.time.tick_hz)
    try:
        found = phasing(samples, table, _with_table(premises, table))
    except HarnessError as error:
        raise HarnessError(f"{log}: {error}") from None
    ok = found.wiring is not None and found.wiring == words.of_table(table)
    lines = (*in_lines(words.lines(found, table)), ReportLine(words.verdict(found, table), failed=not ok))
    return CommissioningReport(lines, words.as_json(found, table), ok)


def _with_table(premises: PhasingPremises, table: FlightTable) -> PhasingPremises:
    """With the coils' field by true dipole, where the table has it by output."""
    coils = table.calibration.coils
    if premises.coil_field_nt_per_am2 is not None or coils is None or coils.field_nt_per_am2 is None:
        return premises
    by_output = np.array(coils.field_nt_per_am2)
    dipoles = np.eye(3) if coils.matrix is None else np.array(coils.matrix)
    return PhasingPremises(
        by_output @ np.linalg.inv(dipoles),
        premises.field_around_nt,
        premises.offset_nt,
        premises.in_orbit,
    )


@contextmanager
def _folder(kept: Path | None) -> Iterator[Path]:
    """The folder that is kept, or a temporary one."""
    if kept is not None:
        check_folder(kept)
        yield kept
        return
    with TemporaryDirectory() as folder:
        yield Path(folder) / "run"
