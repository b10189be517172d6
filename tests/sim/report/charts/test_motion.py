"""Samples of a flight: the same however it is handed over, and no more of a longer one."""

import numpy as np
import pytest

from sim.report.charts.lines import COLUMNS, MOST_SAMPLES, MotionSamples


def histories(ticks):
    counted = np.arange(ticks, dtype=float)
    return {name: np.squeeze(np.outer(counted, np.ones(width))) for name, width in COLUMNS.items()}


def sampled(ticks, block):
    motion, truth = MotionSamples(ticks), histories(ticks)
    for first in range(0, ticks, block):
        motion.take({name: history[first : first + block] for name, history in truth.items()})
    return motion


@pytest.mark.parametrize("block", [1, 7, 1000])
def test_every_tick_of_a_short_flight_is_a_sample(block):
    motion = sampled(50, block)
    assert motion.places.tolist() == list(range(50))
    assert motion.samples("b_body_t")[:, 2].tolist() == list(range(50))


def test_a_long_flight_has_samples_from_its_first_to_its_last_tick():
    motion = sampled(20_000, 4096)
    assert len(motion.places) == MOST_SAMPLES
    assert motion.samples("lit")[:, 0].tolist() == motion.places.tolist()
    assert (motion.places[0], motion.places[-1]) == (0, 19_999)
