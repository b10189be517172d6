"""Parameters by the numbers that they have on the bus, loaded and frozen by the ground."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from changed import changed
from flight_states import altered
from gate_samples import measured

from fsw.core.estimation import estimator
from fsw.core.estimation.estimator import Turning
from fsw.core.estimation.loaded import forget, freeze, load, thaw
from fsw.core.estimation.parameters import (
    NAMES,
    SIZES,
    Parameters,
    component,
    component_places,
    layout,
    with_component,
)
from fsw.core.packing import pack
from fsw.wire.messages import Component

ON_THE_BUS = {
    "mag_bias_t": "MAG_BIAS_",
    "torque_body_nm": "TORQUE_",
    "dipole_body_am2": "DIPOLE_",
    "coil_error": "COIL_",
    "inertia_error_kgm2": "INERTIA_",
    "mag_turn_rad": "MAG_TURN_",
    "mag_scale": "MAG_SCALE_",
    "sun_turn_rad": "SUN_TURN_",
    "delay_s": "_DELAY",
    "cell_excess": "CELL_",
    "cell_gain": "CELL_GAIN_",
    "earth_light": "EARTH_LIGHT",
}
BOUNDS = {"residual_dipole_am2": 0.03, "magnetometer_scale_percent": 0.4, "latency_s": 0.8}


class TestNumbers:
    def test_on_the_bus_are_those_of_the_parameters_in_their_order(self):
        named = [name for name in NAMES for _ in range(SIZES[name])]
        assert len(named) == len(Component)
        assert all(ON_THE_BUS[name] in Component(number).name for number, name in enumerate(named))
        assert [Component(number).name[-2:] for number in (11, 13, 15)] == ["XZ", "YY", "ZX"]
        assert [Component(number).name[-2:] for number in range(18, 24)] == [
            "XX",
            "YY",
            "ZZ",
            "XY",
            "XZ",
            "YZ",
        ]

    def test_each_stands_where_the_layout_has_it(self):
        places = component_places(layout({"torque_body_nm", "mag_scale", "delay_s"}))
        assert list(places.items()) == [
            (3, 6),
            (4, 7),
            (5, 8),
            (27, 9),
            (28, 10),
            (29, 11),
            (33, 12),
            (34, 13),
        ]
        assert component_places(layout(set())) == {}

    @pytest.mark.parametrize("number", Component)
    def test_another_value_of_one_leaves_the_others(self, number):
        numbers = [1.0 + n for n in range(len(Component))]
        parameters = Parameters()
        for other in Component:
            parameters = with_component(parameters, other, numbers[other])
        assert parameters.floats() == tuple(numbers)
        numbers[number] = -7.5
        after = with_component(parameters, number, -7.5)
        assert after.floats() == tuple(numbers)
        assert {name: len(getattr(after, name)) for name in NAMES} == SIZES
        assert [component(after, other) for other in Component] == numbers


@pytest.fixture(scope="module")
def settled(make_world):
    """A filter with some of the parameters, after a pulse, whose effect is traced."""
    world = make_world(flight={"uncertainty": BOUNDS})
    while world.state.estimator.estimate is None or world.state.estimator.estimate.trace is None:
        world.step()
    world.fly(5)
    state, config = world.state.estimator, world.config.estimator
    return state, config


def place_of(number, config):
    return component_places(config.mekf.layout)[number]


class TestLoad:
    NUMBER, VALUE = Component.DIPOLE_Y, -0.0123

    @pytest.fixture
    def both(self, settled):
        state, config = settled
        return state, changed(state, load, self.NUMBER, self.VALUE, config.mekf), config

    def test_its_deviation_is_that_of_the_prior_and_correlated_with_nothing(self, both):
        before, after, config = both
        place, covariance = place_of(self.NUMBER, config), after.estimate.covariance
        assert covariance[place, place] == pytest.approx(0.03**2 / 3.0)
        assert before.estimate.covariance[place, place] < 0.99 * 0.03**2 / 3.0
        others = np.arange(len(covariance)) != place
        assert np.count_nonzero(before.estimate.covariance[place, others]) == others.sum()
        assert not covariance[place, others].any()
        assert not covariance[others, place].any()

    def test_nothing_else_is_touched(self, both):
        before, after, config = both
        others = np.arange(config.mekf.layout.size) != place_of(self.NUMBER, config)
        covariances = [state.estimate.covariance[np.ix_(others, others)] for state in (before, after)]
        np.testing.assert_array_equal(*covariances)
        parameters = with_component(before.estimate.parameters, self.NUMBER, self.VALUE)
        assert after.estimate.q_body_from_eci == before.estimate.q_body_from_eci
        assert after.estimate.omega_body_radps == before.estimate.omega_body_radps
        assert after.estimate.parameters == parameters
        assert after.first == with_component(config.mekf.initial_parameters, self.NUMBER, self.VALUE)
        assert replace(after, estimate=None, first=None, loaded=()) == replace(before, estimate=None)
        assert after.loaded == (self.NUMBER,)

    @pytest.mark.interpreted
    def test_a_start_takes_what_was_loaded_and_keeps_what_it_has_found(self, both, monkeypatch):
        """As from a batch of samples of Sun cells, which finds parameters with attitude and rate."""
        before, after, config = both
        found = replace(before.estimate, trace=None)
        monkeypatch.setattr(estimator, "first_estimate", lambda *samples: found)
        waiting = changed(after, estimator.restart)
        begun = changed(waiting, estimator.update, measured(), None, config)
        parameters = with_component(found.parameters, self.NUMBER, self.VALUE)
        assert begun.estimate.parameters == parameters
        assert found.parameters != with_component(after.first, self.NUMBER, self.VALUE)
        np.testing.assert_array_equal(begun.estimate.covariance, after.estimate.covariance)
        free = changed(changed(before, estimator.restart), estimator.update, measured(), None, config)
        assert free.estimate is found, "nothing was loaded"

    def test_forgotten_it_is_back_where_the_filter_starts_from(self, settled, both):
        before, after, config = both
        forgotten = changed(before, forget, self.NUMBER, config.mekf)
        assert forgotten.estimate.parameters.dipole_body_am2[1] == 0.0
        assert (forgotten.first, forgotten.loaded) == (None, ())
        learnt = replace(
            after,
            estimate=replace(
                after.estimate, parameters=with_component(after.estimate.parameters, self.NUMBER, 0.02)
            ),
        )
        assert (
            changed(learnt, forget, self.NUMBER, config.mekf).estimate.parameters == after.estimate.parameters
        )

    def test_the_effect_of_pulses_is_traced_anew(self, both):
        assert both[1].estimate.trace is None


class TestFreeze:
    def test_values_stay_through_updates_and_attitude_and_rate_do_not(self, make_world):
        world = make_world(flight={"uncertainty": BOUNDS})
        world.fly(110)
        freeze(world.state.estimator)
        frozen = [world.state.estimator.estimate]
        for _ in range(30):
            world.step()
            frozen.append(world.state.estimator.estimate)
        assert len({estimate.parameters.floats() for estimate in frozen}) == 1
        assert all(a.omega_body_radps != b.omega_body_radps for a, b in pairwise(frozen))
        known = slice(6, None)
        walked = frozen[-1].covariance[known, known] - frozen[0].covariance[known, known]
        noise = 30 * world.config.estimator.mekf.process_noise[known, known]
        np.testing.assert_allclose(walked, noise, atol=1e-9 * frozen[0].covariance[known, known].max())
        smallest = np.linalg.eigvalsh(correlation(frozen[-1].covariance)).min()
        assert smallest > 0.0

    def test_what_pulses_did_before_corrects_them_no_more(self, settled):
        state, _ = settled
        assert state.estimate.trace.effect[6:].any()
        assert changed(state, freeze).estimate.trace is None

    def test_of_a_filter_that_estimates_none_changes_no_bit_of_the_estimate(self, make_world):
        worlds = [make_world(flight={"uncertainty": dict.fromkeys(NONE, 0.0)}) for _ in range(2)]
        for world in worlds:
            world.fly(60)
        freeze(worlds[1].state.estimator)
        for world in worlds:
            world.fly(30)
        free, frozen = (world.state.estimator.estimate for world in worlds)
        assert pack(free) == pack(frozen)
        assert free.covariance.shape == (6, 6)

    def test_a_restart_keeps_what_the_ground_has_set(self, settled):
        state, _ = settled
        frozen = changed(state, freeze)
        again = changed(frozen, estimator.restart)
        assert (again.first, again.frozen) == (state.estimate.parameters, True)
        assert again.loaded == tuple(range(len(again.first.floats()))), "every one of them"
        assert (again.estimate, again.restarts) == (None, state.restarts + 1)
        assert changed(again, thaw) == replace(again, frozen=False)


NONE = (
    "magnetometer_bias_nt",
    "torque_nm",
    "residual_dipole_am2",
    "magnetometer_misalignment_deg",
    "sun_misalignment_deg",
)


def correlation(covariance):
    sigma = np.sqrt(covariance.diagonal())
    return covariance / np.outer(sigma, sigma)


class TestFastTurn:
    """What a fast turn leaves in the parameters is given up when it ends."""

    def slowed(self, make_world, frozen):
        """The estimator before the first slow tick after a fast turn, a torque being loaded, and after it."""
        world = make_world(flight={"uncertainty": BOUNDS})
        world.fly(60)
        loaded = changed(world.state.estimator, load, Component.TORQUE_Z, 3e-8, world.config.estimator.mekf)
        fast = replace(loaded, turning=Turning.FAST, frozen=frozen)
        world.state = altered(world.state, estimator=fast)
        world.step()
        return fast, world.state.estimator

    def test_they_start_from_what_the_ground_has_loaded(self, make_world):
        before, after = self.slowed(make_world, frozen=False)
        assert after.estimate.parameters == before.first != before.estimate.parameters
        assert after.turning is Turning.NO

    def test_frozen_ones_stay(self, make_world):
        before, after = self.slowed(make_world, frozen=True)
        assert after.estimate.parameters == before.estimate.parameters != before.first
        assert after.turning is Turning.FAST
