"""A scheduler of your own, tested against the limits: run by ``pytest examples``.

It fires the coil with the largest demand, and waits: for a back-off after its own boot and after the boot of
the board, and for a COIL_STATUS of the coil without lockout.
"""

from hypothesis import given, settings

from sim.testing import Fire, audit_scheduler, flights


class MyScheduler:
    """One coil at a time, the strongest level, whatever the field."""

    def __init__(self, limits):
        self.pulse = limits.pulse_ms * limits.tick_hz // 1000  # ticks, rounded down
        self.backoff = -(-limits.backoff_ms * limits.tick_hz // 1000)  # ticks, rounded up
        self.duration_ms = self.pulse * 1000 // limits.tick_hz
        self.ready = None

    def step(self, heard):
        if self.ready is None or heard.booted:
            self.ready = heard.tick + self.backoff
        size, coil = max((abs(m), axis) for axis, m in enumerate(heard.m_body_am2))
        status = heard.status
        if size == 0.0 or heard.tick < self.ready:
            return []
        if status is None or status.coil != coil or status.lockout_ms:
            return []
        self.ready = heard.tick + self.pulse + self.backoff
        return [Fire(coil, 3 if heard.m_body_am2[coil] > 0.0 else -3, self.duration_ms)]


@settings(deadline=None)
@given(flights())
def test_my_scheduler_keeps_the_limits(flight):
    report = audit_scheduler(MyScheduler, flight)
    assert report.ok, "\n".join(map(str, report.violations))
