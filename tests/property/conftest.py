"""The scheduler and the coil driver on a bench, joined by encoded frames, with a judge of what is driven.

The judge is an onlooker with a stopwatch. It is given what ``drive`` returned in each tick, and nothing else.
"""

from collections import Counter
from fractions import Fraction
from typing import NamedTuple

import pytest

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate, update_view
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.gate.calibration import NO_CALIBRATION, measure
from fsw.core.gate.readings import GateState, admit
from fsw.core.laws.interface import Demand as Asked
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilRefused, CoilStatus, Mode
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits

FLOWN_MS = (3000, 100_000)
"""Pulse and back-off."""

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Demand(NamedTuple):
    """What the control law asks for in a tick, and in which field."""

    m_body_am2: tuple[float, float, float]
    b_body_t: tuple[float, float, float]


def only_by(coil, sign=1.0):
    """A demand so strong that it counts alone, in a field in which no other coil helps."""
    m_body_am2, b_body_t = [0.0] * 3, [0.0] * 3
    m_body_am2[coil], b_body_t[(coil + 1) % 3] = sign * 1e6, 3e-5
    return Demand(tuple(m_body_am2), tuple(b_body_t))


class Judge:
    """Invariant I on what is driven, in exact seconds."""

    def __init__(self, tick_hz, shared, pulse_ms, backoff_ms):
        self.tick_hz, self.shared = tick_hz, shared
        self.longest, self.backoff = Fraction(pulse_ms, 1000), Fraction(backoff_ms, 1000)
        self.on = None  # coil, level, start
        self.until = None  # driven until then
        self.ended = {}
        self.starts = []

    def watch(self, tick, drive):
        """The drive over the tick that begins at ``tick``."""
        now = Fraction(tick, self.tick_hz)
        if drive.level == 0:
            self.finish()
            return
        assert drive.level in {-3, -2, -1, 1, 2, 3}
        assert drive.coil in {0, 1, 2}
        assert 0 < drive.fraction <= 1
        if self.on is None or self.on[:2] != (drive.coil, drive.level) or self.until != now:
            self.finish()
            ends = [end for coil, end in self.ended.items() if self.shared or coil == drive.coil]
            assert all(now - end >= self.backoff for end in ends), f"only {now - max(ends)} s between pulses"
            self.on = (drive.coil, drive.level, now)
            self.starts.append((tick, drive.coil))
        self.until = now + Fraction(round(drive.fraction * 1000), 1000 * self.tick_hz)
        assert self.until - self.on[2] <= self.longest, "a pulse too long"

    def miss(self, tick, asked_ms):
        """Ticks up to ``tick`` were not seen: a pulse may have gone on for as long as was asked."""
        if self.on is not None:
            end = min(self.on[2] + Fraction(asked_ms, 1000), Fraction(tick, self.tick_hz))
            self.until = max(self.until, end)

    def finish(self):
        if self.on is not None:
            self.ended[self.on[0]] = self.until
            self.on = None


class Flight:
    """The scheduler as it flies: frames in, at most one frame out."""

    def __init__(self, config):
        self.config = ActuatorConfig(config, dipoles=None)
        self.gate, self.view, self.sent = GateState(), CoilView(), 0
        self.state = None

    def step(self, tick, frames, demand, mode=Mode.POINT):
        if self.state is None:
            self.state = pulses.boot(tick, self.config.pulses)
        readings = measure(admit(tuple(frames), self.gate), NO_CALIBRATION)
        update_view(self.view, readings, tick, self.config)
        m_body_am2, b_body_t = demand
        asked = Asked(m_body_am2) if mode is not Mode.SAFE else None
        request = actuate(self.state, self.view, asked, b_body_t, readings, tick, self.config)
        if request is None:
            return []
        self.sent += 1
        return [request.replace(counter=self.sent & 0xF).encode()]


class Bench:
    """Both sides, the frames between them, and the judge. Each tick the board speaks first."""

    def __init__(self, tick_hz, shared, timing_ms=FLOWN_MS, first_tick=0):
        pulse_ticks, backoff_ticks, duration_ms = pulses.pulse_timing(tick_hz, *timing_ms)
        self.config = PulseConfig(
            pulse_ticks=pulse_ticks,
            backoff_ticks=backoff_ticks,
            duration_ms=duration_ms,
            shared=shared,
            levels_am2=(0.5, 2.0, 8.0),
            pulse_s=duration_ms / 1000.0,
            tick_s=1.0 / tick_hz,
            leak_s=300.0,
            rate_metric=IDENTITY,
            energy_metric=IDENTITY,
        )
        self.limits = CoilLimits(tick_hz, *timing_ms, shared)
        self.judge = Judge(tick_hz, shared, *timing_ms)
        self.tick = first_tick - 1
        self.asked = []  # every request ever sent
        self.late = {"status": [], "fire": []}
        self.refused = Counter()
        self.restart_flight()
        self.restart_board()

    def restart_flight(self):
        self.flight = Flight(self.config)

    def restart_board(self):
        self.board = CoilDriver(self.limits)

    def step(self, demand, status_fate="whole", fire_fate="whole", mode=Mode.POINT, replayed=()):
        """One tick; the coil that begins to be driven in it, or None."""
        self.tick += 1
        said = self.board.begin_tick(self.tick, 0.0)
        self.refused.update(CoilRefused.decode(f.data).reason for f in said if f.can_id == CoilRefused.ID)
        others = [frame for frame in said if frame.can_id != CoilStatus.ID]
        status = [frame for frame in said if frame.can_id == CoilStatus.ID]
        assert len(status) == 1
        self.status = CoilStatus.decode(status[0].data)
        heard = others + self._fare(status, status_fate, "status")
        fires = self.flight.step(self.tick, heard, demand, mode)
        self.asked += fires
        for frame in (*self._fare(fires, fire_fate, "fire"), *replayed):
            self.board.receive(frame)
        return self.look()

    def look(self):
        pulses_before = len(self.judge.starts)
        self.judge.watch(self.tick, self.board.drive())
        return self.judge.starts[-1][1] if len(self.judge.starts) > pulses_before else None

    def jump(self, ticks):
        """Neither side sees these ticks."""
        self.tick += ticks
        self.judge.miss(self.tick + 1, self.config.duration_ms)

    def board_alone(self):
        """A tick that the flight software misses: nothing of it reaches it."""
        self.tick += 1
        self.board.begin_tick(self.tick, 0.0)
        return self.look()

    def flight_alone(self, demand):
        """A tick that the board misses; a request in it comes when the board is in another."""
        self.tick += 1
        self.late["fire"] += self.flight.step(self.tick, [], demand)
        self.judge.miss(self.tick + 1, self.config.duration_ms)

    def _fare(self, frames, fate, kind):
        """What comes through of frames, and of those that were held up in the tick before."""
        late, self.late[kind] = self.late[kind], frames if fate == "late" else []
        through = {"whole": frames, "twice": frames * 2, "damaged": [damaged(frame) for frame in frames]}
        return [*through.get(fate, []), *late]


def damaged(frame):
    return Frame(frame.can_id, bytes((frame.data[0] ^ 0x20, *frame.data[1:])))


@pytest.fixture(scope="session")
def bench_with():
    """Makes a bench from ticks a second, kind of back-off, (pulse, back-off) in ms and first tick."""
    return Bench


@pytest.fixture(scope="session")
def only():
    """Makes a demand that one coil alone can meet."""
    return only_by
