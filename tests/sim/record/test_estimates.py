"""The estimates of the flight software by tick, recorded from the states of a replay."""

import numpy as np
import pytest
from flight_states import altered

from fsw.core.packing import copy_state, pack
from sim.record.estimates import EstimateRecorder
from sim.record.run_dir import BUS_LOG
from sim.replay.log_replay import replay


@pytest.fixture(scope="module")
def states(recorded_run, config_of):
    seen = []
    replay(recorded_run / BUS_LOG, config_of(recorded_run), lambda state: seen.append(copy_state(state)))
    return seen


def recorded(states, ticks):
    recorder = EstimateRecorder(ticks)
    for state in states:
        recorder.take(state)
    return recorder.estimates()


def test_every_tick_holds_the_estimate_of_its_state(states):
    estimates = recorded(states, 300)
    for tick in (0, 1, 57, 101, 299):
        state = states[tick]
        known = state.estimator.estimate
        assert tuple(estimates.q_body_from_orbit[tick]) == state.attitude.q_body_from_orbit
        assert tuple(estimates.omega_body_orbit_radps[tick]) == state.attitude.omega_body_orbit_radps
        assert tuple(estimates.omega_body_radps[tick]) == known.omega_body_radps
        np.testing.assert_array_equal(estimates.covariance[tick], known.covariance[:6, :6])
        assert estimates.valid[tick] == state.attitude.valid
        assert estimates.mode[tick] == state.modes.mode


def test_ticks_that_were_not_flown_are_unknown(states):
    estimates = recorded(states[:100], 300)
    assert np.isfinite(estimates.q_body_from_orbit[:100]).all()
    for history in (estimates.q_body_from_orbit, estimates.omega_body_radps, estimates.covariance):
        assert np.isnan(history[100:]).all()
    assert not estimates.valid[100:].any()


def test_the_last_estimate_is_kept_whole_though_the_filter_has_lost_it(states):
    lost = altered(states[200], estimator=type(states[200].estimator)())
    assert pack(recorded([*states[:200], lost], 300).last) == pack(states[199].estimator.estimate)
    assert pack(recorded(states, 40).last) == pack(states[39].estimator.estimate)
    assert recorded([lost], 300).last is None


def test_ticks_beyond_the_histories_are_passed_over(states):
    assert recorded(states, 40).valid.shape == (40,)


def test_before_the_filter_has_started_nothing_is_known(states):
    state = states[50]
    waiting = altered(state, estimator=type(state.estimator)(), attitude=state.attitude.invalid())
    estimates = recorded([waiting], 300)
    assert np.isnan(estimates.q_body_from_orbit).all()
    assert np.isnan(estimates.omega_body_orbit_radps).all()


def test_perfect_knowledge_has_an_attitude_and_no_covariance(fly_run, config_of):
    path = fly_run(ticks=20, knowledge="perfect")
    seen = []
    replay(path / BUS_LOG, config_of(path), lambda state: seen.append(copy_state(state)))
    estimates = recorded(seen, 20)
    assert np.isfinite(estimates.q_body_from_orbit).all()
    assert estimates.valid.all()
    assert np.isnan(estimates.covariance).all()
