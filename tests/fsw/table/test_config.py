"""From the onboard table to what the core flies on: degrees, nanotesla and seconds to SI and ticks."""

from dataclasses import asdict, astuple
from math import cos, log, pi, radians, sqrt

import numpy as np
import pytest

from fsw.core.laws.interface import Setpoint
from fsw.core.modes import TABLE
from fsw.core.orbit.propagation import CircularKeplerOrbit, TleOrbit
from fsw.core.rates import RateGroup
from fsw.input.schema import TableError, merge
from fsw.table.config import flight_config
from fsw.table.table import flight_table

FULL = [[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]
CIRCULAR = {"altitude_km": 700.0, "inclination_deg": 98.2, "raan_deg": 10.0, "u0_deg": 20.0}
DIPOLE = {"model": "direct_dipole"}


def configured(**sections):
    values = merge({"body": {"inertia_kgm2": FULL}}, sections)
    return flight_config(flight_table(values, "table.toml"))


def test_inertia_and_its_inverse():
    config = configured()
    np.testing.assert_allclose(config.control.inertia_kgm2, FULL)
    np.testing.assert_allclose(config.control.inertia_inverse, np.linalg.inv(FULL), rtol=1e-12)


def test_metrics_of_what_a_pulse_leaves():
    """The square of the rate that is left, and twice its energy."""
    config, inverse = configured().coils.pulses, np.linalg.inv(FULL)
    np.testing.assert_allclose(config.rate_metric, inverse.T @ inverse, rtol=1e-12)
    np.testing.assert_allclose(config.energy_metric, inverse, rtol=1e-12)


def test_filter_and_fault_detection_go_by_the_same_limits():
    config = configured(uncertainty={"magnetometer_bias_nt": 2000.0, "along_track_km": 13.0})
    estimator, limits = config.estimator, config.fdir.plausibility
    assert estimator.start.max_field_error_t == limits.field_t + limits.field_part * 5e-5
    assert estimator.start.max_angle_error_rad == limits.angle_rad + limits.field_t / 2e-5


class TestTicks:
    @pytest.mark.parametrize("tick_hz", [1, 2, 7, 10, 100])
    def test_dwell_times_by_row(self, tick_hz):
        """Different for each name, so that none can stand in for another."""
        dwell_s = {"recover_s": 31.0, "settle_s": 62.5, "lose_s": 303.0, "hold_s": 600.7}
        config = configured(time={"tick_hz": tick_hz}, modes=dwell_s).modes
        for row, ticks in zip(TABLE, config.dwell_ticks, strict=True):
            seconds = {**dwell_s, "none_s": 0.0}[row.dwell]
            assert ticks - 1 < seconds * tick_hz <= ticks + 1e-6

    def test_seconds_that_are_whole_ticks_are_exactly_those(self):
        """1.1 * 10 is a little more than 11 in floats."""
        config = configured(time={"tick_hz": 10}, modes={"recover_s": 1.1, "stale_after_s": 2.2})
        assert config.modes.dwell_ticks[0] == 11
        assert config.stale_after_ticks == 22

    def test_limits_of_samples_follow_from_bounds_and_noise(self):
        uncertainty = {
            "magnetometer_bias_nt": 700.0,
            "magnetometer_scale_percent": 0.4,
            "magnetometer_misalignment_deg": 0.9,
            "sun_misalignment_deg": 0.3,
            "along_track_km": 7.0,
            "latency_s": 0.25,
            "magnetometer_orbit_nt": 210.0,
            "magnetometer_shadow_nt": 320.0,
            "storm_nt": 130.0,
            "albedo_percent": 40.0,
        }
        tuning = {"magnetometer_sigma_nt": 150.0, "sun_sigma_deg": 0.2}
        config = configured(time={"tick_hz": 10}, estimator=tuning, uncertainty=uncertainty).fdir
        edge = sqrt(16.27)
        field_t = sqrt(3.0) * (700e-9 + 210e-9 + 320e-9 + 130e-9 + edge * 150e-9)
        assert asdict(config.plausibility) == pytest.approx(
            {
                "field_t": field_t,
                "field_part": 0.004 + 3.0 * 7.0e3 / 7.0e6,
                "in_range_t": (65000e-9 - field_t) / 1.007,
                "angle_rad": radians(0.9 + 0.3 + edge * 0.2) + 0.007,
                "sun_norm": edge * radians(0.2),
                "late_ticks": 3,
                "cells": None,
                "steps": None,
                "most_albedo": pytest.approx(0.4),
            }
        )

    def test_the_budget_of_false_alarms_is_the_threshold_of_every_test(self):
        config = configured(fdir={"false_alarm_days": 200.0}).fdir
        assert config.sensors.weights.threshold == pytest.approx(log(200.0 * 86400.0 / 2.0))
        assert config.coils.weak.threshold == config.sensors.weights.threshold

    @pytest.mark.parametrize(
        ("tick_hz", "pulse_ticks", "backoff_ticks", "duration_ms"),
        [
            (1, 3, 100, 3000),
            (2, 6, 200, 3000),
            (7, 21, 700, 3000),
            (10, 30, 1000, 3000),
            (64, 192, 6400, 3000),
        ],
    )
    def test_pulse_and_back_off(self, tick_hz, pulse_ticks, backoff_ticks, duration_ms):
        config = configured(time={"tick_hz": tick_hz}).coils.pulses
        assert (config.pulse_ticks, config.backoff_ticks) == (pulse_ticks, backoff_ticks)
        assert (config.duration_ms, config.pulse_s) == (duration_ms, duration_ms / 1000.0)
        assert config.tick_s == 1.0 / tick_hz

    @pytest.mark.parametrize(("pulse_s", "backoff_s"), [(2.9999, 99.9999), (2.55, 100.0001), (0.35, 0.0)])
    def test_a_pulse_is_never_longer_and_a_gap_never_shorter_than_written(self, pulse_s, backoff_s):
        for tick_hz in (3, 7, 10, 100):
            config = configured(
                time={"tick_hz": tick_hz}, coils={"pulse_s": pulse_s, "backoff_s": backoff_s}
            ).coils.pulses
            assert 0 < config.pulse_ticks / tick_hz <= pulse_s
            assert config.duration_ms <= pulse_s * 1000.0
            assert config.backoff_ticks / tick_hz >= backoff_s

    def test_reports(self):
        config = configured(
            time={"tick_hz": 4}, telemetry={"attitude_s": 0.0, "quality_s": 10.0, "heartbeat_s": 60.0}
        ).rates
        assert (config.attitude, config.quality, config.heartbeat) == (
            RateGroup(1),
            RateGroup(40),
            RateGroup(240),
        )

    def test_nodes_of_the_ephemeris(self):
        assert configured(time={"tick_hz": 4}, telemetry={"ephemeris_s": 30}).ephemeris.node_ticks == 120


def test_thresholds_of_the_modes():
    config = configured(modes={"slow_degps": 0.2, "fast_degps": 0.7, "near_deg": 18.0, "far_deg": 44.0}).modes
    assert config.slow_radps == pytest.approx(0.2 * pi / 180.0)
    assert config.fast_radps == pytest.approx(0.7 * pi / 180.0)
    assert config.near_cosine == pytest.approx(cos(radians(18.0)))
    assert config.far_cosine == pytest.approx(cos(radians(44.0)))


def test_control_and_coils():
    config = configured(
        time={"tick_hz": 5},
        control={
            "law": "rate_damping",
            "k_w": 1e6,
            "k_a": 7.0,
            "k_i": 3e-3,
            "spin_radps": 0.02,
            "leak_s": 250.0,
        },
        coils={"backoff": "per_coil", "levels_am2": [1.0, 2.5, 9.0]},
    )
    assert config.control.setpoint == Setpoint("rate_damping", k_w=1e6, k_a=7.0, k_i=3e-3, spin_radps=0.02)
    assert (config.control.tick_s, config.control.horizon_s) == (0.2, 3.0)
    assert config.control.mean_dipole_am2 == pytest.approx(9.0 * 3.0 / 103.0)
    pulses = config.coils.pulses
    assert (pulses.shared, pulses.levels_am2, pulses.leak_s) == (False, (1.0, 2.5, 9.0), 250.0)
    assert config.coils.dipoles is None
    assert astuple(config.read_back) == (pytest.approx(0.1 * 50.0), 5 * (3 + 1) + 1)
    assert config.control.pulsed
    assert config.control.wheel_body_nms == config.estimator.mekf.rotor.wheel_body_nms == (0.0, 0.0, 0.0)


def test_a_wheel_is_known_to_filter_and_law():
    config = configured(body={"wheel_nms": [0.01, -0.02, 0.03]})
    assert config.control.wheel_body_nms == config.estimator.mekf.rotor.wheel_body_nms == (0.01, -0.02, 0.03)


@pytest.mark.parametrize("minimiser", ["closed_form", "genetic"])
def test_a_continuous_driver(minimiser):
    """Full scale is a mean over the tick, of which it drives a part."""
    config = configured(
        coils={"driver": "continuous", "max_dipole_am2": 12.0, "on_fraction": 0.75},
        control={"minimiser": minimiser},
    )
    assert config.coils.dipoles.full_scale_am2 == pytest.approx(9.0)
    assert config.coils.dipoles.genetic is (minimiser == "genetic")
    np.testing.assert_allclose(config.coils.dipoles.inertia_kgm2, FULL)
    assert config.control.mean_dipole_am2 == pytest.approx(9.0)
    assert not config.control.pulsed
    assert config.coils.pulses == configured().coils.pulses, "the timing of pulses stays"


def test_identity_of_the_table_goes_along():
    table = flight_table({}, "x")
    config = flight_config(table)
    assert (config.table_crc, config.epoch_unix_s, config.tick_hz) == (table.crc, table.epoch_unix_s, 1)


def test_both_kinds_of_orbit():
    assert isinstance(configured().ephemeris.orbit, TleOrbit)
    orbit = configured(orbit=CIRCULAR).ephemeris.orbit
    assert isinstance(orbit, CircularKeplerOrbit)
    assert orbit.radius_m == pytest.approx(6378137.0 + 700e3)
    assert orbit.u0_rad == pytest.approx(radians(20.0))


@pytest.mark.parametrize(
    ("sections", "told"),
    [
        ({"coils": {"pulse_s": 0.9}}, "coils.pulse_s = 0.9 is not allowed: at least a tick, 1 with"),
        (
            {"time": {"tick_hz": 3}, "coils": {"pulse_s": 0.333}},
            "at least a tick, 0.334 with time.tick_hz = 3",
        ),
        ({"control": {"leak_s": 0.5}}, "control.leak_s = 0.5 is not allowed: at least a tick, 1 with"),
        (
            {"time": {"epoch_utc": "2031-01-01T00:00:00Z"}},
            "time.epoch_utc, or without it the epoch of orbit.tle, is Unix time 1924992000 s: IGRF-14 holds",
        ),
        ({"time": {"epoch_utc": "2010-01-01T00:00:00Z"}, "orbit": CIRCULAR}, "from 2015 to 2030"),
        (
            {"time": {"epoch_utc": "2107-01-01T00:00:00Z"}, "orbit": CIRCULAR, "field": DIPOLE},
            "time.epoch_utc, .*from 1970 to 2106",
        ),
        (
            {"control": {"gains": {"stepped_precession": {"hold_s": 0.0}}}},
            "control: gains.stepped_precession",
        ),
    ],
)
def test_a_table_that_cannot_be_flown_is_told_in_one_sentence(sections, told):
    """With where it is from, the key and what is allowed."""
    with pytest.raises(TableError, match=f"^table.toml: .*{told}") as caught:
        configured(**sections)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "sections",
    [
        {"time": {"tick_hz": 3}, "coils": {"pulse_s": 0.334}, "control": {"leak_s": 0.334}},
        {"coils": {"pulse_s": 1.0}, "control": {"leak_s": 1.0}},
        {"time": {"epoch_utc": "2106-01-01T00:00:00Z"}, "orbit": CIRCULAR, "field": DIPOLE},
    ],
)
def test_a_pulse_and_a_leak_of_a_tick_and_another_field_can_be_flown(sections):
    assert configured(**sections).coils.pulses.pulse_ticks >= 1


def test_elements_that_have_decayed_at_the_epoch_are_told():
    draggy = "1 22826U 93061D   15086.11593543  .00000251  00000-0  99999+0 0  9992"
    second = "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352"
    sections = {"orbit": {"tle": [draggy, second]}, "time": {"epoch_utc": "2015-06-01T00:00:00Z"}}
    with pytest.raises(TableError, match=r"^mine\.toml: orbit\.tle: the elements are at 379665 km on 2015"):
        flight_table(sections, "mine.toml")
