"""From readings to an estimate: when the filter starts, what it takes, and when it begins anew."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from estimator_samples import (
    AGED,
    CONFIG,
    IDLE,
    MEKF,
    OFF_FIELD,
    OFF_SUN,
    Q_BODY_FROM_ECI,
    REFERENCE,
    angle_rad,
    field_message,
    seen_from,
    step,
)
from filter_steps import known_of
from gate_samples import measured

from fsw.core.algebra.quaternion import conjugate, from_small_rotation, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, add, cross, norm, scale, sub, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.dynamics.error_dynamics import NOT_DRIVEN, Driven
from fsw.core.estimation.estimator import (
    MAX_ELAPSED_S,
    NONE_USED,
    EstimatorState,
    Used,
    ease_estimate,
    update,
)
from fsw.core.estimation.measurement import field_prediction
from fsw.core.estimation.parameters import NOTHING as NO_DIFFERENCE
from fsw.wire.messages import SunVector

MAX_ELAPSED = round(MAX_ELAPSED_S / MEKF.tick_s)


BROKEN_FIELD = field_message(rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t), valid=0)
SEEN_SUN = rotate(Q_BODY_FROM_ECI, REFERENCE.sun_eci)


class TestStart:
    def test_from_field_and_sun_in_one_tick(self):
        state, used = step(EstimatorState(), seen_from())
        assert used == Used(True, True, False)
        assert angle_rad(state.estimate.q_body_from_eci, Q_BODY_FROM_ECI) < 1e-6
        assert state.estimate.omega_body_radps == ZERO
        assert (state.restarts, state.rejected_total) == (0, 0)

    @pytest.mark.parametrize("q", [(1.0, 0.0, 0.0, 0.0), (0.0, 0.6, -0.48, 0.64), (-0.5, 0.5, 0.5, -0.5)])
    def test_in_any_attitude(self, q):
        state, _ = step(EstimatorState(), seen_from(q))
        assert angle_rad(state.estimate.q_body_from_eci, q) < 1e-6

    @pytest.mark.parametrize(
        "changes",
        [
            {"field": None},
            {"sun": None},
            {"field": None, "sun": None},
            {"field": BROKEN_FIELD},
            {"sun": SunVector(0, *SEEN_SUN)},
            {"coil": None},
            {"coil": IDLE.replace(level=2)},
            {"coil": IDLE.replace(current_ma=17)},
            {"quiet": False},
            {"field": field_message(scale(1.1, rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t)))},
            {"sun": OFF_SUN},
        ],
        ids=[
            "no field",
            "no Sun",
            "nothing",
            "field not valid",
            "Sun not valid",
            "no coil status",
            "coil driven",
            "coil current",
            "a pulse not long ago",
            "strength not as modelled",
            "angle not as modelled",
        ],
    )
    def test_not_without_all_that_it_takes(self, changes):
        state, used = step(EstimatorState(), seen_from(**changes))
        assert state == EstimatorState()
        assert not used.field
        assert not used.sun

    def test_not_in_eclipse(self):
        """The sensor may be fooled by the Earth's limb; the model says there is no Sun to see."""
        state, _ = step(EstimatorState(), seen_from(), REFERENCE.replace(lit=False))
        assert state == EstimatorState()

    def test_not_with_field_and_sun_nearly_parallel(self):
        toward = unit(REFERENCE.b_eci_t)
        aside = unit(cross(toward, (0.0, 0.0, 1.0)))
        for separation_deg, starts in ((10.0, False), (20.0, True)):
            sun = tuple(
                np.cos(radians(separation_deg)) * np.array(toward)
                + np.sin(radians(separation_deg)) * np.array(aside)
            )
            reference = REFERENCE.replace(sun_eci=tuple(map(float, sun)))
            state, _ = step(EstimatorState(), seen_from(reference=reference), reference)
            assert (state.estimate is not None) is starts

    def test_says_when_it_was_blanked_while_waiting(self):
        _, used = step(EstimatorState(), seen_from(coil=IDLE.replace(level=1)))
        assert used == Used(False, False, True)


class TestRunning:
    def test_settles_on_what_the_sensors_say(self, settled):
        """The filter believes in gravity and in no other torque; the ideal body here stands still."""
        assert angle_rad(settled.estimate.q_body_from_eci, Q_BODY_FROM_ECI) < radians(0.2)
        assert norm(settled.estimate.omega_body_radps) < 1e-4

    @pytest.mark.parametrize(
        ("changes", "used"),
        [
            ({}, Used(True, True, False)),
            ({"sun": None}, Used(True, False, False)),
            ({"field": None}, Used(False, True, False)),
            ({"coil": IDLE.replace(level=1)}, Used(False, True, True)),
            ({"coil": IDLE.replace(current_ma=5)}, Used(False, True, True)),
            ({"coil": None}, Used(False, True, True)),
            ({"quiet": False}, Used(False, True, True)),
            ({"field": None, "sun": None, "coil": None}, Used(False, False, False)),
        ],
    )
    def test_takes_what_is_usable(self, settled, changes, used):
        state, said = step(settled, seen_from(**changes))
        assert said == used
        assert state.rejected_total == 0
        silent, _ = step(settled, measured())
        without, after = (s.estimate.covariance[0:3, 0:3].trace() for s in (silent, state))
        assert bool(after < without) is (used.field or used.sun)

    def test_the_coil_s_own_field_never_gets_in(self, settled):
        """A sample spoilt by 20 uT while a pulse is on leaves no trace at all."""
        pulse = IDLE.replace(level=3)
        spoilt = field_message(tuple(c + 2e-5 for c in rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t)))
        with_sample, _ = step(settled, seen_from(field=spoilt, coil=pulse))
        without, _ = step(settled, seen_from(field=None, coil=pulse))
        assert with_sample.estimate.q_body_from_eci == without.estimate.q_body_from_eci
        np.testing.assert_array_equal(with_sample.estimate.covariance, without.estimate.covariance)

    def test_an_axis_at_the_end_of_its_range_counts_for_nothing_and_the_others_as_ever(self, settled):
        """Against a filter that is given the two other numbers, in turn, each by itself."""
        open_body = unit((0.3, -0.8, 0.5))
        across = unit(cross(open_body, (1.0, 0.0, 0.0)))
        seen_t = rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t)
        clipped = field_message(add(seen_t, add(scale(-2e-5, open_body), scale(6e-7, across)))).replace(
            valid=0
        )
        state, used = step(settled, seen_from(field=clipped, sun=None, saturated=(open_body,)))
        assert used == Used(True, False, False)
        expected, _ = step(settled, measured())
        estimate = expected.estimate
        predicted, sensitivity = field_prediction(*known_of(estimate), REFERENCE.b_eci_t, MEKF)
        rows = np.array([across, cross(open_body, across)])
        before = estimate.covariance
        innovation = rows @ np.subtract([1e-9 * b for b in clipped.values()[1:4]], predicted)
        spread = (rows @ sensitivity) @ before @ (rows @ sensitivity).T + rows @ MEKF.field_noise @ rows.T
        gain = before @ (rows @ sensitivity).T @ np.linalg.inv(spread)
        turned = multiply(
            estimate.q_body_from_eci, from_small_rotation(tuple((gain @ innovation)[0:3].tolist()))
        )
        left = before - gain @ (rows @ sensitivity) @ before
        assert angle_rad(state.estimate.q_body_from_eci, turned) < 0.02 * angle_rad(
            estimate.q_body_from_eci, turned
        )
        np.testing.assert_allclose(
            state.estimate.covariance[0:6, 0:6].diagonal(), left[0:6, 0:6].diagonal(), rtol=2e-3
        )

    @pytest.mark.parametrize(
        "changes",
        [
            {"saturated": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))},
            {"saturated": ()},
            {"saturated": ((1.0, 0.0, 0.0),), "coil": IDLE.replace(level=1)},
        ],
        ids=["of two axes", "of none: not valid for another reason", "while a coil drives"],
    )
    def test_a_sample_that_is_not_valid_is_used_by_two_axes_or_not_at_all(self, settled, changes):
        _, used = step(settled, seen_from(field=BROKEN_FIELD, **changes))
        assert used == Used(False, True, True)

    def test_in_eclipse_the_magnetometer_alone_carries_on(self, settled):
        eclipse = REFERENCE.replace(lit=False)
        state = settled
        for _ in range(300):
            state, used = step(state, seen_from(sun=SunVector(0, 0.0, 0.0, 0.0)), eclipse)
        assert used == Used(True, False, False)
        assert state.restarts == 0
        assert mekf.healthy(state.estimate)

    def test_the_driven_dipole_turns_the_estimate(self, settled):
        pulse = seen_from(field=None, sun=None, coil=IDLE.replace(level=3))
        pushed, _ = step(settled, pulse, driven=[Driven((0.0, 0.0, 8.0))])
        left, _ = step(settled, pulse)
        change = np.subtract(pushed.estimate.omega_body_radps, left.estimate.omega_body_radps)
        b_body = rotate(settled.estimate.q_body_from_eci, REFERENCE.b_eci_t)
        expected = np.linalg.solve(np.array(MEKF.rotor.inertia_kgm2), np.cross((0.0, 0.0, 8.0), b_body))
        np.testing.assert_allclose(change, expected, rtol=1e-2)

    def test_gravity_turns_it_too(self, settled):
        """J dw/dt = 3 mu / r^3 e x J e - w x J w, with a body at rest and nothing else."""
        still = replace(settled.estimate, omega_body_radps=ZERO, parameters=NO_DIFFERENCE)
        after, _ = step(replace(settled, estimate=still), measured())
        e = np.array(rotate(still.q_body_from_eci, REFERENCE.r_eci_m)) / REFERENCE.radius_m
        j = np.array(MEKF.rotor.inertia_kgm2)
        pull = 3.0 * 3.986004418e14 / REFERENCE.radius_m**3 * np.linalg.solve(j, np.cross(e, j @ e))
        np.testing.assert_allclose(after.estimate.omega_body_radps, pull, rtol=1e-5)


class TestElapsedTicks:
    QUIET = measured()
    STILL = REFERENCE.replace(orbit_rate_radps=0.0)

    def test_three_ticks_at_once_are_three_ticks(self, settled):
        at_once, _ = step(settled, self.QUIET, self.STILL, driven=[NOT_DRIVEN] * 3)
        state = settled
        for _ in range(3):
            state, _ = step(state, self.QUIET, self.STILL)
        assert at_once.estimate.q_body_from_eci == state.estimate.q_body_from_eci
        np.testing.assert_array_equal(at_once.estimate.covariance, state.estimate.covariance)

    def test_each_of_them_has_its_dipole_and_its_doubt(self, settled):
        drives = [Driven((0.0, 8.0, 0.0), (0.0, 5.0, 0.0)), NOT_DRIVEN, Driven((0.0, 0.0, -2.0))]
        at_once, _ = step(settled, self.QUIET, self.STILL, driven=drives)
        state = settled
        for one in drives:
            state, _ = step(state, self.QUIET, self.STILL, driven=[one])
        assert at_once.estimate.omega_body_radps == state.estimate.omega_body_radps
        np.testing.assert_array_equal(at_once.estimate.covariance, state.estimate.covariance)
        other, _ = step(settled, self.QUIET, self.STILL, driven=drives[::-1])
        assert at_once.estimate.q_body_from_eci != other.estimate.q_body_from_eci

    def test_the_satellite_goes_on_along_its_orbit_meanwhile(self, settled):
        """What pulls at the body in a lost tick is where it was then, not where it has come to."""
        rate, q = 1.04e-3, REFERENCE.q_orbit_from_eci
        up, ahead = (rotate(conjugate(q), axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
        b_rate = (1e-8, -3e-8, 2e-8)

        def of_tick(left):
            turned = rate * left
            r = scale(REFERENCE.radius_m, add(scale(np.cos(turned), up), scale(-np.sin(turned), ahead)))
            b = sub(REFERENCE.b_eci_t, scale(left, b_rate))
            return REFERENCE.replace(r_eci_m=r, b_eci_t=b, b_rate_eci_tps=b_rate)

        drives = [Driven((0.0, 0.8, 0.0))] * 50
        at_once, _ = step(settled, self.QUIET, of_tick(0), driven=drives)
        state = settled
        for left, one in enumerate(drives, 1 - len(drives)):
            state, _ = step(state, self.QUIET, of_tick(-left), driven=[one])
        rates = [one.estimate.omega_body_radps for one in (at_once, state)]
        assert rates[0] == pytest.approx(rates[1], rel=1e-6, abs=1e-12)
        wrong, _ = step(settled, self.QUIET, of_tick(0).replace(orbit_rate_radps=0.0), driven=drives)
        assert norm(sub(wrong.estimate.omega_body_radps, rates[1])) > 1e-7

    def test_a_doubt_moves_nothing_and_is_known_of(self, settled):
        sure, _ = step(settled, self.QUIET, driven=[Driven((0.0, 8.0, 0.0))])
        unsure, _ = step(settled, self.QUIET, driven=[Driven((0.0, 8.0, 0.0), (0.0, 5.0, 0.0))])
        assert unsure.estimate.omega_body_radps == sure.estimate.omega_body_radps
        assert unsure.estimate.covariance[3:6, 3:6].trace() > sure.estimate.covariance[3:6, 3:6].trace()

    @pytest.mark.parametrize(
        ("elapsed", "survives"),
        [(1, True), (MAX_ELAPSED, True), (MAX_ELAPSED + 1, False), (10**4, False)],
    )
    def test_after_a_longer_silence_it_begins_anew(self, settled, elapsed, survives):
        state, used = step(settled, self.QUIET, driven=[NOT_DRIVEN] * elapsed)
        assert (state.estimate is not None) is survives
        assert state.restarts == (not survives)
        assert used == NONE_USED

    @pytest.mark.parametrize("tick_hz", [3, 10])
    def test_the_silence_counts_in_seconds(self, settled, tick_hz):
        faster = replace(CONFIG, mekf=replace(MEKF, tick_s=1.0 / tick_hz))
        for ticks, survives in ((60 * tick_hz, True), (60 * tick_hz + 1, False)):
            state, _ = step(settled, self.QUIET, driven=[NOT_DRIVEN] * ticks, config=faster)
            assert (state.estimate is not None) is survives

    def test_it_begins_anew_in_the_same_tick_if_it_can(self, settled):
        state, used = step(settled, seen_from(), driven=[NOT_DRIVEN] * (MAX_ELAPSED + 1))
        assert (state.restarts, used) == (1, Used(True, True, False))
        np.testing.assert_array_equal(state.estimate.covariance, MEKF.initial_covariance)


class TestRejections:
    def test_an_outlier_leaves_no_trace_but_a_count(self, settled):
        with_outlier, used = step(settled, seen_from(sun=OFF_SUN))
        without, _ = step(settled, seen_from(sun=None))
        assert used == Used(True, False, False)
        assert with_outlier.estimate.q_body_from_eci == without.estimate.q_body_from_eci
        assert (with_outlier.rejected_in_a_row, with_outlier.rejected_total) == (1, 1)

    def test_both_in_one_tick_count_twice(self, settled):
        state, used = step(settled, seen_from(sun=OFF_SUN, field=OFF_FIELD))
        assert used == NONE_USED
        assert (state.rejected_in_a_row, state.rejected_total) == (2, 2)

    def test_it_begins_anew_after_as_many_in_a_row_as_the_table_says(self, settled):
        state = settled
        for rejected in range(1, CONFIG.restart_after_rejections):
            state, _ = step(state, seen_from(sun=OFF_SUN, field=None))
            assert (state.rejected_in_a_row, state.restarts) == (rejected, 0)
        state, _ = step(state, seen_from(sun=OFF_SUN, field=None))
        assert state == EstimatorState(None, 0, CONFIG.restart_after_rejections, 1)

    @pytest.mark.parametrize("changes", [{}, {"sun": None}, {"field": None}], ids=["both", "field", "Sun"])
    def test_one_that_is_taken_ends_the_row(self, settled, changes):
        state = settled
        for _ in range(CONFIG.restart_after_rejections - 1):
            state, _ = step(state, seen_from(sun=OFF_SUN, field=None))
        state, _ = step(state, seen_from(**changes))
        assert (state.rejected_in_a_row, state.rejected_total) == (0, CONFIG.restart_after_rejections - 1)

    def test_silence_does_not_end_the_row(self, settled):
        state, _ = step(settled, seen_from(sun=OFF_SUN, field=None))
        state, _ = step(state, measured())
        assert state.rejected_in_a_row == 1

    def test_a_body_that_was_turned_unseen_is_found_again(self, settled):
        """All measurements disagree; after the row the filter starts from them and believes them."""
        turned = normalise(multiply(Q_BODY_FROM_ECI, (0.2, 0.6, -0.7, 0.3)))
        state = settled
        for _ in range(CONFIG.restart_after_rejections // 2 + 1):
            state, _ = step(state, seen_from(turned))
        assert state.restarts == 1
        assert angle_rad(state.estimate.q_body_from_eci, turned) < radians(0.1)


class TestEasing:
    def test_attitude_rate_and_bias_go_on_less_certain_and_the_rest_starts_from_its_prior(self, settled):
        state = settled.copy()
        before = state.estimate
        before.parameters.dipole_body_am2 = (0.01, -0.02, 0.03)
        before.parameters.mag_bias_t = (1e-7, -2e-7, 3e-7)
        known = before.copy()
        ease_estimate(state, MEKF)
        eased, kept = state.estimate, MEKF.layout.mag_bias.stop
        assert eased.q_body_from_eci == known.q_body_from_eci
        assert eased.omega_body_radps == known.omega_body_radps
        assert eased.parameters.mag_bias_t == known.parameters.mag_bias_t
        assert eased.parameters.dipole_body_am2 == MEKF.initial_parameters.dipole_body_am2
        np.testing.assert_array_equal(eased.covariance[:kept, :kept], 4.0 * known.covariance[:kept, :kept])
        np.testing.assert_array_equal(eased.covariance[kept:, kept:], MEKF.initial_covariance[kept:, kept:])
        assert not eased.covariance[:kept, kept:].any()
        assert (state.easings, state.restarts) == (1, settled.restarts)

    def test_without_an_estimate_nothing_is_eased(self):
        state = EstimatorState()
        ease_estimate(state, MEKF)
        assert state == EstimatorState()

    def test_what_was_loaded_from_the_ground_stays(self, settled):
        state = settled.copy()
        place = len(NO_DIFFERENCE.mag_bias_t + NO_DIFFERENCE.torque_body_nm)
        loaded = replace(NO_DIFFERENCE, dipole_body_am2=(0.02, 0.0, 0.0))
        state.first, state.loaded = loaded, (place,)
        ease_estimate(state, MEKF)
        _, y, z = MEKF.initial_parameters.dipole_body_am2
        assert state.estimate.parameters.dipole_body_am2 == (0.02, y, z)


def test_an_old_field_sample_is_of_where_the_satellite_was():
    """1.5 s ago, where the field was 750 nT different: ten times what shows in the estimate otherwise."""
    rate = (3e-7, -2e-7, 4e-7)
    reference = REFERENCE.replace(b_rate_eci_tps=rate)
    begun = mekf.start(Q_BODY_FROM_ECI, ZERO, AGED.mekf)
    old = replace(begun, parameters=replace(begun.parameters, delay_s=(1.5, 0.5)))
    then = add(REFERENCE.b_eci_t, scale(-1.5, rate))
    sampled = seen_from(field=field_message(rotate(Q_BODY_FROM_ECI, then)), sun=None)
    after = EstimatorState(old)
    used = update(after, sampled, reference, AGED)
    assert used.field
    assert after.estimate.nis < 1e-12
    assert angle_rad(after.estimate.q_body_from_eci, Q_BODY_FROM_ECI) < 1e-9
