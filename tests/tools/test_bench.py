"""The page of the benchmarks: ratios are taken within a round, then their median."""

import re

import bench
import pytest

ROWS = [
    bench.Row("peer", [100.0, 50.0, 400.0], 300.0),
    bench.Row("mine", [10.0, 10.0, 20.0], 120.4),
    bench.Row("microsat, one process", [2000.0, 2500.0, 4000.0], 130.0),
    bench.Row("realsat, one process", [1600.0, 2000.0, 2500.0], 130.0),
]
PARTS = {"microsat": {"step.update": 59.6, "plant.Plant.end_tick": 37.4, "plant.Plant.tick": 0.1}}
LISTED = """
 200,000 (66.7%)  ???:CPyDef_step___step [torquer__mypyc.so]
 100,000 (33.3%)  ???:CPyDef_plant___Plant___end_tick [torquer__mypyc.so]
  90,000 (30.0%)  ???:CPyDef_step____update [torquer__mypyc.so]
  80,000 (26.7%)  ???:CPyDef_estimator___update [torquer__mypyc.so]
"""
PLANS = {"microsat": {"plans": 219, "mean_ms": 2.604, "percentile_99_ms": 3.871}}


@pytest.fixture(scope="module")
def page():
    return bench.page(ROWS, [1.2, 1.5, 1.3], PARTS, PLANS, "2.12.1")


def test_a_ratio_is_the_median_of_those_within_a_round(page):
    assert "| mine | 10 | 0.100 | 120 MB |" in page
    assert "| peer | 100 | 1.000 | 300 MB |" in page
    assert "takes, from start to report, 1.30 of the time" in page


def test_what_the_parameters_cost_is_the_median_of_the_differences_within_a_round(page):
    assert "takes 125 µs longer\n(100 to 150 in the rounds) than one" in page


def test_parts_are_in_thousands_of_instructions_and_what_is_next_to_nothing_is_left_out(page):
    assert re.findall(r"\| `(.*?)` \| (\d+) \|", page) == [
        ("step.update", "60"),
        ("plant.Plant.end_tick", "37"),
    ]


def test_instructions_are_those_of_the_functions_of_step_and_plant():
    counted = {"step.step": 20.0, "plant.Plant.end_tick": 10.0, "step.update": 9.0}
    assert bench.instructions(LISTED, ticks=10) == counted


def test_what_a_plan_takes_is_told(page):
    assert "takes 2.60 ms in the mean on `microsat`, one in a hundred\nmore than 3.87 ms (219 plans" in page


@pytest.mark.long
def test_plans_are_timed_in_a_flight():
    figures = bench.plans_of("microsat", 1.5)
    assert figures["plans"] > 5
    assert 0.1 < figures["mean_ms"] <= figures["percentile_99_ms"] < 1000.0


@pytest.mark.long
def test_a_flight_too_short_for_a_plan_is_one_sentence():
    with pytest.raises(SystemExit, match=r"^microsat: pulse_mpc made no plan in 0\.01 orbits[^\n]*$"):
        bench.plans_of("microsat", 0.01)


def test_a_command_that_fails_ends_the_benchmark():
    with pytest.raises(SystemExit, match="ended with exit code 3"):
        bench.run([bench.sys.executable, "-c", "raise SystemExit(3)"], lambda output, wall_s: 1.0)


@pytest.mark.long
def test_a_command_is_measured():
    words = [bench.sys.executable, "-c", "import time; time.sleep(0.2); print(7)"]
    measured = bench.run(words, lambda output, wall_s: float(output))
    assert measured.realtime_factor == 7.0
    assert 0.2 < measured.wall_s < 5.0
    assert measured.peak_mb > 3.0
