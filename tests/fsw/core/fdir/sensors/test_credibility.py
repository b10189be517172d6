"""Which estimates can be right: every parameter within four standard deviations of its prior."""

import pytest
from estimator_samples import tuned
from with_values import with_values

from fsw.core.estimation import mekf
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.sensors.credibility import (
    are_sensors_credible,
    credibility_config,
    is_credible,
    is_credible_but_coils,
)

PRIORS = {
    "mag_bias_t": Prior((3e-7, 4e-7, 5e-7), (0.0,) * 3),
    "dipole_body_am2": Prior((0.02, 0.03, 0.04), (0.0,) * 3),
    "sun_turn_rad": Prior((0.002, 0.003, 0.004), (0.0,) * 3),
    "delay_s": Prior((0.2, 0.3), (0.0, 0.0), (0.5, 0.6)),
}
CONFIG = tuned(**PRIORS)
LIMITS = credibility_config(CONFIG)


def estimated(name, place, number):
    estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), CONFIG)
    numbers = list(getattr(estimate.parameters, name))
    numbers[place] = number
    return with_values(estimate, parameters=with_values(estimate.parameters, **{name: tuple(numbers)}))


def test_an_estimate_that_begins_is_credible():
    assert is_credible(mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), CONFIG), LIMITS)


NUMBERS = [(name, place) for name, prior in PRIORS.items() for place in range(len(prior.sigma))]


@pytest.mark.parametrize(("name", "place"), NUMBERS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_number_has_its_own_limit_about_its_own_mean(name, place, sign):
    prior = PRIORS[name]
    mean = prior.mean[place] if prior.mean else 0.0
    limit = sign * SIGMAS * prior.sigma[place]
    assert is_credible(estimated(name, place, mean + 0.99 * limit), LIMITS)
    assert not is_credible(estimated(name, place, mean + 1.01 * limit), LIMITS)


def test_what_moves_the_satellite_says_nothing_of_its_sensors():
    assert are_sensors_credible(estimated("dipole_body_am2", 1, 0.3), LIMITS)
    assert not are_sensors_credible(estimated("sun_turn_rad", 1, 0.3), LIMITS)


def test_no_number_is_not_credible():
    assert not is_credible(estimated("mag_bias_t", 2, float("nan")), LIMITS)


def test_a_weak_coil_is_none_of_the_table_but_the_rest_of_the_satellite_is():
    prior = {**PRIORS, "coil_error": Prior((0.03,) * 9, (0.0,) * 9)}
    config = tuned(**prior)
    limits = credibility_config(config)
    estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), config)
    weak = with_values(estimate.parameters, coil_error=(-0.7, *(0.0,) * 8))
    assert not is_credible(with_values(estimate, parameters=weak), limits)
    assert is_credible_but_coils(with_values(estimate, parameters=weak), limits)
    heavy = with_values(weak, dipole_body_am2=(0.0, 0.3, 0.0))
    assert not is_credible_but_coils(with_values(estimate, parameters=heavy), limits)
