"""Numbers and budgets: every budget can break, and what was not measured is not kept."""

import pytest

from sim.bench.budgets import Budgets, judge, percentiles, render
from sim.bench.realtime_loop import BenchMeasurements, TimeHistogram

BOARDS = ("coil", "sun")
BUDGETS = Budgets(jitter_ms=10.0, latency_ms=50.0, slips=1, load_percent=20.0, memory_percent=2.0)
FLAT = {"fsw": 0.1, "hub": 2.0}


def measured(**changes):
    run = BenchMeasurements(
        ticks=100,
        jitter=TimeHistogram([0.001] * 99 + [0.2]),
        latency=TimeHistogram([0.004] * 100),
        slips=1,
        bits=125_000,
        busiest_bits=2500,
    )
    run.samples.update({"coil": 99, "sun": 100})
    for name, value in changes.items():
        setattr(run, name, value)
    return run


def broken(run, growth_percent=FLAT):
    _, lines = judge(run, BUDGETS, BOARDS, 10, growth_percent)
    return [line.name for line in lines if not line.kept]


def test_the_numbers():
    numbers, lines = judge(measured(), BUDGETS, BOARDS, 10, FLAT)
    assert numbers["jitter_ms"] == pytest.approx({"p50": 1.0, "p99": 200.0, "max": 200.0}, rel=0.01)
    assert numbers["bus_load_percent"] == {"mean": 10.0, "busiest_tick": 20.0, "bitrate": 125_000}
    assert numbers["missing_samples"] == {"coil": 1, "sun": 0}
    assert len(lines) == 8


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"jitter": TimeHistogram([0.02] * 100)}, "jitter"),
        ({"latency": TimeHistogram([0.06] * 100)}, "TICK_DONE"),
        ({"latency": TimeHistogram()}, "TICK_DONE"),
        ({"slips": 2}, "without an answer"),
        ({"bits": 251_000}, "bus load"),
    ],
)
def test_each_budget_can_break(changes, named):
    good = TimeHistogram([0.001] * 100)
    run = measured(**{"jitter": good, **changes})
    (name,) = broken(run)
    assert named in name
    assert "BROKEN" in render(*judge(run, BUDGETS, BOARDS, 10, FLAT))


def test_a_board_that_is_silent_breaks_one():
    run = measured(jitter=TimeHistogram([0.001] * 100))
    assert broken(run) == []
    run.samples["sun"] = 98
    assert broken(run) == ["ticks without one sun sample"]


def test_memory_that_grows_breaks_the_budget_of_its_process_alone():
    run = measured(jitter=TimeHistogram([0.001] * 100))
    assert broken(run, {"fsw": 2.01, "hub": 2.0}) == ["memory of fsw, growth [%]"]
    assert broken(run, {"fsw": float("inf")}) == ["memory of fsw, growth [%]"]
    assert broken(run, {}) == []


def test_percentiles_in_ms():
    in_ms = percentiles(TimeHistogram(n / 1000.0 for n in range(200)))
    assert in_ms == pytest.approx({"p50": 100.0, "p99": 198.0, "max": 199.0}, rel=0.01)
    assert in_ms["max"] == 199.0
    assert percentiles(TimeHistogram())["max"] == float("inf")
