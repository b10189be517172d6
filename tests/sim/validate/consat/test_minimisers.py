"""The genetic search beside the closed form: what is left of the gain, and that a worse search shows."""

import pytest

from sim.validate.consat import minimisers


def judged(parts):
    return [outcome.verdict.value for outcome in minimisers.genetic().conclude(parts)]


def test_the_search_leaves_little_and_is_never_better_than_the_best():
    left = minimisers.parts_left(range(12))
    assert all(0.0 <= part < 0.3 for part in left)
    assert sorted(left)[6] < 3e-3


def test_half_of_the_states_have_products_of_inertia():
    assert minimisers.PRODUCTS.any()
    assert len(minimisers.genetic().tasks) * minimisers.STATES // minimisers.TASKS == minimisers.STATES


@pytest.mark.parametrize("seed", [1, 2])
def test_a_search_that_turns_the_dipole_leaves_more_than_there_was(monkeypatch, seed):
    search = minimisers.search
    monkeypatch.setattr(minimisers, "search", lambda *given: tuple(-c for c in search(*given)))
    assert minimisers.part_left(seed) > 1.0


def test_verdicts():
    assert judged([[1e-4, 2e-4, 0.1]]) == ["PASS", "PASS"]
    assert judged([[2e-3, 2e-3, 0.1]]) == ["FAIL", "PASS"]
    assert judged([[1e-4, 2e-4, 0.4]]) == ["PASS", "FAIL"]
