"""Without faults the interlock refuses nothing that the scheduler asks, and firing happens when it may."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

RATES = (1, 2, 3, 7, 10, 50)
TIMINGS_MS = ((3000, 100_000), (3000, 10_000), (2900, 7301), (2999, 143), (1000, 1))
NO_DEMAND = ((0.0, 0.0, 0.0), (3e-5, 3e-5, 3e-5))
SHARED_OR_NOT = pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
DEMANDS = st.tuples(st.tuples(*[st.floats(-50.0, 50.0)] * 3), st.tuples(*[st.floats(-5e-5, 5e-5)] * 3))


@pytest.mark.long
@settings(max_examples=60)
@given(
    tick_hz=st.one_of(st.sampled_from(RATES), st.integers(1, 128)),
    shared=st.booleans(),
    timing_ms=st.sampled_from(TIMINGS_MS),
    first_tick=st.integers(0, 1000),
    demands=st.lists(st.tuples(DEMANDS, st.integers(1, 40)), min_size=1, max_size=10),
)
def test_whatever_is_demanded_nothing_is_refused(bench_with, tick_hz, shared, timing_ms, first_tick, demands):
    bench = bench_with(tick_hz, shared, timing_ms, first_tick)
    bench.step(NO_DEMAND)
    bench.jump(max(0, bench.config.backoff_ticks - 5))
    for demand, ticks in demands:
        for _ in range(ticks):
            bench.step(demand)
    bench.step(NO_DEMAND)
    assert not bench.refused
    assert len(bench.asked) == len(bench.judge.starts), "what was asked was driven"


@pytest.mark.parametrize("tick_hz", RATES)
@SHARED_OR_NOT
def test_both_clocks_agree_to_the_tick(bench_with, only, tick_hz, shared):
    """The board's word on a coil is zero exactly when the scheduler's own timer for it has run out."""
    bench = bench_with(tick_hz, shared)
    words = set()
    bench.step(NO_DEMAND)
    for tick in range(1, 320 * tick_hz):
        own_ready_tick = bench.flight.state.ready_tick
        bench.step(only(tick // (4 * tick_hz) % 3))
        coil, free = bench.status.coil, bench.status.lockout_ms == 0
        assert free == (own_ready_tick[coil] <= tick)
        words.add((coil, free))
    assert len(words) == 6, "each coil was free and locked out"


def first_with_word_on(coil, tick):
    """The first tick from ``tick`` on in which an idle board tells of ``coil``."""
    return tick + (coil - tick) % 3


@pytest.mark.parametrize("tick_hz", RATES)
@pytest.mark.parametrize("coil", [0, 1, 2])
@SHARED_OR_NOT
def test_a_lasting_demand_on_one_coil_fires_a_back_off_after_boot_and_after_each_pulse(
    bench_with, only, tick_hz, coil, shared
):
    """To the tick: then, or when the board has told of this coil, at most two ticks later."""
    bench = bench_with(tick_hz, shared)
    for _ in range(320 * tick_hz):
        bench.step(only(coil))
    expected = [first_with_word_on(coil, 100 * tick_hz)]
    for _ in range(2):
        expected.append(first_with_word_on(coil, expected[-1] + 103 * tick_hz))
    assert bench.judge.starts == [(tick, coil) for tick in expected]


@pytest.mark.long
@pytest.mark.parametrize("tick_hz", RATES)
def test_demands_on_all_coils_are_met_as_often_as_the_limits_let_them(bench_with, only, tick_hz):
    """Demanded is always the coil that fired longest ago. In 330 s: shared three pulses, per coil nine."""
    fired = {}
    for shared in (True, False):
        bench, last = bench_with(tick_hz, shared), [-3, -2, -1]
        for _ in range(330 * tick_hz):
            coil = bench.step(only(last.index(min(last))))
            if coil is not None:
                last[coil] = bench.tick
        fired[shared] = [coil for _, coil in bench.judge.starts]
    assert fired[True] == [0, 1, 2]
    assert fired[False] == [0, 1, 2] * 3


def test_twelve_pulses_in_nineteen_minutes(bench_with, only):
    """PoSAT-1 reports "19.2 minutes or 12 actuations": with a shared back-off 11 cycles of 103 s, and 3 s.

    In each tick the coil is demanded of which the board tells in it: there is nothing to wait for.
    """
    bench = bench_with(1, True)
    for tick in range(100 + 11 * 103 + 3):
        bench.step(only(tick % 3))
    assert [tick for tick, _ in bench.judge.starts] == [100 + 103 * n for n in range(12)]


def test_without_a_demand_nothing_is_fired(bench_with):
    bench = bench_with(1, False)
    for _ in range(500):
        assert bench.step(NO_DEMAND) is None
    assert not bench.asked
