"""What the sensors should say of an estimate, and how that depends on each part of it."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_samples import Q_BODY_FROM_ECI, REFERENCE, tuned
from filter_steps import known_of
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, unit
from fsw.core.estimation.measurement import (
    both_prediction,
    deflected_sun,
    field_prediction,
    field_sampled,
    sun_prediction,
)
from fsw.core.estimation.parameters import NAMES, NOTHING, Parameters, Prior

SEEN = {
    "field": {"mag_bias_t", "mag_turn_rad", "mag_scale", "delay_s"},
    "sun": {"sun_turn_rad", "delay_s"},
}
KIND = pytest.mark.parametrize("kind", SEEN)
PREDICTION = {"field": field_prediction, "sun": sun_prediction}


def prediction(kind, satellite, estimate, config=None):
    """What should be measured, and H."""
    vector = {"field": satellite.b_eci_t, "sun": satellite.s_eci}[kind]
    return PREDICTION[kind](
        *known_of(estimate),
        vector,
        config or satellite.config(),
    )


def expected(kind, satellite, omega, parameters):
    """What should be measured at the satellite's attitude, and the direction as it is."""
    vector = {"field": satellite.b_eci_t, "sun": satellite.s_eci}[kind]
    sample, _ = PREDICTION[kind](satellite.q, omega, parameters, vector, satellite.config())
    return sample, rotate(satellite.q, vector)


def unit_of(kind, satellite):
    """Length of what is measured."""
    return np.linalg.norm(satellite.b_eci_t) if kind == "field" else 1.0


class TestExpected:
    @KIND
    def test_is_the_turned_vector_of_a_satellite_that_is_as_its_table_says(self, kind, satellite):
        sample, direction = expected(kind, satellite, satellite.omega, NOTHING)
        assert sample == direction

    @KIND
    def test_is_what_the_sensor_says_to_second_order(self, kind, full):
        """Exact turns differ by third powers of small angles; each parameter alone moves it by far more."""
        estimate = full.estimate()
        sample, _ = prediction(kind, full, estimate)
        off = np.subtract(sample, full.measured(kind, estimate)) / unit_of(kind, full)
        assert np.abs(off).max() < 1e-5
        for name in SEEN[kind]:
            known = replace(estimate.parameters, **{name: getattr(NOTHING, name)})
            without, _ = prediction(kind, full, replace(estimate, parameters=known))
            moved = np.abs(np.subtract(sample, without)).max() / unit_of(kind, full)
            assert moved > 1e-3

    @pytest.mark.parametrize("name", NAMES)
    @KIND
    def test_nothing_but_the_sensor_s_own_parameters_shows_in_it(self, kind, name, full):
        only = replace(NOTHING, **{name: getattr(full.parameters, name)})
        sample, direction = expected(kind, full, full.omega, only)
        assert (sample != direction) is (name in SEEN[kind])

    @KIND
    def test_each_sensor_has_its_own_age(self, kind, full):
        of_the_other = Parameters(delay_s=(0.0, 0.7) if kind == "field" else (0.4, 0.0))
        sample, direction = expected(kind, full, full.omega, of_the_other)
        assert sample == direction

    @KIND
    def test_a_late_sample_of_a_body_at_rest_is_as_good_as_a_new_one(self, kind, full):
        sample, direction = expected(kind, full, ZERO, Parameters(delay_s=(0.4, 0.7)))
        assert sample == direction


@KIND
class TestPrediction:
    def test_the_sensitivity_is_the_derivative_where_the_satellite_is_as_its_table_says(
        self, kind, satellite
    ):
        estimate = satellite.estimate(parameters=NOTHING)
        _, found = prediction(kind, satellite, estimate)
        assert found.shape == (3, satellite.size())
        scaled = satellite.scales() / unit_of(kind, satellite)
        expected = satellite.sensitivity(kind, estimate)
        np.testing.assert_allclose(found * scaled, expected * scaled, rtol=0.0, atol=1e-8)

    def test_elsewhere_it_is_to_the_order_of_the_parameters(self, kind, full):
        """At 2.7 deg/s, half a second late: 1 % of each."""
        estimate = full.estimate()
        _, found = prediction(kind, full, estimate)
        expected = full.sensitivity(kind, estimate)
        for name in sorted(SEEN[kind]):
            columns = full.place(name)
            off = np.abs(found[:, columns] - expected[:, columns]).max()
            assert off < 0.012 * np.abs(expected[:, columns]).max()
        off = np.abs(found[:, 0:3] - expected[:, 0:3]).max()
        assert off < 0.01 * np.abs(expected[:, 0:3]).max()

    def test_it_is_zero_for_all_that_the_sensor_does_not_see(self, kind, full):
        _, found = prediction(kind, full, full.estimate())
        for name in set(NAMES) - SEEN[kind]:
            assert not found[:, full.place(name)].any()
        for name in SEEN[kind] - {"delay_s"}:
            assert found[:, full.place(name)].any(axis=0).all()
        late = found[:, full.place("delay_s")].any(axis=0)
        assert late.tolist() == [kind == "field", kind == "sun"]

    def test_the_rate_shows_in_a_late_sample_alone(self, kind, full):
        """By as much as the body turns while it ages."""
        estimate = full.estimate()
        found, expected = prediction(kind, full, estimate)[1], full.sensitivity(kind, estimate)
        np.testing.assert_allclose(
            found[:, 3:6], expected[:, 3:6], rtol=0.0, atol=0.03 * np.abs(expected[:, 3:6]).max()
        )
        in_time = replace(estimate, parameters=replace(estimate.parameters, delay_s=(0.0, 0.0)))
        assert found[:, 3:6].any()
        assert not prediction(kind, full, in_time)[1][:, 3:6].any()

    def test_a_turn_of_the_sensor_looks_as_a_turn_of_the_body_then(self, kind, full):
        """Why no measurement can tell the common turn of both sensors from an attitude."""
        estimate = full.estimate()
        in_time = replace(estimate, parameters=replace(estimate.parameters, delay_s=(0.0, 0.0)))
        place = full.place({"field": "mag_turn_rad", "sun": "sun_turn_rad"}[kind])
        _, found = prediction(kind, full, in_time)
        np.testing.assert_array_equal(found[:, place], found[:, 0:3])
        _, late = prediction(kind, full, estimate)
        delay_s = estimate.parameters.delay_s[kind == "sun"]
        since = Rotation.from_rotvec(delay_s * np.array(full.omega)).as_matrix()
        np.testing.assert_allclose(
            late[:, 0:3], late[:, place] @ since, rtol=0.0, atol=1e-3 * unit_of(kind, full)
        )
        assert np.abs(late[:, 0:3] - late[:, place]).max() > 5e-3 * unit_of(kind, full)

    def test_a_turn_along_the_rate_looks_as_a_greater_age(self, kind, full):
        """No sample tells them apart, at whatever rate."""
        for rate in (full.omega, (0.07, 0.05, -0.06)):
            _, found = prediction(kind, full, replace(full.estimate(), omega_body_radps=rate))
            age = found[:, full.place("delay_s")][:, ("field", "sun").index(kind)]
            np.testing.assert_allclose(found[:, 0:3] @ rate, -age, rtol=0.0, atol=1e-12 * unit_of(kind, full))
            assert np.abs(age).max() > 1e-3 * unit_of(kind, full)

    def test_what_is_prepared_stays_as_it_is(self, kind, full):
        config = full.config()
        kept = [config.field_sensitivity.copy(), config.sun_sensitivity.copy()]
        prediction(kind, full, full.estimate(), config)
        np.testing.assert_array_equal(config.field_sensitivity, kept[0])
        np.testing.assert_array_equal(config.sun_sensitivity, kept[1])


def test_the_field_of_an_old_sample_is_that_of_where_the_satellite_was(full):
    """By its own age, not that of the Sun's."""
    rate = (3e-8, -2e-8, 4e-8)
    found = field_sampled(Parameters(delay_s=(0.5, 3.0)), full.b_eci_t, rate)
    np.testing.assert_allclose(found, np.subtract(full.b_eci_t, np.multiply(0.5, rate)), rtol=1e-15)
    assert field_sampled(NOTHING, full.b_eci_t, rate) == full.b_eci_t


class TestEarthlight:
    """It turns what a Sun sensor takes for the Sun; the filter may carry the albedo."""

    CONFIG = tuned(
        sun_turn_rad=Prior((0.01,) * 3, (0.0,) * 3), earth_light=Prior((0.1,), (0.0,), mean=(0.2,))
    )
    SUNLIT = REFERENCE.replace(sun_eci=unit((0.5, -0.6, 0.7)))

    def turned(self, albedo, config=CONFIG):
        parameters = replace(NOTHING, sun_turn_rad=(0.01, -0.02, 0.015), earth_light=(albedo,))
        s_eci, slope_eci = deflected_sun(parameters, self.SUNLIT, config)
        omega = (0.001, -0.002, 0.003)
        return sun_prediction(Q_BODY_FROM_ECI, omega, parameters, s_eci, config, slope_eci)

    def test_the_sensitivity_is_the_derivative(self):
        _, found = self.turned(0.25)
        (ahead, _), (behind, _) = self.turned(0.25 + 1e-6), self.turned(0.25 - 1e-6)
        column = found[:, self.CONFIG.layout.earth_light.start]
        np.testing.assert_allclose(column, (np.array(ahead) - behind) / 2e-6, atol=0.03 * abs(column).max())
        assert abs(column).max() > 0.1

    def test_of_both_sensors_it_stands_in_the_rows_of_the_sun(self):
        parameters = replace(NOTHING, earth_light=(0.25,))
        sun = deflected_sun(parameters, self.SUNLIT, self.CONFIG)
        known = (Q_BODY_FROM_ECI, ZERO, parameters)
        _, alone = sun_prediction(*known, sun[0], self.CONFIG, sun[1])
        _, _, both = both_prediction(*known, (1e-5, 2e-5, 3e-5), sun[0], self.CONFIG, sun[1])
        place = self.CONFIG.layout.earth_light.start
        np.testing.assert_array_equal(both[3:6, place], alone[:, place])
        assert not both[0:3, place].any()

    def test_without_it_the_sun_is_where_it_is(self):
        config = tuned(sun_turn_rad=Prior((0.01,) * 3, (0.0,) * 3))
        assert deflected_sun(NOTHING, self.SUNLIT, config) == (self.SUNLIT.sun_eci, ZERO)
