"""Parameters of the filter by telecommand: loaded, frozen, thawed; and what a clear leaves of the state."""

from dataclasses import replace

import numpy as np
import pytest
from flight_states import altered

from fsw.core.estimation.kalman import Trace
from fsw.core.estimation.parameters import NOTHING as AS_THE_TABLE
from fsw.core.estimation.parameters import component_places, with_component
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.sensors.credibility import is_credible
from fsw.core.modes import ModeState
from fsw.core.packing import pack
from fsw.wire.messages import (
    Component,
    Mode,
    TcAckResult,
    TcClear,
    TcFreeze,
    TcParameter,
)

TICK = 40


EVERYTHING = {
    "inertia_percent": 30.0,
    "products_percent": 20.0,
    "residual_dipole_am2": 0.03,
    "coil_gain_percent": 5.0,
    "coil_misalignment_deg": 0.7,
    "magnetometer_scale_percent": 0.4,
    "magnetometer_misalignment_deg": 0.9,
    "sun_misalignment_deg": 0.6,
    "latency_s": 0.8,
}


OF_CELLS = [one for one in Component if one.name.startswith("CELL_") or one is Component.EARTH_LIGHT]


NO_BODY = [
    (
        TcParameter(Component.INERTIA_XX, -2, -70),
        TcParameter(Component.INERTIA_YY, -2, -100, counter=1),
        TcParameter(Component.INERTIA_XY, -2, 55, counter=2),
    ),
    (
        TcParameter(Component.INERTIA_YY, -2, -128),
        TcParameter(Component.INERTIA_ZZ, -2, -135, counter=1),
        TcParameter(Component.INERTIA_YZ, -2, 60, counter=2),
    ),
    (
        TcParameter(Component.INERTIA_ZZ, -2, -130),
        TcParameter(Component.INERTIA_XX, -2, -70, counter=1),
        TcParameter(Component.INERTIA_XZ, -2, -55, counter=2),
    ),
]
"""Two moments and a product that together are the inertia of no body."""


@pytest.fixture(scope="module")
def estimating(make_world):
    """A flight with every parameter carried: configuration, and state with an estimate."""
    world = make_world(flight={"uncertainty": EVERYTHING})
    world.fly(TICK + 1)
    assert world.state.tick == TICK
    return world.config, world.state


def range_of(config, parameter):
    """The least and the largest value that may be loaded."""
    mekf = config.estimator.mekf
    place, mean = component_places(mekf.layout)[parameter], mekf.initial_parameters.floats()[parameter]
    most = SIGMAS * float(mekf.initial_covariance[place, place]) ** 0.5
    return mean - most, mean + most


class TestParameter:
    @pytest.mark.parametrize("parameter", [one for one in Component if one not in OF_CELLS])
    def test_the_filter_goes_on_from_the_value_and_starts_from_it(self, obey, estimating, parameter):
        config, state = estimating
        exponent = -15 if parameter.name.startswith("TORQUE") else -9
        after, results = obey(state, TcParameter(parameter, exponent, -321), config=config)
        value = float(f"-321e{exponent}")
        before = state.estimator.estimate
        assert results == [TcAckResult.ACCEPTED]
        assert after.estimator.estimate.parameters == with_component(before.parameters, parameter, value)
        first = config.estimator.mekf.initial_parameters
        assert after.estimator.first == with_component(first, parameter, value)
        assert pack(altered(after, estimator=state.estimator)) == pack(state)

    def test_a_second_one_keeps_the_first(self, obey, estimating):
        config, state = estimating
        sent = (TcParameter(Component.TORQUE_Y, -10, 7), TcParameter(Component.SUN_DELAY, -1, 3, counter=1))
        after, _ = obey(state, *sent, config=config)
        assert after.estimator.first == replace(
            AS_THE_TABLE, torque_body_nm=(0.0, 7e-10, 0.0), delay_s=(0.4, 0.3)
        )

    def test_before_the_filter_has_started_it_waits_for_the_start(self, obey, estimating):
        config, state = estimating
        waiting = altered(state, estimator=replace(state.estimator, estimate=None))
        after, results = obey(waiting, TcParameter(Component.MAG_BIAS_Z, -9, 250), config=config)
        assert results == [TcAckResult.ACCEPTED]
        assert after.estimator.estimate is None
        assert after.estimator.first == replace(
            AS_THE_TABLE, mag_bias_t=(0.0, 0.0, 2.5e-7), delay_s=(0.4, 0.4)
        )

    @pytest.mark.parametrize("parameter", [Component.MAG_BIAS_X, Component.COIL_YZ, Component.MAG_DELAY])
    def test_is_taken_exactly_where_an_estimate_of_it_is_trusted(self, obey, refused, estimating, parameter):
        config, state = estimating
        for limit, outward in zip(range_of(config, parameter), (-1, 1), strict=True):
            edge = int(1e9 * limit)
            inside, beyond = (TcParameter(parameter, -9, edge + step) for step in (-outward, outward))
            after, results = obey(state, inside, config=config)
            assert results == [TcAckResult.ACCEPTED]
            assert is_credible(after.estimator.estimate, config.fdir.sensors.credibility)
            refused(TcAckResult.OUT_OF_RANGE, beyond, start=state, config=config)
            value = 1e-9 * (edge + outward)
            strange = with_component(after.estimator.estimate.parameters, parameter, value)
            off = replace(after.estimator.estimate, parameters=strange)
            assert not is_credible(off, config.fdir.sensors.credibility)

    @pytest.mark.parametrize("sent", NO_BODY, ids=["products of x and y", "of y and z", "of x and z"])
    @pytest.mark.parametrize("started", [True, False])
    def test_of_an_inertia_that_no_body_has_is_refused(self, obey, refused, estimating, sent, started):
        """Each number by itself could be a body's."""
        config, state = estimating
        start = state if started else altered(state, estimator=replace(state.estimator, estimate=None))
        for one in sent:
            assert obey(start, one, config=config)[1] == [TcAckResult.ACCEPTED]
        assert obey(start, *sent[:-1], config=config)[1] == [TcAckResult.ACCEPTED] * 2
        refused(TcAckResult.OUT_OF_RANGE, *sent, start=start, config=config)

    @pytest.mark.parametrize("of_the_estimate", [True, False])
    def test_neither_the_estimate_nor_the_start_may_have_one(
        self, obey, refused, estimating, of_the_estimate
    ):
        """A product that the moments of one allow is too large for the smaller ones of the other."""
        config, state = estimating
        *moments, product = NO_BODY[0]
        small = obey(state, *moments, config=config)[0].estimator
        mixed = replace(state.estimator, first=small.first)
        if of_the_estimate:
            mixed = replace(small, first=state.estimator.first)
        refused(TcAckResult.OUT_OF_RANGE, product, start=altered(state, estimator=mixed), config=config)

    def test_that_the_filter_does_not_carry(self, refused, config):
        known = component_places(config.estimator.mekf.layout)
        assert 0 < len(known) < len(Component)
        for parameter in set(Component) - set(known):
            refused(TcAckResult.NOT_ALLOWED, TcParameter(parameter, -12, 1))

    def test_without_a_filter(self, refused, make_world, state):
        perfect = make_world(knowledge="perfect").config
        refused(TcAckResult.NOT_ALLOWED, TcParameter(Component.TORQUE_X, -9, 1), start=state, config=perfect)

    @pytest.mark.parametrize("number", range(len(Component), 64))
    def test_there_are_no_more(self, refused, estimating, number):
        config, state = estimating
        refused(TcAckResult.UNKNOWN, TcParameter(number, -12, 1), start=state, config=config)

    @pytest.mark.parametrize("parameter", OF_CELLS)
    def test_a_satellite_without_cells_has_no_excess_of_them(self, refused, estimating, parameter):
        config, state = estimating
        refused(TcAckResult.NOT_ALLOWED, TcParameter(parameter, -3, 1), start=state, config=config)


class TestClear:
    def test_the_filter_goes_on_without_the_trace_by_which_units_are_judged(self, obey, estimating):
        config, state = estimating
        estimator = state.estimator
        traced = replace(
            estimator,
            estimate=replace(estimator.estimate, trace=Trace((), np.zeros((6, 1)), np.zeros((1, 1)), 0)),
        )
        after, results = obey(altered(state, estimator=traced), TcClear(), config=config)
        assert results == [TcAckResult.ACCEPTED]
        assert after.estimator.estimate.trace is None
        assert after.estimator.estimate.parameters == estimator.estimate.parameters

    @pytest.mark.parametrize("held", [True, False])
    def test_a_commanded_safe_stays_commanded(self, obey, state, held):
        safe = altered(state, modes=ModeState(Mode.SAFE, 7, trips=2, held=held))
        after, _ = obey(safe, TcClear())
        assert after.modes == ModeState(Mode.SAFE, 7, trips=0, held=held)


class TestFreeze:
    def test_values_stay_and_are_those_of_the_next_start(self, obey, estimating):
        config, state = estimating
        after, results = obey(state, TcFreeze(1), config=config)
        assert results == [TcAckResult.ACCEPTED]
        assert after.estimator.frozen
        assert after.estimator.first == state.estimator.estimate.parameters != AS_THE_TABLE
        assert after.estimator.estimate is not None

    def test_thaw_estimates_again_and_keeps_the_start(self, obey, estimating):
        config, state = estimating
        frozen, _ = obey(state, TcFreeze(1), config=config)
        after, results = obey(frozen, TcFreeze(0, 1), config=config)
        assert results == [TcAckResult.ACCEPTED]
        assert pack(after.estimator) == pack(replace(frozen.estimator, frozen=False))

    def test_before_the_filter_has_started_what_was_loaded_is_kept(self, obey, state):
        sent = (TcParameter(Component.TORQUE_Z, -9, -40), TcFreeze(1))
        after, results = obey(state, *sent)
        assert results == [TcAckResult.ACCEPTED] * 2
        first = replace(AS_THE_TABLE, torque_body_nm=(0.0, 0.0, -4e-8))
        loaded = (Component.TORQUE_Z,)
        assert after.estimator == replace(state.estimator, first=first, frozen=True, loaded=loaded)
