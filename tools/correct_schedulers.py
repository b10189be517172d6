"""Schedulers that keep the limits, as users might write them: by what ``sim.testing`` offers alone."""

from collections.abc import Sequence
from math import ceil

from sim.testing import Fire, Heard, Limits, ShippedScheduler
from sim.value_types import Vec3


class Timers:
    """timers of its own; of the board it uses only the boots"""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.pulse = limits.pulse_ms * limits.tick_hz // 1000
        self.backoff = ceil(limits.backoff_ms * limits.tick_hz / 1000)
        self.ready: list[int] = []
        self.busy_until = self.fired = 0

    def step(self, heard: Heard) -> Sequence[Fire]:
        if not self.ready or heard.booted:
            self.ready, self.busy_until = [heard.tick + self.boot_ticks()] * 3, heard.tick
        demand = heard.m_body_am2
        coil = self.coil(demand)
        if not any(demand) or not self.free(coil, heard):
            return []
        self.fired += 1
        level = self.level(demand[coil])
        self.busy_until = heard.tick + self.pulse_ticks(coil)
        again = self.busy_until + self.backoff_ticks(level)
        for one in range(3):
            if self.locks(coil, one):
                self.ready[one] = again
        return [Fire(one, level, self.duration_ms(coil)) for one in self.fires(coil, demand)]

    def boot_ticks(self) -> int:
        """A pulse may be under way when it boots."""
        return self.pulse + self.backoff

    def coil(self, demand: Vec3) -> int:
        return max(range(3), key=lambda axis: abs(demand[axis]))

    def free(self, coil: int, heard: Heard) -> bool:
        return heard.tick >= max(self.ready[coil], self.busy_until)

    def level(self, m_am2: float) -> int:
        return 3 if m_am2 > 0.0 else -3

    def pulse_ticks(self, coil: int) -> int:
        return self.pulse

    def duration_ms(self, coil: int) -> int:
        return self.pulse_ticks(coil) * 1000 // self.limits.tick_hz

    def backoff_ticks(self, level: int) -> int:
        return self.backoff

    def locks(self, fired: int, coil: int) -> bool:
        return self.limits.shared or coil == fired

    def fires(self, coil: int, demand: Vec3) -> list[int]:
        return [coil]


class ByTheBoard(Timers):
    """timers, and the lockout that the board reports"""

    def boot_ticks(self) -> int:
        return self.backoff

    def free(self, coil: int, heard: Heard) -> bool:
        status = heard.status
        reported_free = status is not None and status.coil == coil and status.lockout_ms == 0
        return reported_free and super().free(coil, heard)


class ByMilliseconds:
    """levels and durations by the demand, all times in parts of a tick"""

    def __init__(self, limits: Limits) -> None:
        self.limits, self.end = limits, 0
        self.ready: list[int] = []

    def step(self, heard: Heard) -> Sequence[Fire]:
        hz, limits = self.limits.tick_hz, self.limits
        now = heard.tick * 1000
        if not self.ready or heard.booted:
            self.end = now
            self.ready = [now + (limits.pulse_ms + limits.backoff_ms) * hz] * 3
        size, coil = max((abs(m), axis) for axis, m in enumerate(heard.m_body_am2))
        if size < 0.1 or now < max(self.ready[coil], self.end):
            return []
        level = 1 + (size > 1.0) + (size > 4.0)
        wanted_ms = round(min(1.0, size / 8.0) * limits.pulse_ms)
        duration_ms = max(ceil(1000 / hz), wanted_ms)  # no status can show less than a tick
        self.end = now + duration_ms * hz
        for one in range(3):
            if limits.shared or one == coil:
                self.ready[one] = self.end + limits.backoff_ms * hz
        return [Fire(coil, level if heard.m_body_am2[coil] > 0.0 else -level, duration_ms)]


CORRECT = (Timers, ByTheBoard, ByMilliseconds, ShippedScheduler)
