"""Short flights in one process, with nothing zero and no two axes alike."""

from collections.abc import Collection
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from math import ceil
from pathlib import Path
from typing import NamedTuple

import pytest

from fsw.input.schema import merge
from fsw.table.config import flight_config
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilBoot, CoilStatus, MagField, PlantEnd, Sync
from sim.audit.auditor import AuditLimits, AuditReport, audit
from sim.campaign.claim import Claim, Study
from sim.fault_rig.rig import Rig
from sim.fault_table.case import prepare
from sim.fault_table.checks import bounds_of
from sim.flight import virtual
from sim.record import run_dir
from sim.record.candump import LogEntry, read_log
from sim.record.pace import Pace
from sim.scenario.schema import flight_table, load, parse_settings

UNEVEN = parse_settings(
    (
        "body.inertia_kgm2=[[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]",
        "initial.axis=[0.5, -0.7, 0.4]",
        "initial.rate_degps=[0.05, -0.07, 0.04]",
        "sensors.magnetometer.bias_nt=[150.0, -250.0, 100.0]",
        "disturbance.torque_nm=[3e-8, -2e-8, 1e-8]",
        "disturbance.residual_dipole_am2=[0.003, 0.002, -0.004]",
        "flight.modes.settle_s=20.0",
    )
)


@pytest.fixture(scope="session")
def fly_run(tmp_path_factory):
    """Flies a run on the virtual bus; keywords are settings laid over the scenario. Returns its directory."""

    def fly(ticks=300, seed=5, scenario="microsat", **overrides):
        path = tmp_path_factory.mktemp("runs") / "run"
        flown = load(scenario, merge(UNEVEN, overrides))
        run_dir.begin(path, flown, seed, ticks, "virtual", Pace())
        virtual.fly_virtual(path, flown, lambda tick: None)
        return path

    return fly


@pytest.fixture(scope="session")
def recorded_run(fly_run):
    """A run of 300 ticks, two pulses in it. Not to be changed: copy what is to be broken."""
    return fly_run()


@pytest.fixture(scope="session")
def config_of():
    """The flight config of a run directory."""
    return lambda path: flight_config(flight_table(run_dir.read_scenario(path)))


EPOCH_S = 1_427_513_417


class Fired(NamedTuple):
    """A pulse that the board drives from tick ``start`` on."""

    coil: int
    start: int
    duration_ms: int = 3000
    level: int = 1


@dataclass
class BusLog:
    """A log as the plant writes it, of a board that drives whatever it is told."""

    tick_hz: int = 1
    ticks: int = 400
    pulses: list[Fired] = field(default_factory=list)
    boots: list[int] = field(default_factory=list)
    epoch_s: int = EPOCH_S
    sync: bool = True
    end: bool = True
    shifts_us: dict[int, int] = field(default_factory=dict)
    """Added to the timestamps of all frames of a tick."""
    late: Collection[int] = ()
    """Ticks in which the board comes after SYNC, as may happen in real time."""
    statuses: dict[int, list[Frame]] = field(init=False)

    def __post_init__(self) -> None:
        self.statuses = {tick: [self._status(tick).encode()] for tick in range(self.ticks)}

    def _status(self, tick: int) -> CoilStatus:
        now = Fraction(tick, self.tick_hz)
        for seq, (coil, start, duration_ms, level) in enumerate(self.pulses, start=1):
            end = Fraction(start, self.tick_hz) + Fraction(duration_ms, 1000)
            if start < tick and now - end < Fraction(1, self.tick_hz):
                remaining_ms = ceil(max(end - now, 0) * 1000)
                return CoilStatus(level, coil, remaining_ms, 0, 0, seq & 0xFF, tick & 0xF)
        last_seq = sum(pulse.start < tick for pulse in self.pulses) & 0xFF
        return CoilStatus(0, tick % 3, 0, 0, 0, last_seq, tick & 0xF)

    def change(self, tick: int, **values: int) -> None:
        """The tick's status with other values, sealed anew."""
        status = CoilStatus.decode(self.statuses[tick][0].data)
        self.statuses[tick][0] = status.replace(**values).encode()

    def frames(self, tick: int) -> list[Frame]:
        """All frames of a tick, in their order."""
        boot = [CoilBoot(0, 1, 0).encode()] if tick in self.boots else []
        field = MagField(1, 20000.0, -7000.0, 31000.0, tick & 0xF).encode()
        sync = [Sync(tick, self.epoch_s + tick // self.tick_hz).encode()] if self.sync else []
        board = boot + self.statuses[tick]
        return [field, *sync, *board] if tick in self.late else [*board, field, *sync]

    def timestamp_us(self, tick: int) -> int:
        """Simulated time, rounded down to microseconds."""
        return (self.epoch_s * self.tick_hz + tick) * 1_000_000 // self.tick_hz + self.shifts_us.get(tick, 0)

    def text(self) -> str:
        """The log."""
        lines = []
        for tick in range(self.ticks):
            stamp = format_time(self.timestamp_us(tick))
            lines += [format_line(stamp, "vcan0", frame) for frame in self.frames(tick)]
        if self.end:
            lines.append(format_line(stamp, "vcan0", PlantEnd(self.ticks).encode()))
        return "".join(lines)

    def entries(self, first: int = 0, without_sync: Collection[int] = ()) -> list[LogEntry]:
        """What a recorder keeps that listens from tick ``first`` on and loses some SYNC."""
        kept = [
            (self.timestamp_us(tick), frame)
            for tick in range(first, self.ticks)
            for frame in self.frames(tick)
            if frame.can_id != Sync.ID or tick not in without_sync
        ]
        return [LogEntry(line, time_us, "vcan0", frame) for line, (time_us, frame) in enumerate(kept, 1)]

    def write(self, path: Path) -> Path:
        """The log as a file."""
        path.write_text(self.text())
        return path


@pytest.fixture
def judge(tmp_path):
    """Audits a BusLog through the file that it makes."""

    def judge_log(log: BusLog, **limits: object) -> AuditReport:
        return audit(read_log(log.write(tmp_path / "bus.log")), AuditLimits(**limits))

    return judge_log


@pytest.fixture
def bus_log() -> type[BusLog]:
    """Makes synthetic logs."""
    return BusLog


@pytest.fixture
def fired() -> type[Fired]:
    """Makes their pulses."""
    return Fired


@pytest.fixture
def bounds():
    """What flights of the default scenario are judged by."""
    return bounds_of(prepare()[0])


@pytest.fixture
def rig():
    """Makes a rig of the default scenario, with settings laid over it."""

    def make(*settings, seed=1):
        return Rig(*prepare(settings), seed)

    return make


@pytest.fixture
def flown(rig):
    """Flies so many ticks under one fault: the record."""

    def fly(fault, ticks, first=0, end=None, settings=()):
        bench = rig(*settings)
        bench.inject(fault, first, end)
        for _ in range(ticks):
            bench.tick()
        return bench.finish()

    return fly


@pytest.fixture(scope="session")
def study():
    """Makes a study of one claim: the sum of its values is at most ``limit``."""

    def make(study_id, values, has_flights=False, limit=10.0):
        claim = Claim(study_id, f"sum of {study_id}", "arithmetic", "1", high=limit)
        tasks = tuple(partial(float, value) for value in values)
        return Study(
            study_id, tasks, lambda results: [claim.judge(sum(results), f"of {results}")], has_flights
        )

    return make
