"""Turns that are fast, and starts: when the parameters begin anew."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from changed import changed
from estimator_samples import (
    AGED,
    CONFIG,
    MEKF,
    OFF_SUN,
    Q_BODY_FROM_ECI,
    REFERENCE,
    angle_rad,
    field_message,
    seen_from,
    step,
)
from filter_steps import known_of

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import add, scale, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.dynamics.error_dynamics import NOT_DRIVEN
from fsw.core.estimation.estimator import (
    MAX_ELAPSED_S,
    EstimatorState,
    Turning,
    predict,
    update,
)
from fsw.core.estimation.measurement import field_prediction, sun_prediction
from fsw.core.packing import pack
from fsw.wire.messages import SunVector


class TestAfterAFastTurn:
    """What a fast turn leaves in the parameters is beyond their deviations: they are started once more."""

    def turning(self, settled, degps, turning=Turning.NO):
        """At this rate, with parameters that differ from their start, and sure of it all."""
        rate = scale(radians(degps), unit((0.6, -0.48, 0.64)))
        drawn_away = replace(settled.estimate.parameters, mag_bias_t=(9e-7, -8e-7, 7e-7))
        estimate = replace(settled.estimate, omega_body_radps=rate, parameters=drawn_away)
        return replace(settled, estimate=estimate, turning=turning)

    def begun_anew(self, state):
        same = state.estimate.parameters == MEKF.initial_parameters
        assert same is bool(np.array_equal(state.estimate.covariance, MEKF.initial_covariance))
        return same

    def seen_tick(self, state, **changes):
        """With samples of the attitude as estimated, from which nothing is to be learned."""
        q = state.estimate.q_body_from_eci
        bias = state.estimate.parameters.mag_bias_t
        field = field_message(add(rotate(q, REFERENCE.b_eci_t), bias))
        return changed(state, update, seen_from(q, **({"field": field} | changes)), REFERENCE, CONFIG)

    @pytest.mark.parametrize(
        ("before", "degps", "expected", "anew"),
        [
            (Turning.NO, 0.29, Turning.NO, False),
            (Turning.NO, 0.31, Turning.NO, False),
            (Turning.NO, 0.49, Turning.NO, False),
            (Turning.NO, 0.51, Turning.FAST, False),
            (Turning.NO, 5.0, Turning.FAST, False),
            (Turning.FAST, 5.0, Turning.FAST, False),
            (Turning.FAST, 0.49, Turning.FAST, False),
            (Turning.FAST, 0.31, Turning.FAST, False),
            (Turning.FAST, 0.29, Turning.NO, True),
            (Turning.KNOWN, 5.0, Turning.KNOWN, False),
            (Turning.KNOWN, 0.31, Turning.KNOWN, False),
            (Turning.KNOWN, 0.29, Turning.NO, True),
        ],
    )
    def test_it_counts_from_half_a_degree_per_second_and_ends_below_0_3(
        self, settled, before, degps, expected, anew
    ):
        after = self.seen_tick(self.turning(settled, degps, before))
        assert after.turning is expected
        assert self.begun_anew(after) is anew

    def test_a_rate_that_is_hardly_known_is_not_fast(self, settled):
        """The first ones after a start are noise: the parameters would be started again and again."""
        for sigma_degps, fast in ((1.0, False), (0.026, False), (0.024, True)):
            state = self.turning(settled, 0.6)
            covariance = state.estimate.covariance.copy()
            covariance[3:6, 3:6] = radians(sigma_degps) ** 2 * np.eye(3)
            unsure = replace(state, estimate=replace(state.estimate, covariance=covariance))
            assert bool(self.seen_tick(unsure).turning) is fast
            assert self.seen_tick(replace(unsure, turning=Turning.FAST)).turning is Turning.FAST

    def test_after_a_start_the_parameters_start_anew_once_the_rate_is_known(self, settled):
        """What the first noisy rates have taught of them is wrong; a matched satellite is no exception."""
        begun = changed(replace(settled, estimate=None), update, seen_from(), REFERENCE, CONFIG)
        assert begun.turning is Turning.FAST
        slow = self.turning(settled, 0.1, Turning.FAST)
        covariance = slow.estimate.covariance.copy()
        covariance[3:6, 3:6] = radians(0.026) ** 2 * np.eye(3)
        unsure = replace(slow, estimate=replace(slow.estimate, covariance=covariance))
        for state, anew in ((unsure, False), (slow, True)):
            after = self.seen_tick(state)
            assert self.begun_anew(after) is anew
            assert after.turning is (Turning.NO if anew else Turning.FAST)

    def test_attitude_rate_and_counts_go_on(self, settled):
        before = replace(
            self.turning(settled, 0.2, Turning.FAST), rejected_in_a_row=2, rejected_total=7, restarts=3
        )
        after = self.seen_tick(before)
        assert self.begun_anew(after)
        q, omega = before.estimate.q_body_from_eci, before.estimate.omega_body_radps
        assert after.estimate.q_body_from_eci == pytest.approx(q, abs=1e-9)
        assert after.estimate.omega_body_radps == pytest.approx(omega, abs=1e-9)
        assert after.estimate.trace is None
        assert after == EstimatorState(after.estimate, 0, 7, 3, Turning.NO)

    @pytest.mark.parametrize("changes", [{"sun": None}, {"field": None}, {"quiet": False}, {"sun": OFF_SUN}])
    def test_it_waits_for_field_and_sun_as_every_start(self, settled, changes):
        """One alone would not bring a start's covariance down: in eclipse, or while a coil conducts."""
        waiting = self.turning(settled, 0.2, Turning.FAST)
        for _ in range(3):
            waiting = self.seen_tick(waiting, **changes)
            assert waiting.turning is Turning.FAST
            assert not self.begun_anew(waiting)
        assert self.begun_anew(self.seen_tick(waiting))

    def test_it_happens_once(self, settled):
        state = self.seen_tick(self.turning(settled, 0.2, Turning.FAST))
        for _ in range(3):
            state, _ = step(state, seen_from())
            assert not self.begun_anew(state)
            assert state.turning is Turning.NO

    def test_a_tumble_that_is_braked_ends_in_one_start_of_the_parameters(self, settled):
        """From 1 deg/s to rest and not past 0.5 deg/s again: two crossings of 0.3 deg/s are one turn."""
        state, starts = settled, 0
        for degps in (1.0, 0.7, 0.45, 0.4, 0.25, 0.35, 0.45, 0.25):
            state = self.seen_tick(self.turning(settled, degps, state.turning))
            starts += self.begun_anew(state)
        assert starts == 1

    def test_a_filter_that_begins_anew_has_not_turned_fast(self, settled):
        silence = [NOT_DRIVEN] * (round(MAX_ELAPSED_S / CONFIG.mekf.tick_s) + 1)
        lost = changed(self.turning(settled, 5.0, Turning.FAST), predict, REFERENCE, silence, CONFIG)
        assert lost == EstimatorState(None, 0, settled.rejected_total, settled.restarts + 1, Turning.NO)

    def test_it_is_in_the_checksum_of_the_state(self, settled):
        assert pack(replace(settled, turning=Turning.FAST)) != pack(settled)


class TestOfAFastTurnWhoseRateIsKnown:
    """Samples of unknown age: what they seem to tell before the rate is known is forgotten, once."""

    def seen(self, sigma_degps, config=AGED, turning=Turning.FAST, **changes):
        """The state after a tick of a turn of 2 deg/s, the rate known so far to this."""
        begun = mekf.start(Q_BODY_FROM_ECI, scale(radians(2.0), unit((0.6, -0.48, 0.64))), config.mekf)
        covariance = begun.covariance.copy()
        covariance[0:6, 0:6] *= np.diag([1e-4] * 3 + [(sigma_degps / 2.0) ** 2] * 3)
        parameters = replace(begun.parameters, delay_s=(0.8, 0.7))
        sure = replace(begun, covariance=covariance, parameters=parameters)
        field, _ = field_prediction(*known_of(sure), REFERENCE.b_eci_t, config.mekf)
        sun, _ = sun_prediction(*known_of(sure), REFERENCE.sun_eci, config.mekf)
        said = {"field": field_message(field), "sun": SunVector(1, *unit(sun))} | changes
        before = EstimatorState(sure, turning=turning)
        return sure, changed(before, update, seen_from(**said), REFERENCE, config)

    def begun_anew(self, state, config=AGED):
        same = state.estimate.parameters == config.mekf.initial_parameters
        assert same is bool(np.array_equal(state.estimate.covariance, config.mekf.initial_covariance))
        return same

    def test_the_parameters_start_anew_about_this_rate(self):
        before, after = self.seen(0.024)
        assert after.turning is Turning.KNOWN
        assert self.begun_anew(after)
        assert angle_rad(after.estimate.q_body_from_eci, before.q_body_from_eci) < 1e-4
        np.testing.assert_allclose(after.estimate.omega_body_radps, before.omega_body_radps, atol=1e-6)

    def test_not_while_it_is_less_known(self):
        _, after = self.seen(0.026)
        assert after.turning is Turning.FAST
        assert not self.begun_anew(after)

    def test_not_twice(self):
        _, after = self.seen(0.024, turning=Turning.KNOWN)
        assert after.turning is Turning.KNOWN
        assert not self.begun_anew(after)

    @pytest.mark.parametrize("changes", [{"sun": None}, {"field": None}])
    def test_with_field_and_sun_as_every_start(self, changes):
        _, after = self.seen(0.024, **changes)
        assert after.turning is Turning.FAST
        assert not self.begun_anew(after)

    def test_not_where_samples_are_of_their_tick(self):
        config = replace(AGED, mekf=MEKF)
        _, after = self.seen(0.024, config)
        assert after.turning is Turning.FAST
        assert not self.begun_anew(after, config)


class TestAStartInATumble:
    """The filter begins at rest: how far it may turn between two samples, and what is claimed beyond."""

    def test_is_valid_and_true_where_it_turns_by_eight_degrees_a_tick(self, make_world):
        world = make_world(initial={"rate_degps": (5.0, -4.0, 4.0)})
        world.fly_until_valid()
        for _ in range(60):
            truth = world.plant.truth()
            world.step()
            attitude = world.state.attitude
            assert attitude.valid
            off_rad = angle_rad(attitude.q_body_from_orbit, truth.q_body_from_orbit)
            assert off_rad < 2.0 * attitude.sigma3_attitude_rad

    @pytest.mark.long
    def test_is_never_called_valid_where_it_turns_by_eighteen(self, make_world):
        world = make_world(initial={"rate_degps": (10.0, -12.0, 9.0)})
        for _ in range(400):
            world.step()
            assert not world.state.attitude.valid
