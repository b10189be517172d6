"""A bus in simulated time, with one board on it."""

from collections import deque


class SimulatedBus:
    """A bus with one board; waiting makes time pass, and nothing else does."""

    name = "simulated"

    def __init__(self, bench):
        self.bench = bench
        self.now_s = 1000.0
        self.queue = deque(bench.switch_on(now_ms=self.now_ms))

    @property
    def now_ms(self):
        return round(1000.0 * self.now_s)

    def send(self, frames):
        for frame in frames:
            self.queue.extend(self.bench.receive(frame, self.now_ms))

    def receive(self, timeout_s):
        if self.queue:
            return self.queue.popleft()
        self.now_s += timeout_s
        self.bench.watch(self.now_ms)
        return None

    def close(self):
        pass
