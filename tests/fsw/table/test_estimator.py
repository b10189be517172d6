"""From the onboard table to the estimator: noise as given, priors and limits from the bounds."""

from dataclasses import astuple, fields
from math import radians, sqrt
from typing import ClassVar

import filter_steps
import numpy as np
import pytest
from filter_steps import known_of

from fsw.core.algebra.quaternion import normalise
from fsw.core.estimation import mekf
from fsw.core.estimation.changes import EDGE_S, NO_CHANGES
from fsw.core.estimation.parameters import NAMES
from fsw.core.fdir.sensors.standstill import Steps
from fsw.input.schema import merge
from fsw.table.estimator import (
    GATE_NIS,
    estimator_config,
    field_noise_nt,
    of_steps,
    plausibility_config,
    sun_noise_rad,
    table_bounds,
)
from fsw.table.table import flight_table
from fsw.table.uncertainty import UncertaintyTable, priors

FULL = [[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]
EXACT = dict.fromkeys(UncertaintyTable.model_fields, 0.0)


def table_with(**sections):
    return flight_table(merge({"body": {"inertia_kgm2": FULL}}, sections), "table.toml")


def configured(**sections):
    return estimator_config(table_with(**sections))


class TestNoise:
    def test_of_sensors_and_start(self):
        tuning = {"magnetometer_sigma_nt": 150.0, "sun_sigma_deg": 0.4, "rate_sigma_degps": 1.5}
        config = configured(estimator=tuning).mekf
        np.testing.assert_allclose(config.field_noise, np.eye(3) * 150e-9**2, rtol=1e-12)
        np.testing.assert_allclose(config.sun_noise, np.eye(3) * radians(0.4) ** 2, rtol=1e-12)
        start = np.sqrt(config.initial_covariance.diagonal()[:6])
        np.testing.assert_allclose(start, np.repeat([radians(5.0), radians(1.5)], 3), rtol=1e-12)

    def test_of_a_quantised_reading_is_that_and_the_error_within_a_step(self):
        noise = {"magnetometer_sigma_nt": 150.0, "sun_sigma_deg": 0.4}
        steps = {"magnetometer_quantum_nt": 600.0, "sun_quantum": 0.03}
        config = configured(estimator=noise | steps).mekf
        np.testing.assert_allclose(config.field_noise, np.eye(3) * (150e-9**2 + 600e-9**2 / 12.0), rtol=1e-12)
        sun = radians(0.4) ** 2 + 0.03**2 / 12.0
        np.testing.assert_allclose(config.sun_noise, np.eye(3) * sun, rtol=1e-12)
        parts = of_steps(table_with(estimator=noise | steps).estimator)
        assert parts == pytest.approx((600.0**2 / 12.0 / (150.0**2 + 600.0**2 / 12.0), 0.03**2 / 12.0 / sun))

    def test_of_a_continuous_reading_is_that_to_the_bit(self):
        tuning = table_with(estimator={"magnetometer_sigma_nt": 153.7, "sun_sigma_deg": 0.37}).estimator
        assert (field_noise_nt(tuning), sun_noise_rad(tuning)) == (153.7, radians(0.37))
        assert of_steps(tuning) == (0.0, 0.0)

    @pytest.mark.parametrize("tick_hz", [1, 4])
    def test_of_a_tick_follows_from_the_torque_s_bound(self, tick_hz):
        config = configured(time={"tick_hz": tick_hz}, uncertainty={"torque_nm": 4e-6}).mekf
        assert config.tick_s == 1.0 / tick_hz
        rates = 2e-7**2 / tick_hz * np.linalg.inv(FULL) @ np.linalg.inv(FULL).T
        np.testing.assert_allclose(config.process_noise[3:6, 3:6], rates, rtol=1e-9)
        walk = (0.2 * 4e-6) ** 2 / 86400.0 / tick_hz
        np.testing.assert_allclose(config.process_noise.diagonal()[config.layout.torque], walk, rtol=1e-9)


class TestStates:
    def test_all_are_carried_unless_the_table_is_exact(self):
        assert configured().mekf.layout.size == 42
        assert configured(uncertainty=EXACT).mekf.layout.size == 6
        biased = configured(uncertainty=EXACT | {"magnetometer_bias_nt": 500.0}).mekf.layout
        assert (biased.size, biased.mag_bias) == (9, slice(6, 9))

    def test_their_priors_are_those_of_the_bounds(self):
        table = table_with(uncertainty={"inertia_percent": 8.0, "latency_s": 2.5})
        config, expected = estimator_config(table).mekf, priors(table_bounds(table), table.body.inertia)
        sigma = np.concatenate([expected[name].sigma for name in NAMES if name in expected])
        np.testing.assert_allclose(np.sqrt(config.initial_covariance.diagonal()[6:]), sigma, rtol=1e-12)
        assert config.initial_parameters.delay_s == (1.25, 1.25)

    @pytest.mark.parametrize("key", UncertaintyTable.model_fields)
    def test_with_any_one_of_them_the_filter_is_sound(self, key):
        """Also where a part of a parameter is exact, as the gains of coils that are turned alone."""
        small = {"residual_dipole_am2": 0.05, "torque_nm": 1e-7, "torque_variation_nm": 0.0}
        bound = {**small, "shadow_impulse_nms": 1e-4}.get(key, 1.0)
        config = configured(uncertainty=EXACT | {key: bound}).mekf
        q, b, s = normalise((0.6, -0.4, 0.5, 0.3)), (1.7e-5, -2.3e-5, 3.1e-5), (0.6, -0.48, 0.64)
        estimate = mekf.start(q, (0.001, -0.002, 0.003), config)
        for _ in range(50):
            estimate = filter_steps.predict(estimate, (0.6, 0.0, 0.8), b, 3e-6, (0.0, -8.0, 0.0), config)
            b_body, _ = mekf.field_prediction(*known_of(estimate), b, config)
            s_body, _ = mekf.sun_prediction(*known_of(estimate), s, config)
            estimate = filter_steps.update_both(estimate, b_body, b, s_body, s, config)
            assert mekf.healthy(estimate)
        variances = estimate.covariance.diagonal()
        np.testing.assert_array_equal(variances == 0.0, config.initial_covariance.diagonal() == 0.0)


class TestLimitsOfThePair:
    KNOWN: ClassVar = {
        "magnetometer_bias_nt": 700.0,
        "magnetometer_scale_percent": 0.4,
        "magnetometer_misalignment_deg": 1.5,
        "sun_misalignment_deg": 0.25,
        "along_track_km": 7.0,
        "magnetometer_orbit_nt": 210.0,
        "magnetometer_shadow_nt": 320.0,
        "storm_nt": 130.0,
    }
    SENSORS: ClassVar = {"magnetometer_sigma_nt": 150.0, "sun_sigma_deg": 0.3}

    def test_are_the_bounds_and_the_noise_at_the_edge_of_the_gate(self):
        limits = plausibility_config(table_with(uncertainty=self.KNOWN, estimator=self.SENSORS))
        offset_t = sqrt(3.0) * (700e-9 + 210e-9 + 320e-9 + 130e-9 + sqrt(16.27) * 150e-9)
        position = 3.0 * 7.0 / 7000.0
        assert limits.field_t == pytest.approx(offset_t)
        assert limits.field_part == pytest.approx(0.004 + position)
        turns = radians(1.5) + radians(0.25) + 0.004 + position
        assert limits.angle_rad == pytest.approx(turns + sqrt(16.27) * radians(0.3))
        assert limits.sun_norm == pytest.approx(sqrt(16.27) * radians(0.3))

    @pytest.mark.parametrize("key", KNOWN)
    def test_a_wider_bound_never_narrows_them(self, key):
        once, twice = (
            plausibility_config(table_with(uncertainty=self.KNOWN | {key: factor * self.KNOWN[key]}))
            for factor in (1.0, 2.0)
        )
        of_strength = "misalignment" not in key
        assert (twice.field_t + twice.field_part > once.field_t + once.field_part) is of_strength
        assert twice.angle_rad + twice.field_t / 3e-5 > once.angle_rad + once.field_t / 3e-5

    def test_a_step_widens_them_and_is_the_one_below_which_a_reading_may_stand_still(self):
        steps = {"magnetometer_quantum_nt": 600.0, "sun_quantum": 0.03}
        plain = plausibility_config(table_with(uncertainty=EXACT, estimator=self.SENSORS))
        table = table_with(uncertainty=EXACT, estimator=self.SENSORS | steps, time={"tick_hz": 4})
        limits = plausibility_config(table)
        assert plain.steps is None
        assert astuple(limits.steps) == pytest.approx((600e-9, 0.03, 0.25))
        assert limits.field_t == pytest.approx(sqrt(3.0 * GATE_NIS * (150e-9**2 + 600e-9**2 / 12.0)))
        assert limits.sun_norm == pytest.approx(sqrt(GATE_NIS * (radians(0.3) ** 2 + 0.03**2 / 12.0)))
        assert limits.sun_norm > sqrt(3.0) * 0.03 / 2.0, "the length that rounding alone may give"
        one = plausibility_config(table_with(estimator={"sun_quantum": 0.03}))
        assert one.steps == Steps(field_t=0.0, sun=0.03, tick_s=1.0)

    def test_of_an_exact_table_are_the_noise_s(self):
        limits = plausibility_config(table_with(uncertainty=EXACT, estimator=self.SENSORS))
        assert limits.field_t == pytest.approx(sqrt(3.0 * GATE_NIS) * 150e-9)
        assert limits.field_part == 0.0

    def test_the_start_goes_by_them(self):
        table = table_with(uncertainty=self.KNOWN)
        config, limits = estimator_config(table), plausibility_config(table)
        assert config.start.max_field_error_t == limits.field_t + limits.field_part * 5e-5
        assert config.start.max_angle_error_rad == limits.angle_rad + limits.field_t / 2e-5

    @pytest.mark.long
    def test_every_pair_within_the_bounds_passes_them(self):
        """Drawn at the bounds: biased, scaled, turned sensors and a field from elsewhere on the orbit."""
        limits, random = (
            plausibility_config(table_with(uncertainty=self.KNOWN, estimator=self.SENSORS)),
            np.random.default_rng(3),
        )
        for _ in range(2000):
            b, s = random.uniform(2e-5, 5e-5) * direction(random), direction(random)
            true_b = b + 0.003 * np.linalg.norm(b) * direction(random)
            scaled = (1.0 + 0.004 * random.choice([-1.0, 1.0], 3)) * (
                true_b + np.cross(true_b, radians(1.5) * direction(random))
            )
            seen_b = scaled + 700e-9 * random.choice([-1.0, 1.0], 3)
            seen_s = s + np.cross(s, radians(0.25) * direction(random))
            size = np.linalg.norm(b)
            assert abs(np.linalg.norm(seen_b) - size) < limits.field_t + limits.field_part * size
            assert abs(angle(seen_b, seen_s) - angle(b, s)) < limits.angle_rad + limits.field_t / size


@pytest.mark.parametrize(
    ("latency_s", "tick_hz", "ticks"),
    [(0.0, 1, 0), (1.0, 1, 1), (0.3, 1, 1), (1.1, 1, 2), (0.3, 10, 3), (2.0, 4, 8), (3.0, 10, 30)],
)
def test_a_pulse_blanks_the_field_for_as_long_as_a_sample_may_be_late(latency_s, tick_hz, ticks):
    config = configured(time={"tick_hz": tick_hz}, uncertainty={"latency_s": latency_s})
    assert config.blank_ticks == ticks


def test_an_ordinary_sample_is_up_to_one_tick_old():
    assert configured(time={"tick_hz": 10}).blank_ticks == 1
    assert configured(time={"tick_hz": 10}).mekf.initial_parameters.delay_s == (0.05, 0.05)


def test_what_no_bound_tells():
    config = configured(estimator={"valid_sigma_deg": 4.0})
    assert config.valid_sigma_rad == pytest.approx(radians(4.0))
    assert config.start.min_separation_rad == pytest.approx(radians(15.0))
    assert config.restart_after_rejections == 60
    assert configured(time={"tick_hz": 10}).restart_after_rejections == 600
    assert (config.mekf.gate_nis, config.mekf.dipole_sigma) == (16.27, 0.002)


@pytest.mark.parametrize(("knowledge", "perfect"), [("filter", False), ("perfect", True)])
def test_knowledge(knowledge, perfect):
    assert configured(knowledge=knowledge).perfect is perfect


def test_inertia_and_wheel_are_the_table_s():
    rotor = configured(body={"wheel_nms": [0.01, -0.02, 0.03]}).mekf.rotor
    np.testing.assert_allclose(rotor.inertia_kgm2, FULL)
    np.testing.assert_allclose(rotor.inertia_inverse, np.linalg.inv(FULL), rtol=1e-12)
    assert rotor.wheel_body_nms == (0.01, -0.02, 0.03)


@pytest.mark.long
def test_no_bound_is_left_unread():
    """Each changes the estimator's configuration."""
    for key in UncertaintyTable.model_fields:
        cells = {"cells": {"normals": [[1.0, 0.0, 0.0]]}} if key.startswith("cell_") else {}
        ordinary, changed = configured(**cells), configured(uncertainty={key: 0.0}, **cells)
        assert (
            any(
                getattr(changed, field.name) != getattr(ordinary, field.name)
                for field in fields(ordinary)
                if field.name not in ("mekf", "changes")
            )
            or pack_changes(changed.changes) != pack_changes(ordinary.changes)
            or changed.mekf.layout.size != ordinary.mekf.layout.size
            or not np.array_equal(changed.mekf.initial_covariance, ordinary.mekf.initial_covariance)
            or not np.array_equal(changed.mekf.process_noise, ordinary.mekf.process_noise)
        )


def pack_changes(changes):
    """All of its numbers."""
    rate = changes.edge_rate
    return (
        *(changes.edge_bias_t2ps, changes.edge_dipole_a2m4ps, changes.storm_t2ps, changes.remanent_ps),
        () if rate is None else tuple(rate.ravel()),
    )


def direction(random):
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


def angle(a, b):
    return np.arccos(np.clip(a @ b / np.linalg.norm(a) / np.linalg.norm(b), -1.0, 1.0))


def test_what_changes_in_orbit_follows_from_its_bounds():
    known = {
        "magnetometer_shadow_nt": 700.0,
        "shadow_dipole_am2": 0.03,
        "storm_nt": 220.0,
        "remanence_percent": 0.2,
        "shadow_impulse_nms": 3e-5,
    }
    assert configured(uncertainty=EXACT).changes is NO_CHANGES
    changes = configured(uncertainty=EXACT | known, coils={"pulse_s": 2.0}).changes
    assert changes.edge_bias_t2ps * EDGE_S == pytest.approx(7e-7**2 / 3.0)
    assert changes.edge_dipole_a2m4ps * EDGE_S == pytest.approx(0.03**2 / 3.0)
    assert changes.storm_t2ps * 75.0 == pytest.approx(2.2e-7**2 / 3.0)
    assert changes.remanent_ps * 2.0 == pytest.approx(2.0 * 0.002**2 / 3.0)
    inverse_j = np.linalg.inv(configured().mekf.rotor.inertia_kgm2)
    np.testing.assert_allclose(changes.edge_rate * EDGE_S, 3e-5**2 / 3.0 * inverse_j @ inverse_j.T, rtol=1e-9)


@pytest.mark.parametrize("key", ["magnetometer_shadow_nt", "storm_nt", "remanence_percent"])
def test_each_of_them_alone_is_a_change(key):
    assert configured(uncertainty=EXACT | {key: 1.0}).changes is not NO_CHANGES
