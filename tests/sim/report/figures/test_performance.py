"""The figures of a flight do not depend on the blocks in which it is handed over."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from fsw.core.estimation.mekf import start
from fsw.table.config import flight_config
from sim.report.figures.estimate_error import converged_tick
from sim.report.figures.performance import BLOCK_TICKS, Performance, perform
from sim.scenario.schema import flight_table, load, parse_settings


def in_blocks(run, estimates, *cuts):
    performance, edges = Performance(run.scenario, run.ticks), (0, *cuts, run.ticks)
    truth = run.truth()
    for first, past in itertools.pairwise(edges):
        rows = slice(first, past)
        performance.take({name: history[rows] for name, history in truth.items()}, estimates.part(rows))
    return performance


def off_by(run, error_deg):
    """Estimates that are wrong by these angles about a fixed axis."""
    half = 0.5 * np.radians(error_deg)
    turn = np.stack((np.cos(half), 0.6 * np.sin(half), 0.0 * half, 0.8 * np.sin(half)), axis=1)
    upright = {"q_body_from_orbit": np.tile([1.0, 0.0, 0.0, 0.0], (run.ticks, 1))}
    return replace(run.estimates(), q_body_from_orbit=turn), upright


class Upright:
    """A flight at the nominal attitude, with estimates off by given angles."""

    def __init__(self, run, error_deg):
        self.ticks, self.scenario = run.ticks, run.scenario
        self.estimates, upright = off_by(run, error_deg)
        self._truth = run.truth() | upright

    def truth(self):
        return self._truth


@pytest.mark.parametrize("seed", range(8))
def test_convergence_is_found_wherever_blocks_are_cut(seed, made_run):
    random = np.random.default_rng(seed)
    error_deg = np.full(7000, 1.0)
    error_deg[random.integers(0, 7000, 9)] = 3.0
    error_deg[: random.integers(0, 900)] = np.nan
    flight = Upright(made_run(), error_deg)
    cuts = np.sort(random.choice(np.arange(1, 7000), 25, replace=False))
    cut = in_blocks(flight, flight.estimates, *cuts).figures()
    whole = in_blocks(flight, flight.estimates).figures()
    first = converged_tick(error_deg, 1)
    assert cut["converged_at_s"] == whole["converged_at_s"] == first
    counted = error_deg[first:]
    for figures in (cut, whole):
        assert figures["estimate_deg"]["max"] == pytest.approx(np.nanmax(counted))
        lit = flight.truth()["lit"][first:] > 0.5
        assert figures["estimate_deg"]["rms_sunlit"] == pytest.approx(
            np.sqrt(np.nanmean(counted[lit] ** 2)), rel=1e-9
        )
        assert figures["nees_mean"] == pytest.approx(whole["nees_mean"], rel=1e-9)
        assert figures["estimate_deg"]["within_3sigma"] == whole["estimate_deg"]["within_3sigma"]


def test_ten_minutes_that_end_too_soon_leave_nothing_behind(made_run):
    error_deg = np.full(7000, 5.0)
    error_deg[100:699] = 0.5
    flight = Upright(made_run(), error_deg)
    assert "estimate_deg" not in in_blocks(flight, flight.estimates, 150, 400, 650).figures()
    error_deg[3000:3700] = 1.0
    flight = Upright(made_run(), error_deg)
    figures = in_blocks(flight, flight.estimates, 150, 400, 3100, 3300).figures()
    assert figures["converged_at_s"] == 3000.0
    assert figures["estimate_deg"]["max"] == pytest.approx(5.0)


def test_angles_are_those_of_the_last_orbit_and_settle_across_blocks(made_run):
    run = made_run(ticks=12_000)
    whole, cut = (in_blocks(run, run.estimates(), *cuts).figures() for cuts in ((), (1, 5957, 5959, 11_999)))
    for key in ("pointing_deg", "axis1_deg"):
        assert cut[key] == pytest.approx(whole[key], rel=1e-12)
    assert whole["axis1_deg"]["settle_orbits_5deg"] > 0.1


def test_sums_are_the_same_bits_however_a_flight_is_handed_over(made_run):
    run = made_run(ticks=2 * BLOCK_TICKS + 77)
    blockwise = in_blocks(run, run.estimates(), BLOCK_TICKS, 2 * BLOCK_TICKS).figures()
    assert perform(run.scenario, run.truth(), run.estimates()).figures() == blockwise


def test_a_spin_is_held_against_its_reference_across_blocks(made_run):
    scenario = load("microsat", parse_settings(("control.spin_radps=0.01",)))
    run = made_run(ticks=9000, scenario=scenario)
    run.truth()["omega_body_orbit_radps"][:, 0] = 0.0
    whole, cut = (in_blocks(run, run.estimates(), *cuts).spin() for cuts in ((), (10, 3000, 8999)))
    assert cut == pytest.approx(whole, rel=1e-12)
    assert whole["reference"] == 0.01
    assert "settle_s_1e-3" not in whole


def test_the_last_estimate_of_the_filter_outlives_blocks_without_one(made_run):
    run = made_run(ticks=300)
    config = flight_config(flight_table(run.scenario))
    last = start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), config.estimator.mekf)
    estimates = replace(run.estimates(), last=last)
    performance, truth = Performance(run.scenario, 300), run.truth()
    for first in (0, 100, 200):
        rows = slice(first, first + 100)
        part = replace(estimates.part(rows), last=last if first == 100 else None)
        performance.take({name: history[rows] for name, history in truth.items()}, part)
    assert performance.last_estimate is last
