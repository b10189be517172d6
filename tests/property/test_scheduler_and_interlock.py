"""Whatever is lost, repeated or late and whoever restarts: the limits hold, and what is demanded is fired."""

from collections import Counter

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    precondition,
    rule,
    run_state_machine_as_test,
)

from fsw.wire.messages import CoilRefusedReason as Reason
from fsw.wire.messages import Mode

RATES = (1, 2, 3, 7, 10, 50)
MOST_HZ = 64
TIMINGS_MS = ((3000, 100_000), (3000, 10_000), (2900, 7301), (2000, 4000))
"""Pulse and back-off: as flown; and short ones, that are not whole ticks at every rate."""

WHO = st.sampled_from(("flight", "board", "both"))
FATES = st.sampled_from(("whole",) * 6 + ("lost", "twice", "damaged", "late"))
DIPOLES_AM2 = st.tuples(*[st.floats(-50.0, 50.0)] * 3)
FIELDS_T = st.tuples(*[st.floats(-5e-5, 5e-5)] * 3)
NO_DEMAND = ((0.0, 0.0, 0.0), (1e-5, 2e-5, 3e-5))
SEEN = Counter()


def machine(bench_with, only):
    """The machine over benches that are made so."""
    demands = st.one_of(
        st.just(NO_DEMAND),
        st.builds(only, st.integers(0, 2), st.sampled_from((-1.0, 1.0))),
        st.tuples(DIPOLES_AM2, FIELDS_T),
    )
    ticks_with_fates = st.lists(st.tuples(demands, FATES, FATES), min_size=1, max_size=6)

    class SchedulerAndCoilDriver(RuleBasedStateMachine):
        """Random demands, fates of messages, missed ticks and restarts of either side."""

        @initialize(
            tick_hz=st.one_of(st.sampled_from(RATES), st.integers(1, MOST_HZ)),
            shared=st.booleans(),
            timing_ms=st.sampled_from(TIMINGS_MS),
            first_tick=st.integers(0, 1000),
        )
        def switch_on(self, tick_hz, shared, timing_ms, first_tick):
            self.bench = bench_with(tick_hz, shared, timing_ms, first_tick)

        def teardown(self):
            if hasattr(self, "bench"):
                SEEN["pulses"] += len(self.bench.judge.starts)
                SEEN[f"{self.bench.limits.tick_hz} Hz"] += 1
                SEEN.update(self.bench.refused)

        @rule(ticks=ticks_with_fates)
        def run(self, ticks):
            for demand, status_fate, fire_fate in ticks:
                self.bench.step(demand, status_fate, fire_fate)

        @rule(ticks=ticks_with_fates, before=st.integers(0, 4))
        def run_when_the_back_off_is_nearly_over(self, ticks, before):
            judge = self.bench.judge
            free = (max(judge.ended.values(), default=0) + judge.backoff) * judge.tick_hz
            self.bench.jump(max(0, int(free) - before - self.bench.tick))
            self.run(ticks)

        @rule(demand=demands, back=st.integers(1, 4))
        def replay_old_requests(self, demand, back):
            self.bench.step(demand, replayed=self.bench.asked[-back:])

        @rule(back=st.integers(1, 4))
        def replay_an_old_request_when_its_tick_byte_comes_again(self, back):
            for frame in self.bench.asked[-back:][:1]:
                self.bench.jump((frame.data[3] - self.bench.tick - 1) % 256)
                SEEN["old requests that answer the tick"] += 1
                self.bench.step(NO_DEMAND, replayed=[frame])

        @rule(demand=demands)
        def safe(self, demand):
            asked = len(self.bench.asked)
            for _ in range(3):
                self.bench.step(demand, mode=Mode.SAFE)
            assert len(self.bench.asked) == asked

        @rule(ticks=st.one_of(st.integers(1, 12), st.integers(1, 1000)))
        def nobody_sees_some_ticks(self, ticks):
            self.bench.jump(ticks)

        @rule(ticks=st.integers(1, 5))
        def flight_software_misses_ticks(self, ticks):
            for _ in range(ticks):
                self.bench.board_alone()

        @rule(missed=st.lists(demands, min_size=1, max_size=5))
        def board_misses_ticks(self, missed):
            for demand in missed:
                self.bench.flight_alone(demand)

        @rule(who=WHO)
        def restart(self, who):
            SEEN[f"restart of {who} in a pulse"] += self.bench.judge.on is not None
            if who != "board":
                self.bench.restart_flight()
            if who != "flight":
                self.bench.restart_board()

        @precondition(lambda self: self.bench.judge.on is not None)
        @rule(who=WHO)
        def restart_in_a_pulse(self, who):
            self.restart(who)

        @rule(coil=st.integers(0, 2))
        def persist(self, coil):
            """Once messages arrive a demand is met: a pulse, a back-off, and the word on its coil."""
            config = self.bench.config
            for _ in range(config.pulse_ticks + config.backoff_ticks + 3):
                if self.bench.step(only(coil)) == coil:
                    SEEN["persisted"] += 1
                    return
            raise AssertionError(f"coil {coil} did not fire")

    return SchedulerAndCoilDriver


@pytest.mark.long
@pytest.mark.slow
def test_whatever_happens_the_limits_hold_and_what_is_demanded_on_and_on_is_fired(bench_with, only):
    SEEN.clear()
    run_state_machine_as_test(
        machine(bench_with, only),
        settings=settings(
            max_examples=400,
            stateful_step_count=30,
            suppress_health_check=list(HealthCheck),
            derandomize=True,  # what is counted below is the same each time
        ),
    )
    assert SEEN["pulses"] > 300, f"it fired: {SEEN}"
    needed = (Reason.LOCKOUT, Reason.COIL_ON, Reason.WRONG_TICK, Reason.REPEATED_SEQ)
    assert all(SEEN[reason] for reason in needed), f"the interlock was needed: {SEEN}"
    assert all(SEEN[f"restart of {who} in a pulse"] for who in ("flight", "board", "both")), SEEN
    assert SEEN["persisted"] > 30, SEEN
    assert sum(name.endswith(" Hz") for name in SEEN if isinstance(name, str)) > 20, f"rates: {SEEN}"
    assert SEEN["old requests that answer the tick"] > 10, SEEN
