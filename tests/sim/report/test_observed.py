"""Estimates as they are on the bus: of the tick that they answer, and none where none was sent."""

import numpy as np
import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import Mode, NavAttitude, NavQuality, NavRate, Sync, TickDone
from sim.record.candump import LogEntry
from sim.report.figures.performance import BLOCK_TICKS
from sim.report.observed import NO_MODE, observed_estimates

QUALITY = NavQuality(Mode.POINT, 0.03, 0.003, 1, 1, 0, 0, 1, 0, 0).encode()


def entries(*frames):
    return (LogEntry(line, 0, "loop", frame) for line, frame in enumerate(frames, 1))


def sync(tick):
    return Sync(tick, tick).encode()


def attitude(x, valid=1):
    return NavAttitude(valid, x, 0.0, 0.0).encode()


def test_an_estimate_is_of_the_tick_that_it_answers():
    rate = NavRate(1, 0.125, 0.0, 0.0).encode()
    (block,) = observed_estimates(entries(sync(0), attitude(0.6), rate, sync(1), sync(2), attitude(0.8)), 3)
    assert block.q_body_from_orbit[0] == pytest.approx((0.8, 0.6, 0.0, 0.0), abs=2e-5)
    assert block.omega_body_orbit_radps[0] == pytest.approx((0.125, 0.0, 0.0), abs=4e-6)
    assert np.isnan(block.q_body_from_orbit[1]).all()
    assert block.q_body_from_orbit[2] == pytest.approx((0.6, 0.8, 0.0, 0.0), abs=2e-5)
    assert block.valid.tolist() == [True, False, True]
    assert block.mode.tolist() == [NO_MODE] * 3


def test_one_that_is_not_valid_or_not_whole_is_none():
    broken = Frame(NavAttitude.ID, attitude(0.6).data[:-1] + b"\0")
    (block,) = observed_estimates(entries(sync(0), attitude(0.6, valid=0), sync(1), broken), 2)
    assert np.isnan(block.q_body_from_orbit).all()
    assert not block.valid.any()


def test_mode_and_sigma_hold_until_the_next():
    (block,) = observed_estimates(entries(sync(0), sync(1), QUALITY, sync(2)), 3)
    assert block.mode.tolist() == [NO_MODE, Mode.POINT, Mode.POINT]
    assert block.covariance[2, 0, 0] == pytest.approx(1e-4, rel=1e-2)


def test_a_forged_or_repeated_sync_is_no_tick():
    (block,) = observed_estimates(entries(sync(0), sync(700), sync(0), attitude(0.6)), 2)
    assert block.valid.tolist() == [True, False]


def test_a_log_that_ends_early_gives_every_block():
    found = list(observed_estimates(entries(sync(0), attitude(0.6)), BLOCK_TICKS + 5))
    assert [len(block.valid) for block in found] == [BLOCK_TICKS, 5]
    assert sum(int(block.valid.sum()) for block in found) == 1


def test_what_is_forged_before_a_sync_is_no_estimate_of_the_flight_software():
    done = TickDone(0, 0).encode()
    frames = (sync(0), attitude(0.6), done, attitude(0.0), sync(1))
    (own,) = observed_estimates(entries(*frames), 2, forged=True)
    assert own.q_body_from_orbit[0] == pytest.approx((0.8, 0.6, 0.0, 0.0), abs=2e-5)
    (taken,) = observed_estimates(entries(*frames), 2)
    assert taken.q_body_from_orbit[0] == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=2e-5)
