"""The auditor under attack: logs by the boards' own code, judged by the true current.

The board has a clock of its own, or is deaf to held and rushed SYNC. Forty logs as a rule; ``make attack``
makes a thousand.
"""

import os
from collections import Counter
from itertools import pairwise
from random import Random

import pytest

from fsw.wire.messages import CoilFire, Sync, TickDone
from hil_stub.bench import Bench, CoilBoard
from hil_stub.coils.coil_driver import CoilLimits
from sim.audit.auditor import AuditLimits, audit
from sim.record.candump import LogEntry

pytestmark = pytest.mark.long

LOGS = int(os.environ.get("TORQUER_ATTACK_LOGS", "40"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))
PULSE_MS, BACKOFF_MS = 3000, 20_000
JITTER_US = 20_000
TOLERANCE_MS = 50 + 2 * JITTER_US // 1000
"""Of the auditor, beyond the jitter of both edges."""
LIMITS = AuditLimits(pulse_us=PULSE_MS * 1000, backoff_us=BACKOFF_MS * 1000)
ATTACKS = (
    "none",
    "hold",
    "rush",
    "repeat",
    "lose",
    "step",
    "cut",
    "join",
    "tenfold",
    "hold and rush",
    "rush and step",
)


class Recorded:
    """A bench in true time, its current, and what a recorder keeps of its bus."""

    def __init__(self, random: Random, tick_hz: int, has_clock: bool) -> None:
        self.random, self.tick_hz = random, tick_hz
        limits = CoilLimits(tick_hz, PULSE_MS, BACKOFF_MS)
        self.deadman_ms = random.choice((5000, 10**9))
        self.bench = Bench(lambda: CoilBoard(limits), self.deadman_ms, has_clock)
        self.has_clock, self.synced_ms = has_clock, 0
        self.now_ms, self.on_ms = 0, None
        self.driven = [(0, 0)]  # after the boot too there is a back-off
        self.entries, self.stamp_us, self.offset_us = [], 0, 1_700_000_000_123_456
        self.answered, self.synced_tick = False, -1
        self.tick, self.seq, self.ready = 0, 0, tick_hz * BACKOFF_MS // 1000 + 1
        self.keep(self.bench.switch_on())

    def wait(self, milliseconds: int) -> None:
        end_ms = self.now_ms + milliseconds
        while True:
            due_ms = self.bench.due_ms()
            self.now_ms = end_ms if due_ms is None else min(end_ms, max(due_ms, self.now_ms))
            self.bench.watch(self.now_ms)
            self.look()
            if self.now_ms == end_ms:
                return

    def look(self) -> None:
        on = self.bench.pin is not None
        if on and self.on_ms is None:
            self.on_ms = self.now_ms
        if not on and self.on_ms is not None and not self.waits_for_sync():
            self.driven.append((self.on_ms, self.now_ms))
            self.on_ms = None

    def waits_for_sync(self) -> bool:
        """A board that counts ticks alone reports an end in advance, and drives until the SYNC."""
        return not self.has_clock and self.answered and self.now_ms - self.synced_ms <= self.deadman_ms

    def send(self, frame, lost=False) -> None:
        self.answered = frame.can_id != Sync.ID
        if not self.answered and self.tick != self.synced_tick:
            self.synced_ms, self.synced_tick = self.now_ms, self.tick
        if not lost:
            self.keep([frame])
        self.keep(self.bench.receive(frame, self.now_ms))
        self.look()

    def keep(self, frames) -> None:
        for frame in frames:
            stamp_us = self.now_ms * 1000 + self.random.randint(-JITTER_US, JITTER_US)
            self.stamp_us = max(self.stamp_us, stamp_us)
            self.entries.append(
                LogEntry(len(self.entries) + 1, self.offset_us + self.stamp_us, "can0", frame)
            )

    def run_tick(self, lasts_ms: int, repeats=0, lost=False) -> None:
        sync = Sync(self.tick, 1_000_000 + self.tick // self.tick_hz).encode()
        self.send(sync, lost)
        answer_ms = min(self.random.randint(1, 8), lasts_ms)
        self.wait(answer_ms)
        if self.tick >= self.ready:
            duration_ms = self.random.choice((PULSE_MS, PULSE_MS, 1500))
            self.seq = self.seq + 1 & 0xFF
            self.send(CoilFire(2, self.random.randrange(3), self.seq, self.tick & 0xFF, duration_ms).encode())
            if self.bench.pin is not None:
                self.ready = self.tick + (PULSE_MS + BACKOFF_MS) * self.tick_hz // 1000
        self.send(TickDone(self.tick, 0).encode())
        left_ms = lasts_ms - answer_ms
        for _ in range(repeats):
            self.wait(left_ms // (repeats + 1))
            left_ms -= left_ms // (repeats + 1)
            self.send(sync)
        self.wait(left_ms)
        self.tick += 1

    def breaks(self, over_ms: int) -> bool:
        """Whether the current breaks a limit by more than ``over_ms``."""
        driven = [*self.driven, *([(self.on_ms, self.now_ms)] if self.on_ms is not None else [])]
        long = any(end - begun > PULSE_MS + over_ms for begun, end in driven)
        gaps = (later[0] - sooner[1] for sooner, later in pairwise(driven))
        return long or any(gap < BACKOFF_MS - over_ms for gap in gaps)


def record(attack: str, has_clock: bool, random: Random) -> Recorded:
    """A log of five back-offs or so under one attack."""
    tick_hz = random.choice((1, 2, 10))
    period_ms = 1000 // tick_hz // (10 if attack == "tenfold" else 1)
    log = Recorded(random, tick_hz, has_clock)
    ticks = 130 * tick_hz
    chosen = set(random.sample(range(5 * tick_hz, ticks), 3))
    in_pulse = random.random() < 0.6
    rushed = range(0)
    held = 0
    while log.tick < ticks:
        tick, lasts_ms = log.tick, period_ms + random.randint(-2, 2)
        if "hold" in attack and (log.on_ms is not None if in_pulse else tick in chosen) and held < 2:
            lasts_ms, held = random.choice((200, 1000, 4000, 10_000)) + period_ms, held + 1
        if "rush" in attack and tick in chosen:
            rushed = range(tick, tick + random.choice((1, 5, 10, 15)) * tick_hz)
        if tick in rushed and log.on_ms is None:
            lasts_ms = max(5, period_ms // 10)
        if "step" in attack and tick in chosen:  # forward in a pulse it cannot be told from a held tick
            steps_s = (-3600, -100, -7) if log.on_ms is not None else (-3600, -100, -7, 5, 100, 3600)
            log.offset_us += random.choice(steps_s) * 1_000_000
        log.run_tick(
            lasts_ms,
            repeats=random.randint(0, 3) if attack == "repeat" else 0,
            lost=attack == "lose" and random.random() < 0.05,
        )
    if attack == "cut":
        log.entries = log.entries[random.randrange(len(log.entries) // 2) :]
    if attack == "join":
        begun, gone = sorted(random.sample(range(len(log.entries)), 2))
        log.entries = log.entries[:begun] + log.entries[gone:]
    return log


def judge_all(count: int, seed: int) -> Counter:
    """How many logs of each kind there were, and what the auditor said of them."""
    found = Counter()
    for number in range(count):
        random = Random(f"{seed}/{number}")
        attack, has_clock = ATTACKS[number % len(ATTACKS)], number // len(ATTACKS) % 2 == 0
        log = record(attack, has_clock, random)
        report = audit(log.entries, LIMITS)
        truth = "broken" if log.breaks(TOLERANCE_MS) else "within the tolerance" if log.breaks(1) else "clean"
        said = {0: "OK", 3: "not judged"}.get(report.exit_code, "doubted")
        if report.violations:
            said = "violated"
        found[truth, said] += 1
        found[f"{attack}, {'clock' if has_clock else 'deaf'}: {truth}", said] += 1
        if (truth, said) in (("broken", "OK"), ("clean", "violated")):
            print(number, attack, has_clock, truth, said, *report.violations[:2], report.doubt)
    return found


@pytest.mark.timeout(7200)
def test_no_log_that_breaks_a_limit_is_ok_and_no_clean_one_is_a_violation(record_property):
    found = judge_all(LOGS, SEED)
    record_property("auditor", {" ".join(kind): number for kind, number in found.items()})
    print()
    for kind, number in sorted(found.items()):
        print(*kind, number)
    assert found["broken", "OK"] == 0
    assert found["clean", "violated"] == 0
    assert found["broken", "violated"] >= LOGS // 40, "violations were planted, and found"
    assert found["clean", "OK"] >= LOGS // 4, "what is clean is not doubted for its own sake"
