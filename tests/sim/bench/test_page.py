"""The page of a bench: its budgets, and what was not measured."""

from math import inf

import pytest

from sim.bench.page import hil_page


def numbers(**changes):
    """Those of a short run."""
    known = {
        "scenario": "micro<sat>",
        "ticks": 30,
        "tick_hz": 1,
        "bus": "loop:1",
        "armed": False,
        "real": [],
        "scheduling": "ordinary, nice 0",
        "jitter_ms": {"p50": 1.0, "p99": 2.0, "max": 3.0},
        "latency_ms": {"p50": 4.0, "p99": inf, "max": inf},
        "bus_load_percent": {"mean": 0.7, "busiest_tick": 1.1, "bitrate": 125_000},
        "slips": 2,
        "messages": {"SYNC": 30},
        "budgets": [
            {"name": "jitter", "measured": 2.0, "allowed": 10.0, "kept": True},
            {"name": "latency", "measured": inf, "allowed": 10.0, "kept": False},
        ],
        "memory": {
            "every_s": 1,
            "warm": 2,
            "kib": {"fsw": [1024, 2048, 2048], "coil": [512]},
            "load_average": [],
        },
        "second_senders": [],
        "ended": {"coil": "it fell"},
    }
    return known | changes


def test_it_says_what_is_kept_and_what_is_not():
    page = hil_page(numbers(), 0)
    for words in (
        "✗ 1 budgets broken",
        "✗ coil ended before its time",
        "micro&lt;sat&gt;",
        ">BROKEN</td>",
    ):
        assert words in page
    assert "inf" not in page.partition("<main>")[2].partition("<script")[0].replace("information", "")


def test_a_good_bench_is_called_so():
    good = [{"name": "jitter", "measured": 2.0, "allowed": 10.0, "kept": True}]
    page = hil_page(numbers(budgets=good, ended={}), 0)
    assert '<li class="good">✓ budgets kept</li>' in page
    assert 'class="bad"' not in page


@pytest.mark.parametrize("kib", [{}, {"fsw": [1024]}, {"fsw": []}])
def test_memory_that_was_hardly_sampled_is_not_drawn(kib):
    page = hil_page(numbers(memory={"every_s": 1, "warm": 0, "kib": kib, "load_average": []}), 0)
    assert "<figure" not in page


@pytest.mark.long
@pytest.mark.slow
def test_memory_is_drawn_in_a_browser(look, tmp_path):
    (tmp_path / "hil.html").write_text(hil_page(numbers(), 0), encoding="utf-8")
    page = look(tmp_path / "hil.html", width=390, dark=True)
    assert page.locator("#chart-memory canvas").is_visible()
    assert page.locator(".legend .value").all_inner_texts() == ["1", "0.5"]
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
