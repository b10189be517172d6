"""Lines and spans of a flight do not depend on the blocks in which it is handed over."""

import itertools

import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.report.charts.lines import MEAN_S, Lines, Spans
from sim.scenario.schema import load


def in_blocks(run, *cuts, **truth):
    truth, estimates = run.truth() | truth, run.estimates()
    lines, edges = Lines(run.ticks, run.scenario), (0, *cuts, run.ticks)
    for first, past in itertools.pairwise(edges):
        rows = slice(first, past)
        lines.take({name: history[rows] for name, history in truth.items()}, estimates.part(rows))
    return lines


@pytest.mark.parametrize("name", ["pointing_deg", "omega_degps", "attitude_sigma3_deg", "b_body_t"])
def test_a_line_is_the_same_from_one_block_or_many(name, made_run):
    run = made_run()
    assert (in_blocks(run).line(name) == in_blocks(run, 1, 100, 4096, 6999).line(name)).all()


def test_the_torque_of_the_coils_is_the_mean_over_ten_minutes_across_blocks(made_run):
    run = made_run(ticks=1300)
    torque = np.random.default_rng(5).standard_normal((1300, 3))
    length = int(MEAN_S)
    expected = [np.linalg.norm(torque[max(0, i + 1 - length) : i + 1].mean(axis=0)) for i in range(1300)]
    for cuts in ((), (1, 2, 599, 601), (700,)):
        lines = in_blocks(run, *cuts, **{"torque_body_nm/coils": torque})
        assert lines.torques()["coils"] == pytest.approx(expected, rel=1e-9)


def test_where_a_mean_is_only_rounding_there_is_no_line(made_run):
    run, torque = made_run(ticks=1400), np.zeros((1400, 3))
    torque[10:20] = (1e-5, 0.3e-5, -2e-5)
    line = in_blocks(run, 15, 300, **{"torque_body_nm/coils": torque}).torques()["coils"]
    assert np.isfinite(line[10:619]).all()
    assert np.isnan(line[:10]).all()
    assert np.isnan(line[620:]).all()


def test_modes_and_eclipses_go_on_across_blocks(made_run):
    lines = in_blocks(made_run(), 999, 1000, 1001, 2000, 3000, 5000)
    assert lines.dark.spans == [(1000, 3000)]
    assert lines.modes[Mode.ACQUIRE].spans == [(0, 3500)]
    assert lines.modes[Mode.POINT].spans == [(3500, 7000)]
    assert lines.modes[Mode.SAFE].spans == []


def test_spans_that_do_not_meet_stay_apart():
    spans = Spans()
    for part in ("0110", "1", "0", "11"):
        spans.take(np.array(list(part)) == "1")
    assert spans.spans == [(1, 3), (4, 5), (6, 8)]


def test_a_filter_that_estimated_at_some_time_is_known_to_have(made_run):
    run = made_run(ticks=50)
    assert in_blocks(run, 10).has_estimates
    unknown = run.estimates()
    unknown.covariance[:] = np.nan
    lines = Lines(50, run.scenario)
    lines.take(run.truth(), unknown)
    assert not lines.has_estimates


def test_a_flight_without_a_tick_has_no_lines():
    lines = Lines(0, load("microsat"))
    assert (len(lines.places), lines.torques(), lines.ticks) == (0, {}, 0)
