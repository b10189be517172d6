"""A flight as the charts of the report draw it: lines and spans over time, and the pulses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from fsw.table.config import flight_config
from fsw.wire.messages import Mode
from sim.audit.auditor import AuditReport
from sim.audit.check import limits_beside
from sim.audit.findings import COILS, AuditLimits, DrivenPulse
from sim.drawing.canvas import Span, TimeAxis
from sim.faults.section import forge_answers
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.estimates import EstimateRecorder
from sim.record.truth import TruthReader
from sim.replay.log_replay import replay
from sim.report.charts.lines import Lines
from sim.report.figures.histories import HistoryBlocks
from sim.report.figures.performance import BLOCK_TICKS
from sim.report.flight_audit import audit_flight
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.value_types import Array


def whole_flight(length_s: float, orbit_s: float, eclipses: tuple[Span, ...]) -> TimeAxis:
    """The time axis of a whole flight, in orbits; of a short one in minutes or seconds."""
    if length_s < 0.75 * orbit_s:
        return window(0.0, length_s, eclipses)
    return TimeAxis(f"orbits of {orbit_s / 60.0:.1f} min", orbit_s, 0.0, length_s, eclipses)


def window(start_s: float, length_s: float, eclipses: tuple[Span, ...]) -> TimeAxis:
    """A part of a flight, in minutes or seconds."""
    label, unit_s = ("minutes", 60.0) if length_s >= 300.0 else ("seconds", 1.0)
    shown = tuple(span for span in eclipses if span[1] > start_s and span[0] < start_s + length_s)
    return TimeAxis(f"{label} from the start", unit_s, start_s, start_s + length_s, shown)


@dataclass(frozen=True, slots=True)
class DrawnFlight:
    """A flight of at least one tick, as it is drawn.

    Attributes:
        lines: quantities over time.
        audit: pulses, violations and the limits.
        tick_hz: ticks a second.
        orbit_s: period of the orbit.
        start_unix_s: UTC of tick 0.
        wheel_nms: largest momentum of a driven wheel relative to the body; None: there is none.
    """

    lines: Lines
    audit: AuditReport
    tick_hz: int
    orbit_s: float
    start_unix_s: int
    wheel_nms: float | None

    @classmethod
    def of(cls, scenario: Scenario, lines: Lines, audit: AuditReport) -> "DrawnFlight":
        """That of a scenario."""
        most_nms = scenario.wheel.max_momentum_nms if scenario.wheel else None
        return cls(
            lines, audit, scenario.time.tick_hz, orbit_period_s(scenario), scenario.epoch_unix_s, most_nms
        )

    @property
    def length_s(self) -> float:
        """How long the flight lasted."""
        return self.lines.ticks / self.tick_hz

    @property
    def time(self) -> TimeAxis:
        """The whole flight."""
        return whole_flight(self.length_s, self.orbit_s, self._spans(self.lines.dark.spans))

    def window(self, start_s: float, length_s: float) -> TimeAxis:
        """A part of it."""
        return window(start_s, length_s, self._spans(self.lines.dark.spans))

    def in_mode(self, mode: Mode) -> tuple[Span, ...]:
        """When the controller was in a mode."""
        return self._spans(self.lines.modes[mode].spans)

    def _spans(self, ticks: Sequence[tuple[int, int]]) -> tuple[Span, ...]:
        return tuple((first / self.tick_hz, past / self.tick_hz) for first, past in ticks)

    @property
    def t_s(self) -> Array:
        """Time of each point of a line."""
        return self.lines.places / self.tick_hz

    def line(self, name: str) -> Array:
        """A quantity at each point, (points,), or several of a kind, (points, n)."""
        return self.lines.line(name)

    def duty(self, coil: int, at_s: Array) -> Array:
        """Fraction of the orbit before each time, or of the flight so far, for which a coil was driven."""
        pulses = [pulse for pulse in self.audit.pulses if pulse.coil == coil]
        driven_s = _driven_s(pulses, at_s) - _driven_s(pulses, at_s - self.orbit_s)
        result: Array = driven_s / np.clip(at_s, 1.0 / self.tick_hz, self.orbit_s)
        return result

    def most_duty(self, at_s: Array) -> Array:
        """The most that ``duty`` of each coil, or of all that share a back-off, can be at each time."""
        window_s = np.clip(at_s, 1.0 / self.tick_hz, self.orbit_s)
        return np.array([self.audit.limits.most_duty(float(one)) for one in window_s])

    def gaps_s(self) -> Array:
        """The gaps that the back-off limits: between any pulses, or between those of one coil."""
        groups = [COILS] if self.audit.limits.shared else [(coil,) for coil in COILS]
        gaps = []
        for group in groups:
            pulses = [pulse for pulse in self.audit.pulses if pulse.coil in group]
            gaps += [float(later.start_s - sooner.end_s) for sooner, later in pairwise(pulses)]
        return np.array(gaps)

    def busiest(self, length_s: float) -> float:
        """Start [s] of the first window of this length that holds the most pulses."""
        starts = np.array([float(pulse.start_s) for pulse in self.audit.pulses])
        if self.length_s <= length_s or len(starts) == 0:
            return 0.0
        counts = np.searchsorted(starts, starts + 0.9 * length_s) - np.arange(len(starts))
        begin = float(starts[int(np.argmax(counts))]) - 0.05 * length_s
        return min(max(begin, 0.0), self.length_s - length_s)


def _driven_s(pulses: Sequence[DrivenPulse], at_s: Array) -> Array:
    """Seconds driven until each time, by pulses of one coil in order."""
    if not pulses:
        return np.zeros_like(at_s)
    edges = np.array([(float(pulse.start_s), float(pulse.end_s)) for pulse in pulses])
    lengths = edges[:, 1] - edges[:, 0]
    done = np.cumsum(lengths)
    total_s = np.stack((done - lengths, done), axis=1)
    result: Array = np.interp(at_s, edges.ravel(), total_s.ravel())
    return result


# --- A run that was flown before, read to be drawn

Watch = Callable[[int], None]


def flight_as_flown(path: Path, scenario: Scenario) -> DrawnFlight:
    """What the plant's histories and the log tell: nothing that the flight software has estimated.

    Raises:
        HarnessError: log or histories are missing or damaged.
    """
    with TruthReader(path / run_dir.TRUTH) as truth:
        lines = Lines(truth.complete, scenario)
        for first in range(0, truth.complete, BLOCK_TICKS):
            past = min(first + BLOCK_TICKS, truth.complete)
            lines.take(truth.rows(first, past), EstimateRecorder(past - first).estimates())
    return _drawn(path, scenario, lines)


def flight_as_estimated(path: Path, scenario: Scenario, watch: Watch = lambda tick: None) -> DrawnFlight:
    """The same with the estimates of the flight software, by a replay of the log.

    Args:
        path: the run directory.
        scenario: of the run, with a user law that may be executed.
        watch: called with each tick that was replayed.

    Raises:
        HarnessError: log or histories are missing or damaged.
    """
    with TruthReader(path / run_dir.TRUTH) as truth:
        lines = Lines(truth.complete, scenario)
        blocks = HistoryBlocks(truth, lines.take)
        config, forged = flight_config(flight_table(scenario)), forge_answers(scenario.fault)
        replay(run_dir.bus_log(path), config, blocks.take, forged)
        blocks.finish()
    return _drawn(path, scenario, lines)


def _drawn(path: Path, scenario: Scenario, lines: Lines) -> DrawnFlight:
    log = run_dir.bus_log(path)
    limits = limits_beside(log) or AuditLimits()
    return DrawnFlight.of(scenario, lines, audit_flight(read_log(log), limits, scenario))
