"""From the bounds of what a table may be wrong by to the priors of the filter."""

from dataclasses import fields
from math import hypot, radians, sqrt

import numpy as np
import pytest

from fsw.core.estimation.parameters import NAMES, OF_CELLS, SIZES
from fsw.input.schema import TableError, merge
from fsw.table.table import flight_table
from fsw.table.uncertainty import Ordinary, Uncertainty, UncertaintyTable, bounds, priors

INERTIA = ((1.2, 0.03, -0.02), (0.03, 1.5, 0.05), (-0.02, 0.05, 2.1))
ORDINARY = Ordinary(dipole_am2=0.07, torque_nm=2e-8, latency_s=0.25, shadow_impulse_nms=5e-5, pulse_am2=6.0)
EXACT = dict.fromkeys(UncertaintyTable.model_fields, 0.0)
GIVEN = {
    "inertia_percent": 8.0,
    "products_percent": 3.0,
    "residual_dipole_am2": 0.04,
    "coil_gain_percent": 6.0,
    "coil_misalignment_deg": 0.7,
    "magnetometer_bias_nt": 900.0,
    "magnetometer_scale_percent": 0.4,
    "magnetometer_misalignment_deg": 1.5,
    "sun_misalignment_deg": 0.25,
    "torque_nm": 7e-8,
    "torque_variation_nm": 9e-9,
    "along_track_km": 11.0,
    "latency_s": 1.8,
    "magnetometer_orbit_nt": 300.0,
    "magnetometer_shadow_nt": 700.0,
    "storm_nt": 220.0,
    "shadow_dipole_am2": 0.03,
    "remanence_percent": 0.2,
    "albedo_percent": 40.0,
    "shadow_impulse_nms": 3e-5,
}
CARRIED_BY = {
    "inertia_percent": "inertia_error_kgm2",
    "products_percent": "inertia_error_kgm2",
    "residual_dipole_am2": "dipole_body_am2",
    "coil_gain_percent": "coil_error",
    "coil_misalignment_deg": "coil_error",
    "magnetometer_bias_nt": "mag_bias_t",
    "magnetometer_scale_percent": "mag_scale",
    "magnetometer_misalignment_deg": "mag_turn_rad",
    "sun_misalignment_deg": "sun_turn_rad",
    "torque_nm": "torque_body_nm",
    "torque_variation_nm": None,
    "along_track_km": None,
    "latency_s": "delay_s",
    "magnetometer_orbit_nt": "mag_bias_t",
    "magnetometer_shadow_nt": "mag_bias_t",
    "storm_nt": None,
    "shadow_dipole_am2": "dipole_body_am2",
    "remanence_percent": "dipole_body_am2",
    "albedo_percent": "earth_light",
    "shadow_impulse_nms": None,
}


def bounds_of(**given):
    return bounds(UncertaintyTable(**given), ORDINARY)


def priors_of(**given):
    return priors(bounds_of(**given), INERTIA)


class TestBounds:
    def test_of_a_table_are_taken_in_si(self):
        assert bounds_of(**GIVEN) == Uncertainty(
            inertia_part=pytest.approx(0.08),
            products_part=pytest.approx(0.03),
            dipole_am2=0.04,
            coil_gain_part=pytest.approx(0.06),
            coil_turn_rad=pytest.approx(radians(0.7)),
            mag_bias_t=pytest.approx(9e-7),
            mag_scale_part=pytest.approx(0.004),
            mag_turn_rad=pytest.approx(radians(1.5)),
            sun_turn_rad=pytest.approx(radians(0.25)),
            torque_nm=7e-8,
            torque_variation_nm=9e-9,
            along_track_m=pytest.approx(11e3),
            latency_s=1.8,
            mag_orbit_t=pytest.approx(3e-7),
            mag_shadow_t=pytest.approx(7e-7),
            storm_t=pytest.approx(2.2e-7),
            shadow_dipole_am2=0.03,
            remanence_part=pytest.approx(0.002),
            pulse_am2=6.0,
            albedo=pytest.approx(0.4),
            shadow_impulse_nms=3e-5,
        )

    def test_left_out_are_ordinary_ones_and_none_of_them_zero(self):
        ordinary = bounds_of()
        assert ordinary == Uncertainty(
            inertia_part=pytest.approx(0.1),
            products_part=pytest.approx(0.02),
            dipole_am2=0.07,
            coil_gain_part=pytest.approx(0.05),
            coil_turn_rad=pytest.approx(radians(0.5)),
            mag_bias_t=pytest.approx(1e-6),
            mag_scale_part=pytest.approx(0.005),
            mag_turn_rad=pytest.approx(radians(1.0)),
            sun_turn_rad=pytest.approx(radians(0.5)),
            torque_nm=2e-8,
            torque_variation_nm=pytest.approx(4e-9),
            along_track_m=pytest.approx(5e3),
            latency_s=0.25,
            mag_orbit_t=pytest.approx(2.5e-7),
            mag_shadow_t=pytest.approx(4e-7),
            storm_t=pytest.approx(1.5e-7),
            shadow_dipole_am2=pytest.approx(0.0049),
            remanence_part=pytest.approx(0.003),
            pulse_am2=6.0,
            albedo=pytest.approx(0.6),
            shadow_impulse_nms=5e-5,
        )
        of_cells = ("cell_gain_part", "cell_light", "cell_excess", "earth_light")
        known = [field.name for field in fields(Uncertainty) if field.name not in of_cells]
        assert all(getattr(ordinary, name) > 0.0 for name in known)
        assert not any(getattr(ordinary, name) for name in of_cells)  # there are none
        without_pulses = bounds(UncertaintyTable(remanence_percent=3.0), ORDINARY._replace(pulse_am2=0.0))
        assert without_pulses.remanence_part == 0.0

    @pytest.mark.parametrize("key", GIVEN)
    def test_each_is_taken_for_itself_and_zero_is_no_ordinary_value(self, key):
        given = {  # else they are a part of it
            "torque_nm": {"torque_variation_nm": 4e-9},
            "residual_dipole_am2": {"shadow_dipole_am2": 0.01},
        }.get(key, {})
        ordinary, exact = bounds_of(**given), bounds_of(**given, **{key: 0.0})
        changed = [
            field.name
            for field in fields(Uncertainty)
            if getattr(ordinary, field.name) != getattr(exact, field.name)
        ]
        assert len(changed) == 1
        assert getattr(exact, changed[0]) == 0.0


class TestPriors:
    def test_a_deviation_is_uniform_within_its_bound(self):
        """Standard deviation bound / sqrt 3 by component; of a turn of any axis angle / sqrt 5."""
        found = priors_of(**GIVEN)
        side, ball = 1.0 / sqrt(3.0), 1.0 / sqrt(5.0)
        gain, axis = 0.06 * side, radians(0.7) * side
        expected = {
            "mag_bias_t": [hypot(9e-7, 3e-7, 7e-7) * side] * 3,
            "torque_body_nm": [7e-8 * side] * 3,
            "dipole_body_am2": [hypot(0.04, 0.03, 0.002 * 6.0) * side] * 3,
            "coil_error": [gain, axis, axis, axis, gain, axis, axis, axis, gain],
            "inertia_error_kgm2": [0.096 * side, 0.12 * side, 0.168 * side, *[0.048 * side] * 3],
            "mag_turn_rad": [radians(1.5) * ball] * 3,
            "mag_scale": [0.004 * side] * 3,
            "sun_turn_rad": [radians(0.25) * ball] * 3,
            "delay_s": [0.9 * side] * 2,
            "earth_light": [0.2 * side],
        }
        assert list(found) == [name for name in NAMES if name in expected]
        for name, sigma in expected.items():
            assert found[name].sigma == pytest.approx(sigma)
            assert len(found[name].sigma) == len(found[name].walk) == SIZES[name]

    @pytest.mark.parametrize(
        ("shape", "sample"),
        [
            (1.0 / sqrt(3.0), lambda random: random.uniform(-1.0, 1.0, (100_000, 3))),
            (1.0 / sqrt(5.0), lambda random: in_ball(random, 100_000)),
        ],
        ids=["within its bound", "in the ball"],
    )
    def test_that_is_what_such_deviations_have(self, shape, sample):
        drawn = sample(np.random.default_rng(5))
        assert np.abs(drawn).max() <= 1.0
        np.testing.assert_allclose(drawn.std(axis=0), shape, rtol=0.01)

    def test_samples_are_between_new_and_as_old_as_the_bound(self):
        late = priors_of(latency_s=1.8)["delay_s"]
        assert late.mean == pytest.approx((0.9, 0.9))
        assert priors_of(albedo_percent=40.0)["earth_light"].mean == pytest.approx((0.2,))
        rest = set(NAMES) - {"delay_s", *OF_CELLS}
        assert not any(any(priors_of()[name].mean) for name in rest)

    @pytest.mark.parametrize(
        ("name", "key", "bound"),
        [("mag_bias_t", "magnetometer_bias_nt", 9e-7), ("dipole_body_am2", "residual_dipole_am2", 0.04)],
    )
    def test_what_wanders_in_a_day_is_a_tenth_of_the_bound(self, name, key, bound):
        walk = np.array(priors_of(**EXACT | {key: GIVEN[key]})[name].walk)
        np.testing.assert_allclose(walk * sqrt(86400.0), 0.1 * bound, rtol=1e-12)

    def test_a_bias_that_follows_the_orbit_moves_by_its_amplitude_in_a_quarter_of_one(self):
        """What is uniform within the amplitude has the standard deviation amplitude / sqrt 3."""
        walk = np.array(priors_of(**EXACT | {"magnetometer_orbit_nt": 300.0})["mag_bias_t"].walk)
        np.testing.assert_allclose(walk * sqrt(1500.0), 3e-7 / sqrt(3.0), rtol=1e-2)

    @pytest.mark.parametrize(("given", "in_a_day"), [({}, 1.4e-8), ({"torque_variation_nm": 3e-9}, 3e-9)])
    def test_the_torque_wanders_as_is_declared_else_by_a_fifth_of_its_bound(self, given, in_a_day):
        walk = np.array(priors_of(torque_nm=7e-8, **given)["torque_body_nm"].walk)
        np.testing.assert_allclose(walk * sqrt(86400.0), in_a_day, rtol=1e-12)

    def test_coils_wander_faster_and_turns_scale_delay_and_inertia_not_at_all(self):
        found = priors_of(**GIVEN)
        gain, axis = 0.0006, 0.01 * radians(0.7)
        assert found["coil_error"].walk == pytest.approx(
            [gain, axis, axis, axis, gain, axis, axis, axis, gain]
        )
        for name in ("inertia_error_kgm2", "mag_turn_rad", "mag_scale", "sun_turn_rad", "delay_s"):
            assert not any(found[name].walk)


class TestWhatIsExactIsNotCarried:
    def test_of_a_table_that_is_exact_nothing_is(self):
        assert priors_of(**EXACT) == {}

    @pytest.mark.parametrize(("key", "name"), CARRIED_BY.items())
    def test_each_bound_alone_brings_its_parameter(self, key, name):
        assert list(priors_of(**EXACT | {key: GIVEN[key]})) == ([name] if name else [])

    def test_a_component_may_be_exact_where_another_is_not(self):
        turned = priors_of(**EXACT | {"coil_misalignment_deg": 0.7})["coil_error"]
        assert [sigma > 0.0 for sigma in turned.sigma] == [axis not in (0, 4, 8) for axis in range(9)]
        skewed = priors_of(**EXACT | {"products_percent": 3.0})["inertia_error_kgm2"]
        assert [sigma > 0.0 for sigma in skewed.sigma] == [False] * 3 + [True] * 3


@pytest.mark.parametrize(
    ("key", "largest"),
    [
        ("inertia_percent", 30.0),
        ("products_percent", 20.0),
        ("coil_gain_percent", 50.0),
        ("coil_misalignment_deg", 10.0),
        ("magnetometer_bias_nt", 3000.0),
        ("magnetometer_scale_percent", 10.0),
        ("magnetometer_misalignment_deg", 10.0),
        ("sun_misalignment_deg", 10.0),
        ("along_track_km", 20.0),
        ("latency_s", 3.0),
        ("magnetometer_orbit_nt", 3000.0),
        ("magnetometer_shadow_nt", 3000.0),
        ("storm_nt", 3000.0),
        ("remanence_percent", 5.0),
        ("albedo_percent", 60.0),
        ("shadow_dipole_am2", None),
        ("shadow_impulse_nms", None),
        ("residual_dipole_am2", None),
        ("torque_nm", None),
    ],
)
class TestRange:
    def told(self, key, value):
        with pytest.raises(TableError) as caught:
            flight_table({"uncertainty": {key: value}, "fdir": {"weak_coil_part": 0.3}}, "table.toml")
        return str(caught.value)

    def test_zero_and_the_largest_are_in_it(self, key, largest):
        for value in (0.0, 1e-9 if largest is None else largest):
            table = flight_table({"uncertainty": {key: value}, "fdir": {"weak_coil_part": 0.3}}, "table.toml")
            assert getattr(table.uncertainty, key) == value

    def test_what_is_not_is_told_in_one_sentence(self, key, largest):
        beyond = [-1e-9, float("nan"), float("inf"), "much"]
        for value in beyond if largest is None else [*beyond, largest * (1.0 + 1e-9)]:
            told = self.told(key, value)
            assert told.startswith(f"table.toml: uncertainty.{key} = ")
            assert "allowed is a number at least 0" in told
            assert largest is None or f"and at most {largest:g}" in told
            assert "\n" not in told


COILS = {"levels_am2": [0.4, 1.5, 6.0], "pulse_s": 2.0, "backoff_s": 48.0}
CONTINUOUS = {"driver": "continuous", "max_dipole_am2": 3.0, "on_fraction": 0.5}


@pytest.mark.parametrize(
    ("key", "section", "largest", "meaning"),
    [
        ("residual_dipole_am2", {"coils": COILS}, 6.0, "the largest dipole of a coil"),
        ("residual_dipole_am2", {"coils": CONTINUOUS}, 3.0, "the largest dipole of a coil"),
        ("torque_nm", {"coils": COILS}, 6.0 * 0.04 * 5e-5, "what a coil of 6 A m^2 gives in the mean"),
        ("torque_nm", {"coils": CONTINUOUS}, 3.0 * 0.5 * 5e-5, "what a coil of 3 A m^2 gives in the mean"),
        ("torque_variation_nm", {"uncertainty": {"torque_nm": 4e-8}}, 8e-8, "from one bound of the torque"),
        ("coil_gain_percent", {"fdir": {"weak_coil_part": 0.9}}, 10.0, "fdir.weak_coil_part"),
        ("shadow_dipole_am2", {"coils": COILS}, 6.0, "the largest dipole of a coil"),
        ("shadow_impulse_nms", {"coils": COILS}, 6.0 * 0.04 * 5e-5 * 1500.0, "in a quarter of an orbit"),
    ],
)
class TestCeilings:
    """What coils and fault detection admit."""

    def test_as_large_is_taken(self, key, section, largest, meaning):
        table = flight_table(merge(section, {"uncertainty": {key: largest}}), "table.toml")
        assert getattr(table.uncertainty, key) == largest

    def test_larger_is_told_in_one_sentence(self, key, section, largest, meaning):
        for value in (largest * 1.001, 1e9 if key != "coil_gain_percent" else 50.0):
            with pytest.raises(TableError) as caught:
                flight_table(merge(section, {"uncertainty": {key: value}}), "table.toml")
            told = str(caught.value)
            assert told.startswith(f"table.toml: uncertainty.{key} = {value!r} is not allowed: allowed is ")
            assert f"a number at least 0 and at most {largest:.4g}, " in told
            assert meaning in told
            assert "\n" not in told


def test_without_a_torque_how_far_it_varies_does_not_matter():
    """As where a satellite's torque is set to zero, and its variation left as it was."""
    given = EXACT | {"torque_variation_nm": 1e-9}
    assert flight_table({"uncertainty": given}, "table.toml").uncertainty.torque_nm == 0.0
    assert priors_of(**given) == {}


def in_ball(random, count):
    """Vectors that are uniform in the ball of radius 1."""
    direction = random.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    return direction * np.cbrt(random.uniform(size=(count, 1)))
