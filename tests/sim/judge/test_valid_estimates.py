"""An attitude that is called valid and wrong for long is named, however good those before and after are."""

import numpy as np
import pytest

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import NavAttitude, NavRate, Sync
from sim.judge import valid_estimates
from sim.judge.valid_estimates import WrongAttitude, wrong_attitude, wrong_rate
from sim.report.figures.attitude_arrays import normal_in_body, rotated
from sim.scenario.schema import load, orbit_period_s

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

    monkeypatch.setattr(valid_estimates, "TruthReader", Truth)

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
    assert wrong_attitude(run(lambda tick: None), 1, 5.0) == WrongAttitude(0.0, 0.0, 5.0)
    found = wrong_attitude(run(lambda tick: None if tick == 200 else 20.0), 10, 5.0)
    assert found.longest_s == pytest.approx(49.9)


MICROSAT = load("microsat")
ORBITAL_RADPS = 2.0 * np.pi / orbit_period_s(MICROSAT)
RNG = np.random.default_rng(4)


def _attitudes():
    """Attitudes of a slow tumble, scalar first, with scalar parts of both signs."""
    q = np.cumsum(0.1 * RNG.normal(size=(TICKS, 4)), axis=0)
    return q / np.linalg.norm(q, axis=1, keepdims=True)


@pytest.fixture
def tumbling(tmp_path, monkeypatch):
    """A run whose satellite tumbles, with a log of what ``tell`` makes of its attitude and rate."""
    q, omega = _attitudes(), np.radians(0.1) * RNG.normal(size=(TICKS, 3))

    class Truth:
        complete = TICKS

        def __init__(self, path):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def rows(self, first, past):
            rows = slice(first, past)
            return {
                "t_s": np.arange(first, past),
                "q_body_from_orbit": q[rows],
                "omega_body_orbit_radps": omega[rows],
            }

    monkeypatch.setattr(valid_estimates, "TruthReader", Truth)

    def make(tell=lambda q: np.where(q[:, :1] < 0.0, -q, q)[:, 1:], rate=lambda q, omega: omega):
        frames = []
        for tick, (v, w) in enumerate(zip(tell(q), rate(q, omega), strict=True)):
            frames += [Sync(tick, tick), NavAttitude(1, *v.tolist())]
            frames += [] if np.isnan(w).any() else [NavRate(1, *w.tolist())]
        stamp = format_time(0)
        (tmp_path / "bus.log").write_text("".join(format_line(stamp, "loop", one.encode()) for one in frames))
        return tmp_path

    return make


@pytest.mark.parametrize(
    ("tell", "words"),
    [
        (
            lambda q: np.where(q[:, :1] < 0.0, q, -q)[:, 1:],
            "it is the conjugate, the turn from body to orbit",
        ),
        (lambda q: q[:, 1:], "its vector is not turned where the scalar part is negative"),
        (lambda q: q[:, (0, 1, 2)], "the scalar part is taken for the first component of the vector"),
        (
            lambda q: np.where(q[:, 3:] < 0.0, -q, q)[:, (0, 1, 2)],
            "the scalar part is taken for the first component of the vector",
        ),
        (lambda q: q[:, (2, 3, 0)], "the scalar part is taken for the last component of the vector"),
        (lambda q: RNG.normal(size=(TICKS, 3)) / 4.0, ""),
    ],
)
def test_a_mistake_of_the_quaternion_is_named_where_it_alone_explains_it(tumbling, tell, words):
    found = wrong_attitude(tumbling(tell), 1, 5.0)
    assert found.longest_s > 0.0
    assert found.mistake.startswith(words)
    assert bool(found.mistake) == bool(words)


def test_a_true_attitude_and_rate_make_no_mistake(tumbling):
    run = tumbling()
    assert wrong_attitude(run, 1, 5.0).longest_s == 0.0
    assert wrong_rate(run, MICROSAT).longest_s == 0.0


@pytest.mark.parametrize(
    ("rate", "words"),
    [
        (lambda q, omega: -omega, "its sign is wrong"),
        (
            lambda q, omega: omega + ORBITAL_RADPS * normal_in_body(q),
            "it is the rate against inertial space, with the orbit's",
        ),
        (
            lambda q, omega: rotated(q * np.array((1.0, -1.0, -1.0, -1.0)), omega),
            "it is in the axes of the orbital frame",
        ),
        (lambda q, omega: omega[:, (1, 2, 0)], ""),
    ],
)
def test_a_mistake_of_the_rate_is_named_where_it_alone_explains_it(tumbling, rate, words):
    found = wrong_rate(tumbling(rate=rate), MICROSAT)
    assert found.longest_s > 0.0
    assert found.mistake == words


def test_without_a_rate_none_is_judged(tumbling):
    assert wrong_rate(tumbling(rate=lambda q, omega: np.nan * omega), MICROSAT) is None
