"""Directions that no sample tells: by exact measurements and motion, and what a filter knows of them."""

from dataclasses import replace

import numpy as np
import pytest
from filter_steps import correct, update_both

from fsw.core.estimation.parameters import NAMES, NOTHING
from fsw.core.estimation.unobservable import (
    FACTOR,
    TURNS,
    turned_along,
    unobservable,
    unobservable_directions,
)

NEEDED = ("coil_error", "inertia_error_kgm2", "mag_turn_rad", "sun_turn_rad")
TICK_S = 1.0


def directions(satellite, estimate):
    config = satellite.config()
    return unobservable_directions(
        estimate.omega_body_radps, estimate.parameters, config.rotor, config.layout
    )


def small_turns(satellite):
    """An estimate whose sensors are hardly turned: turns do not commute, which is of the second order."""
    true = satellite.parameters
    return satellite.estimate(
        parameters=replace(
            true,
            mag_turn_rad=tuple(0.01 * turn for turn in true.mag_turn_rad),
            sun_turn_rad=tuple(0.01 * turn for turn in true.sun_turn_rad),
        )
    )


def known(satellite, estimate):
    """D^T P^-1 D of an estimate."""
    along = directions(satellite, estimate)
    return along.T @ np.linalg.solve(estimate.covariance, along)


def slow(satellite):
    """An estimate of a satellite too slow for the age of its samples to be turned too; all are correlated."""
    return replace(satellite.estimate(), omega_body_radps=(0.0021, -0.0034, 0.0027))


def count(config):
    return config.unobservable.coordinates.shape[0]


def all_but(name):
    return tuple(other for other in NAMES if other != name)


@pytest.fixture
def config(full):
    return full.config()


@pytest.mark.parametrize("direction", range(4))
def test_nothing_is_measured_along_them(full, direction):
    """Of what the same turn would change by the attitude alone, less than a part in a thousand."""
    estimate, step = small_turns(full), 1e-4
    error = step * directions(full, estimate)[:, direction]
    up, down = (full.measured("both", full.moved(estimate, sign * error)) for sign in (1.0, -1.0))
    alone = np.concatenate((error[:3] if direction < FACTOR else (step, 0.0, 0.0), np.zeros(full.size() - 3)))
    seen, turned = (
        up - down,
        full.measured("both", full.moved(estimate, alone)) - full.measured("both", estimate),
    )
    assert np.linalg.norm(seen[:3]) < 1e-3 * np.linalg.norm(turned[:3])
    assert np.linalg.norm(seen[3:]) < 1e-3 * np.linalg.norm(turned[3:])


@pytest.mark.long
@pytest.mark.parametrize("direction", range(4))
def test_the_motion_goes_on_along_them(full, nonlinear_flow, direction):
    """A satellite that differs along a direction differs along the same one after a minute's motion."""
    estimate, step = full.estimate(), 1e-5
    surroundings = (full.driven_am2, full.b_eci_t, full.gravity_ps2, 60.0)
    error = step * directions(full, estimate)[:, direction]
    later = [
        nonlinear_flow(full.moved(estimate, sign * error), full, *surroundings) for sign in (0.0, 1.0, -1.0)
    ]
    along = directions(full, later[0])[:, direction]
    moved = (full.error(later[0], later[1]) - full.error(later[0], later[2])) / (2.0 * step)
    np.testing.assert_allclose(moved[:3], along[:3], atol=2e-6)
    np.testing.assert_allclose(moved[3:6], along[3:6], atol=2e-7)
    np.testing.assert_allclose(moved[6:], along[6:], atol=1e-9)


@pytest.mark.long
def test_the_motion_shows_a_factor_of_the_coils_alone(full, nonlinear_flow):
    """What is told must not be among the directions: coils stronger, and nothing else."""
    estimate = full.estimate()
    stronger = np.zeros(full.size())
    stronger[full.place("coil_error")] = 0.01 * np.eye(3).ravel()
    surroundings = (full.driven_am2, full.b_eci_t, full.gravity_ps2, 60.0)
    as_known, as_moved = (
        nonlinear_flow(one, full, *surroundings) for one in (estimate, full.moved(estimate, stronger))
    )
    assert np.linalg.norm(full.error(as_known, as_moved)[3:6]) > 1e-5


class TestWhichThereAre:
    def test_turns_and_factor_where_nothing_is_exact(self, carrying):
        assert count(carrying(*NEEDED).config()) == 4

    @pytest.mark.parametrize("exact", ["mag_turn_rad", "sun_turn_rad"])
    def test_the_factor_alone_where_a_sensor_is_aligned_exactly(self, carrying, exact):
        config = carrying(*all_but(exact)).config()
        assert count(config) == 1
        assert not config.unobservable.moving[0:6].any()

    @pytest.mark.parametrize("exact", ["coil_error", "inertia_error_kgm2"])
    def test_none_where_coils_or_inertia_are_exact(self, carrying, exact):
        assert carrying(*all_but(exact)).config().unobservable is None

    def test_none_where_a_part_of_them_is_exact(self, full):
        """Moments of inertia that are uncertain, with axes that are not."""
        config = full.config()
        variances = config.initial_covariance.diagonal().tolist()
        variances[full.place("inertia_error_kgm2").stop - 1] = 0.0
        assert unobservable(config.layout, variances, config.rotor) is None

    def test_none_with_a_wheel(self, full):
        """Its momentum, known in body axes and newton metre seconds, tells them."""
        assert full.config(wheel_body_nms=(0.0, -0.02, 0.0)).unobservable is None
        assert full.config(driven_wheel=True).unobservable is None

    def test_none_of_a_satellite_as_its_table_says(self, carrying):
        assert carrying("mag_bias_t", "torque_body_nm").config().unobservable is None

    def test_what_is_not_carried_has_no_place(self, carrying):
        satellite = carrying(*NEEDED)
        along = directions(satellite, satellite.estimate(parameters=NOTHING))
        assert along.shape == (satellite.size(), 4)
        np.testing.assert_array_equal(along[0:3, TURNS], -np.eye(3))


class TestAFilter:
    """What it knows along the directions: D^T P^-1 D."""

    def test_a_measurement_tells_nothing_of_them(self, full, config):
        """However far it moves the estimate."""
        before = slow(full)
        b_eci_t, s_eci = np.multiply(1.02, full.b_eci_t), full.s_eci
        b, s = np.split(full.measured("both", full.moved(before, 0.5 * full.scales())), [3])
        after = update_both(before, tuple(b), tuple(b_eci_t), tuple(s), s_eci, config)
        assert abs(full.error(before, after)[6:] / full.scales()[6:]).max() > 0.1
        np.testing.assert_allclose(known(full, after), known(full, before), rtol=1e-6)

    def test_without_turning_it_would(self, full, config):
        """By a percent in one correction; there are thousands in an hour."""
        blind = replace(config, unobservable=None)
        before = slow(full)
        error = 0.5 * full.scales()
        surer = known(full, correct(before, error, 0.0 * before.covariance, blind))
        assert np.linalg.eigvals(np.linalg.solve(known(full, before), surer)).real.max() > 1.005

    @pytest.mark.parametrize("seed", range(5))
    def test_no_correction_tells_anything(self, full, config, seed):
        before = slow(full)
        error = full.scales() * np.random.default_rng(seed).normal(size=full.size())
        after = correct(before, error, 0.0 * before.covariance, config)
        np.testing.assert_allclose(known(full, after), known(full, before), rtol=1e-6)

    def test_the_factor_alone_likewise(self, carrying):
        satellite = carrying(*all_but("sun_turn_rad"))
        config, before = satellite.config(), slow(satellite)
        error = satellite.scales() * np.random.default_rng(7).normal(size=satellite.size())
        after = correct(before, error, 0.0 * before.covariance, config)
        assert known(satellite, after)[FACTOR, FACTOR] == pytest.approx(
            known(satellite, before)[FACTOR, FACTOR], rel=1e-6
        )

    def test_of_all_across_them_it_knows_what_it_did(self, full, config):
        """Of any other direction, orthogonal to W, not a digit more or less."""
        before = slow(full)
        error = full.scales() * np.random.default_rng(3).normal(size=full.size())
        after = correct(before, error, 0.0 * before.covariance, config)
        across = np.eye(full.size())
        across = across[:, ~config.unobservable.coordinates.any(axis=0)]
        for_all = (across.T @ np.linalg.inv(one.covariance) @ across for one in (before, after))
        scales = np.sqrt(before.covariance.diagonal())[~config.unobservable.coordinates.any(axis=0)]
        first, second = (np.outer(scales, scales) * information for information in for_all)
        np.testing.assert_allclose(second, first, atol=1e-6 * abs(first).max())

    def test_the_covariance_stays_one(self, full, config):
        before = slow(full)
        error = full.scales() * np.random.default_rng(5).normal(size=full.size())
        after = correct(before, error, 0.0 * before.covariance, config).covariance
        scales = np.sqrt(after.diagonal())
        np.testing.assert_array_equal(after, after.T)
        assert np.linalg.eigvalsh(after / np.outer(scales, scales)).min() > 0.0

    def test_no_correction_no_turn(self, full, config):
        covariance = full.covariance()
        same = turned_along(covariance, (0.0,) * full.size(), (0.0,) * 6, config.unobservable)
        np.testing.assert_array_equal(same, covariance)
