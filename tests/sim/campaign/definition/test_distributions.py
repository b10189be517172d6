"""Drawn values have the distribution that the file says, within the limits that it says."""

import numpy as np
import pytest
from pydantic import TypeAdapter
from scipy import stats

from sim.campaign.definition.distributions import AnyDispersion

PARSE = TypeAdapter(AnyDispersion).validate_python
COUNT = 4000


def drawn(values, shapes=((),), count=COUNT):
    """Values of many runs, (count, ...), those of several keys side by side."""
    entry, random = PARSE(values), np.random.default_rng(1)
    rows = [np.concatenate([np.ravel(part) for part in entry.draw(random, shapes)]) for _ in range(count)]
    return np.array(rows)


def is_of(values, distribution):
    return stats.kstest(values, distribution.cdf).pvalue > 1e-3


@pytest.mark.long
def test_normal_has_mean_and_sigma_of_each_component():
    values = drawn(
        {"distribution": "normal", "key": "a", "mean": [1.0, -2.0, 0.0], "sigma": [0.5, 3.0, 0.0]}, ((3,),)
    )
    assert is_of(values[:, 0], stats.norm(1.0, 0.5))
    assert is_of(values[:, 1], stats.norm(-2.0, 3.0))
    assert not values[:, 2].any()
    assert abs(np.corrcoef(values[:, 0], values[:, 1])[0, 1]) < 0.05


@pytest.mark.long
def test_normal_between_limits_is_truncated_not_piled_up():
    values = drawn({"distribution": "normal", "key": "a", "mean": 1.0, "sigma": 2.0, "low": 0.0, "high": 4.0})
    assert is_of(values[:, 0], stats.truncnorm(-0.5, 1.5, loc=1.0, scale=2.0))
    assert values.min() >= 0.0
    assert values.max() <= 4.0


def test_uniform_and_log_uniform():
    ends = {"key": "a", "low": 0.01, "high": 2.0}
    assert is_of(drawn({"distribution": "uniform", **ends})[:, 0], stats.uniform(0.01, 1.99))
    assert is_of(drawn({"distribution": "log_uniform", **ends})[:, 0], stats.loguniform(0.01, 2.0))


def test_choices_come_as_often_as_they_weigh():
    entry = PARSE({"distribution": "choice", "key": "a", "values": ["x", "y"], "weights": [3.0, 1.0]})
    random = np.random.default_rng(2)
    values = [entry.draw(random, ((),))[0] for _ in range(COUNT)]
    assert stats.binomtest(values.count("x"), COUNT, 0.75).pvalue > 1e-3


@pytest.mark.parametrize(
    ("length", "expected"),
    [("uniform", stats.uniform(0.5, 1.5)), ("log_uniform", stats.loguniform(0.5, 2.0))],
)
def test_a_direction_is_anywhere_on_the_sphere(length, expected):
    values = drawn(
        {"distribution": "direction", "key": "a", "length": length, "low": 0.5, "high": 2.0}, ((3,),)
    )
    lengths = np.linalg.norm(values, axis=1)
    assert is_of(lengths, expected)
    for axis in range(3):  # each component of a random unit vector is uniform from -1 to 1 (Archimedes)
        assert is_of(values[:, axis] / lengths, stats.uniform(-1.0, 2.0))


@pytest.mark.long
def test_correlated_values_have_mean_and_covariance():
    covariance = np.array([[4.0, 1.2, 0.0], [1.2, 1.0, 0.3], [0.0, 0.3, 0.25]])
    values = drawn(
        {
            "distribution": "correlated",
            "keys": ["a", "b"],
            "mean": [1.0, 2.0, 3.0],
            "covariance": covariance.tolist(),
        },
        ((2,), ()),
        count=20000,
    )
    assert values.mean(axis=0) == pytest.approx([1.0, 2.0, 3.0], abs=0.05)
    assert np.cov(values.T) == pytest.approx(covariance, abs=0.1)


def test_a_singular_covariance_ties_its_keys():
    values = drawn(
        {
            "distribution": "correlated",
            "keys": ["a", "b"],
            "mean": [0.0, 0.0],
            "covariance": [[1.0, 1.0], [1.0, 1.0]],
        },
        ((), ()),
        count=50,
    )
    assert values[:, 0] == pytest.approx(values[:, 1])
    assert values[:, 0].std() > 0.5


@pytest.mark.parametrize(
    ("apply", "expected"), [("replace", [2.0, 3.0]), ("add", [12.0, 23.0]), ("multiply", [20.0, 60.0])]
)
def test_what_is_drawn_replaces_shifts_or_scales(apply, expected):
    entry = PARSE({"distribution": "uniform", "key": "a", "low": 0.0, "high": 1.0, "apply": apply})
    assert entry.applied([10.0, 20.0], np.array([2.0, 3.0])) == expected


def test_limits_are_probed_and_a_mean_without_them():
    entry = PARSE({"distribution": "normal", "key": "a", "mean": 1.0, "sigma": 1.0, "high": 9.0})
    assert [values[0].tolist() for values in entry.probes(((2,),))] == [[9.0, 9.0]]
    entry = PARSE({"distribution": "normal", "key": "a", "mean": 1.0, "sigma": 1.0})
    assert [values[0].tolist() for values in entry.probes(((),))] == [1.0]
