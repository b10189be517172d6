"""How well the response to a command is known, whose rise and fall share readings."""

import numpy as np
import pytest

from sim.commissioning.phasing.bench_log import Recording, bench_responses

pytestmark = pytest.mark.long


def noisy(seed, on_s, off_s):
    """A recording of six pulses along x of 3000 nT, each on and off so long, in noise."""
    draw = np.random.default_rng(seed)
    edges_s = np.cumsum([0.0, *([off_s, on_s] * 6)])
    time_s = np.arange(0.05, edges_s[-1] + off_s, 0.1)
    on = (np.searchsorted(edges_s, time_s) % 2 == 0)[:, None] * np.array([3000.0, 0.0, -900.0])
    commands = np.outer(np.arange(len(edges_s)) % 2, (0.1, 0.0, 0.0))
    return Recording({"mag": (time_s, on + draw.normal(0.0, 100.0, on.shape))}, (edges_s, commands))


@pytest.mark.parametrize(("on_s", "off_s"), [(6.0, 6.0), (6.0, 30.0), (30.0, 30.0)])
def test_a_size_is_as_uncertain_as_it_says_though_a_rise_and_its_fall_share_readings(on_s, off_s):
    pulls = []
    for seed in range(60):
        ((step,),) = (one.steps for one in bench_responses(noisy(seed, on_s, off_s)))
        pulls.append((step.response_nt - [3000.0, 0.0, -900.0]) / step.sigma_nt)
    assert 0.8 < np.sqrt(np.mean(np.square(pulls))) < 1.15
