"""Claims on prediction: a law without its horizon or without coils misses them."""

from dataclasses import replace

import pytest

from sim.validate.review import predictive as prediction


def test_a_horizon_too_long_misses_the_claim_of_the_short_one():
    trial = prediction.held()
    late = replace(trial.flights[1], orbits=1.5).fly()
    assert [outcome.verdict.value for outcome in trial.conclude((late, late))] == ["FAIL", "PASS"]


def test_energy_is_taken_by_the_law_alone():
    """A law of the Sun without a Sun asks for nothing: gravity changes a part in a thousand at most."""
    assert prediction.energy_taken("rate_damping", seconds=30.0) > 0.005
    assert abs(prediction.energy_taken("sun_panels", seconds=30.0)) < 1e-3


@pytest.mark.parametrize(
    ("found", "expected"),
    [((0.05, 0.05, 0.05, 0.05), ["PASS", "PASS"]), ((0.04, 0.05, 0.04, 0.05), ["FAIL", "FAIL"])],
)
def test_what_is_taken_is_judged_beside_the_other_search_and_the_law(found, expected):
    assert [outcome.verdict.value for outcome in prediction.tumbling().conclude(found)] == expected
