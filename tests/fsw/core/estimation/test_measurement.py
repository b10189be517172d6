"""What the sensors should say of an estimate, and how that depends on each part of it."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.measurement import expected_field, expected_sun, field_prediction, sun_prediction
from fsw.core.estimation.parameters import NAMES, NOTHING, Parameters

SEEN = {
    "field": {"mag_bias_t", "mag_turn_rad", "mag_scale", "delay_s"},
    "sun": {"sun_turn_rad", "delay_s"},
}
KIND = pytest.mark.parametrize("kind", SEEN)
EXPECTED = {"field": expected_field, "sun": expected_sun}


def prediction(kind, satellite, estimate, config=None):
    """What should be measured, and H."""
    predict = {"field": field_prediction, "sun": sun_prediction}[kind]
    vector = {"field": satellite.b_eci_t, "sun": satellite.s_eci}[kind]
    return predict(*estimate[:3], vector, config or satellite.config())


def unit_of(kind, satellite):
    """Length of what is measured."""
    return np.linalg.norm(satellite.b_eci_t) if kind == "field" else 1.0


class TestExpected:
    @KIND
    def test_is_the_turned_vector_of_a_satellite_that_is_as_its_table_says(self, kind, satellite):
        vector = {"field": satellite.b_eci_t, "sun": satellite.s_eci}[kind]
        expected = EXPECTED[kind](satellite.q, satellite.omega, NOTHING, vector)
        assert expected == rotate(satellite.q, vector)

    @KIND
    def test_is_what_the_sensor_says_to_second_order(self, kind, full):
        """Exact turns differ by third powers of small angles; each parameter alone moves it by far more."""
        estimate = full.estimate()
        vector = {"field": full.b_eci_t, "sun": full.s_eci}[kind]
        expected = EXPECTED[kind](*estimate[:3], vector)
        off = np.subtract(expected, full.measured(kind, estimate)) / unit_of(kind, full)
        assert np.abs(off).max() < 1e-5
        for name in SEEN[kind]:
            without = EXPECTED[kind](
                *estimate[:2], estimate.parameters._replace(**{name: getattr(NOTHING, name)}), vector
            )
            moved = np.abs(np.subtract(expected, without)).max() / unit_of(kind, full)
            assert moved > 1e-3

    @pytest.mark.parametrize("name", NAMES)
    @KIND
    def test_nothing_but_the_sensor_s_own_parameters_shows_in_it(self, kind, name, full):
        vector = {"field": full.b_eci_t, "sun": full.s_eci}[kind]
        only = NOTHING._replace(**{name: getattr(full.parameters, name)})
        changed = EXPECTED[kind](full.q, full.omega, only, vector) != rotate(full.q, vector)
        assert changed is (name in SEEN[kind])

    def test_each_sensor_has_its_own_age(self, full):
        field_late, sun_late = Parameters(delay_s=(0.4, 0.0)), Parameters(delay_s=(0.0, 0.7))
        assert expected_sun(full.q, full.omega, field_late, full.s_eci) == rotate(full.q, full.s_eci)
        assert expected_field(full.q, full.omega, sun_late, full.b_eci_t) == rotate(full.q, full.b_eci_t)

    def test_a_late_sample_of_a_body_at_rest_is_as_good_as_a_new_one(self, full):
        late = Parameters(delay_s=(0.4, 0.7))
        assert expected_field(full.q, ZERO, late, full.b_eci_t) == rotate(full.q, full.b_eci_t)
        assert expected_sun(full.q, ZERO, late, full.s_eci) == rotate(full.q, full.s_eci)


@KIND
class TestPrediction:
    def test_is_what_is_expected(self, kind, satellite):
        estimate = satellite.estimate()
        vector = {"field": satellite.b_eci_t, "sun": satellite.s_eci}[kind]
        predicted, _ = prediction(kind, satellite, estimate)
        assert predicted == EXPECTED[kind](*estimate[:3], vector)

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
        """At 2.7 deg/s, half a second late: 4 % of the attitude's columns, 1 % of the others."""
        estimate = full.estimate()
        _, found = prediction(kind, full, estimate)
        expected = full.sensitivity(kind, estimate)
        for name in sorted(SEEN[kind]):
            columns = full.place(name)
            off = np.abs(found[:, columns] - expected[:, columns]).max()
            assert off < 0.01 * np.abs(expected[:, columns]).max()
        off = np.abs(found[:, 0:3] - expected[:, 0:3]).max()
        assert off < 0.04 * np.abs(expected[:, 0:3]).max()

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
        in_time = estimate._replace(parameters=estimate.parameters._replace(delay_s=(0.0, 0.0)))
        assert found[:, 3:6].any()
        assert not prediction(kind, full, in_time)[1][:, 3:6].any()

    def test_a_turn_of_the_sensor_looks_as_a_turn_of_the_body(self, kind, full):
        """Why no measurement can tell the common turn of both sensors from an attitude."""
        _, found = prediction(kind, full, full.estimate())
        name = {"field": "mag_turn_rad", "sun": "sun_turn_rad"}[kind]
        np.testing.assert_array_equal(found[:, full.place(name)], found[:, 0:3])

    def test_what_is_prepared_stays_as_it_is(self, kind, full):
        config = full.config()
        kept = [config.field_sensitivity.copy(), config.sun_sensitivity.copy()]
        prediction(kind, full, full.estimate(), config)
        np.testing.assert_array_equal(config.field_sensitivity, kept[0])
        np.testing.assert_array_equal(config.sun_sensitivity, kept[1])
