"""The search for gains: as good as what is known, deterministic, and honest where nothing stabilises."""

import numpy as np
import pytest

from sim.design.theory.bodies import BODIES, UNSTABLE_BODIES
from sim.design.theory.floquet import ROUGH_STEPS
from sim.design.theory.linear import Gains
from sim.design.theory.search import (
    GRID,
    MARGIN,
    SEARCH_STEPS,
    SPAN_I,
    Candidate,
    Search,
    _apart,
    best_integral,
    candidate,
    continuous,
    gain_map,
    natural_gains,
    search,
)

MICROSAT, GAINS = BODIES[2], Gains(6.0e6, 1300.0)


PLACE_W, PLACE_A = 3.0, 0.5
"""Where ``kinked`` has its minimum, in natural gains."""


def kinked(gains):
    """A landscape like a real one: two slopes that meet in a valley, and a second, higher basin."""
    natural = natural_gains(MICROSAT)
    w, a = np.log(gains.k_w / natural.k_w / PLACE_W), np.log(gains.k_a / natural.k_a / PLACE_A)
    valley = np.maximum(np.sqrt(np.abs(w - 0.3 * a)), 0.3 * np.abs(a)) - 0.6
    other = 0.2 * np.hypot(w + 3.0, a - 3.0) - 0.3
    return np.minimum(valley, other)


@pytest.fixture(scope="module")
def microsat():
    return search(MICROSAT, continuous(MICROSAT), continuous(MICROSAT, ROUGH_STEPS))


@pytest.mark.long
@pytest.mark.slow
def test_it_finds_the_known_optimum(microsat):
    best = microsat.best
    assert best.degree < -0.5185
    assert best.gains.k_w == pytest.approx(6.2694e6, rel=2e-3)
    assert best.gains.k_a == pytest.approx(1614.9, rel=2e-3)
    assert microsat.stabilised


@pytest.mark.long
def test_the_best_gains_are_better_than_all_beside_them(microsat):
    best = microsat.best
    around = np.exp(np.linspace(-0.2, 0.2, 11))
    beside = continuous(MICROSAT)(Gains(best.gains.k_w * around[:, None], best.gains.k_a * around))
    assert beside.min() >= best.degree - 1e-6


@pytest.mark.long
def test_the_steady_gains_are_surer_than_the_best(microsat):
    best, steady = microsat.best, microsat.steady
    assert steady.worst_degree < best.worst_degree - 0.05
    assert best.degree < steady.degree < 0.0


@pytest.mark.long
@pytest.mark.slow
def test_it_says_when_no_gains_stabilise():
    body = UNSTABLE_BODIES[1]
    found = search(body, continuous(body), continuous(body, ROUGH_STEPS))
    assert not found.stabilised
    assert found.best.worst_degree > 0.0


@pytest.mark.long
def test_it_goes_down_to_the_kink_of_the_lower_basin():
    best, natural = search(MICROSAT, kinked, kinked).best, natural_gains(MICROSAT)
    assert best.degree == pytest.approx(-0.6, abs=0.02)
    assert best.gains.k_w / natural.k_w == pytest.approx(PLACE_W, rel=0.05)
    assert best.gains.k_a / natural.k_a == pytest.approx(PLACE_A, rel=0.1)


def test_the_wide_basin_is_steadier_than_the_kink():
    found = search(MICROSAT, kinked, kinked)
    assert found.steady.worst_degree < found.best.worst_degree
    assert found.steady.degree == pytest.approx(-0.3, abs=0.02)


@pytest.mark.long
def test_it_finds_the_same_again_and_tells_how_far_it_is():
    progress = []
    once = search(MICROSAT, kinked, kinked, progress.append)
    again = search(MICROSAT, kinked, kinked)
    assert (once.best, once.steady) == (again.best, again.steady)
    assert progress == sorted(progress)
    assert (progress[0], progress[-1]) == (1, SEARCH_STEPS)


def test_with_as_many_basins_as_are_searched_it_never_goes_back():
    natural, progress = natural_gains(MICROSAT), []

    def pitted(gains):
        w, a = np.log(gains.k_w / natural.k_w), np.log(gains.k_a / natural.k_a)
        return np.min([np.hypot(w - x, a - y) for x in (-1.0, 2.0) for y in (-2.0, 2.0)], axis=0)

    search(MICROSAT, pitted, pitted, progress.append)
    assert progress == sorted(progress)
    assert progress[-1] == SEARCH_STEPS


def test_gains_that_stabilise_only_just_are_none():
    """At a degree of zero the body swings for ever."""
    swinging = Candidate(Gains(1.0, 1.0), 0.0, 0.0)
    assert not Search(None, swinging, swinging).stabilised


@pytest.mark.parametrize("sides", [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])
def test_both_gains_may_be_off_to_either_side(sides):
    found = candidate(
        lambda gains: sides[0] * np.log(gains.k_w) + sides[1] * np.log(gains.k_a), Gains(1.0, 1.0)
    )
    assert found.worst_degree == pytest.approx(2.0 * MARGIN)


def test_gains_stay_within_what_was_searched():
    found = search(MICROSAT, *[lambda gains: -np.log(gains.k_w) - np.log(gains.k_a)] * 2)
    assert found.best.gains.k_w <= found.map.k_w[-1] * (1.0 + 1e-9)
    assert found.best.gains.k_a <= found.map.k_a[-1] * (1.0 + 1e-9)


def test_sure_is_the_worst_of_gains_that_are_off():
    degree, gains = continuous(MICROSAT, ROUGH_STEPS), Gains(6.2e6, 1500.0)
    off = (
        np.exp(MARGIN * np.array([0.0, 1.0, 1.0, -1.0, -1.0])),
        np.exp(MARGIN * np.array([0.0, 1.0, -1.0, 1.0, -1.0])),
    )
    expected = max(float(degree(Gains(gains.k_w * w, gains.k_a * a))) for w, a in zip(*off, strict=True))
    one = candidate(degree, gains)
    assert one.worst_degree == pytest.approx(expected, abs=1e-12)
    assert one.worst_degree > one.degree


@pytest.mark.long
def test_a_map_has_its_gains_where_it_says():
    degree = continuous(MICROSAT, ROUGH_STEPS)
    found = gain_map(MICROSAT, degree)
    assert found.degree.shape == (GRID, GRID)
    assert found.degree[7, 23] == pytest.approx(float(degree(Gains(found.k_w[23], found.k_a[7]))), abs=1e-12)


@pytest.mark.long
def test_the_best_integral_gain_is_best_and_too_much_of_it_diverges():
    degree = continuous(MICROSAT, ROUGH_STEPS)
    best = best_integral(MICROSAT, GAINS, degree)
    assert (best.k_w, best.k_a) == GAINS[:2]
    at = [float(degree(best._replace(k_i=factor * best.k_i))) for factor in (0.5, 0.9, 1.0, 1.1, 8.0)]
    assert at[2] < -0.1
    assert at[2] <= min(at[1], at[3]) + 1e-3
    assert at[2] < at[0] < 0.0 < at[4]


@pytest.mark.parametrize(("side", "end"), [(1.0, SPAN_I[0]), (-1.0, SPAN_I[1])])
def test_an_integral_gain_at_the_end_of_its_span_stays_there(side, end):
    best = best_integral(MICROSAT, GAINS, lambda gains: side * np.log(gains.k_i))
    assert best.k_i == pytest.approx(end * natural_gains(MICROSAT).k_i)


def test_a_minimum_that_was_found_twice_is_taken_once():
    once, near, other = np.array([15.0, 7.0]), np.array([15.05, 6.95]), np.array([15.0, 7.2])
    assert _apart([once, near, other]) == [once, other]


def test_natural_gains_scale_with_the_inertia():
    small, large = natural_gains(BODIES[0]), natural_gains(BODIES[4])
    assert all(b > 1e4 * a for a, b in zip(small, large, strict=True))
