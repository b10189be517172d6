"""The number of integration steps of a tick."""

from math import nextafter

import pytest

from sim.plant.config import BodyConfig
from sim.plant.dynamics.substeps import MOST_RAD, Substeps
from sim.plant.errors import PlantError
from sim.plant.rotation import ZERO
from sim.plant.wheel_config import WheelConfig

DIAGONAL = ((0.2, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.3))


@pytest.mark.parametrize(
    ("tick_hz", "max_substep_s", "count"), [(1, 1.0, 1), (1, 0.3, 4), (4, 1.0, 1), (4, 0.1, 3), (10, 0.1, 1)]
)
def test_those_of_a_slow_motion(make_config, tick_hz, max_substep_s, count):
    steps = Substeps(make_config(tick_hz=tick_hz, max_substep_s=max_substep_s)).of(3, ZERO)
    assert (steps.number, steps.step_s) == (count, 1.0 / (tick_hz * count))
    assert len(steps.stages) == 2 * count + 1


@pytest.mark.parametrize(
    ("tick_hz", "rate_radps", "count"),
    [
        (1, MOST_RAD, 1),
        (1, nextafter(MOST_RAD, 1.0), 2),
        (1, 3.5, 32),
        (10, 1.5, 1),
        (10, 3.5, 4),
    ],
)
def test_they_are_doubled_until_none_turns_the_body_too_far(make_config, tick_hz, rate_radps, count):
    steps = Substeps(make_config(tick_hz=tick_hz)).of(0, (0.0, -rate_radps, 0.0))
    assert (steps.number, len(steps.stages)) == (count, 2 * count + 1)


def test_a_wheel_counts_by_the_least_moment_of_inertia(make_config):
    constant = Substeps(make_config(body=BodyConfig(DIAGONAL, (0.0, 0.0, -0.02))))
    assert constant.of(0, ZERO).number == 2
    assert constant.of(0, (0.0, 0.2, 0.0)).number == 4
    wheel = WheelConfig((0.0, 1.0, 0.0), 0.05, 1e-3, 1.0)
    driven = Substeps(make_config(body=BodyConfig(DIAGONAL), wheel=wheel))
    assert driven.of(0, ZERO, 0.007).number == 1
    assert driven.of(0, ZERO, -0.008).number == 2  # 0.05 kg m^2 turn with the body about axis 2


def test_the_surroundings_of_a_tick_are_the_same_on_every_grid(make_config):
    substeps = Substeps(make_config())
    slow, fast = substeps.of(7, ZERO).stages, substeps.of(7, (0.0, 0.0, 0.5)).stages
    assert fast[::4] == slow


@pytest.mark.parametrize("rate_radps", [400.0, 1e200, float("inf")])
def test_a_motion_that_is_too_fast_for_any_is_an_error(make_config, rate_radps):
    with pytest.raises(PlantError, match="the motion diverges in tick 9: too fast"):
        Substeps(make_config()).of(9, (rate_radps, 0.0, 0.0))
