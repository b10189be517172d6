"""An attitude that is called valid and is wrong for long is told, however good those before and after are."""

import numpy as np
import pytest

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import NavAttitude, Sync
from sim.judge import honesty
from sim.judge.honesty import wrong_attitude

TICKS = 500


@pytest.fixture
def run(tmp_path, monkeypatch):
    """A run whose satellite stays where it is, with a log of the attitudes that are called valid."""

    class Truth:
        complete = TICKS

        def __init__(self, path):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def rows(self, first, past):
            q_body_from_orbit = np.tile((1.0, 0.0, 0.0, 0.0), (past - first, 1))
            return {"t_s": np.arange(first, past), "q_body_from_orbit": q_body_from_orbit}

    monkeypatch.setattr(honesty, "TruthReader", Truth)

    def make(told_deg):
        """``told_deg``: by tick, the angle about axis 1; None: not valid."""
        frames = []
        for tick in range(TICKS):
            angle = told_deg(tick)
            half = np.radians((angle or 0.0) / 2.0)
            frames += [Sync(tick, tick), NavAttitude(int(angle is not None), float(np.sin(half)), 0.0, 0.0)]
        stamp = format_time(0)
        (tmp_path / "bus.log").write_text("".join(format_line(stamp, "loop", one.encode()) for one in frames))
        return tmp_path

    return make


def test_of_small_errors_the_largest_is_told(run):
    found = wrong_attitude(run(lambda tick: 2.0 if tick == 100 else 1.0), 1, 5.0)
    assert found.longest_s == 0.0
    assert found.worst_deg == pytest.approx(2.0, abs=0.01)


def test_a_long_error_counts_on_end(run):
    found = wrong_attitude(run(lambda tick: 20.0 if 100 <= tick < 300 else 1.0), 1, 5.0)
    assert found.longest_s == 200.0
    assert wrong_attitude(run(lambda tick: 20.0 if tick % 2 else 1.0), 1, 5.0).longest_s == 1.0


def test_a_tick_that_is_not_valid_is_not_wrong_and_ends_nothing(run):
    assert wrong_attitude(run(lambda tick: None), 1, 5.0) == (0.0, 0.0, 5.0)
    found = wrong_attitude(run(lambda tick: None if tick == 200 else 20.0), 10, 5.0)
    assert found.longest_s == pytest.approx(49.9)
