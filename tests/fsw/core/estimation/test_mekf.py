"""The filter: its update against the textbook, its gate, its soundness."""

import csv
from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from estimator_samples import angle_rad
from filter_steps import predict, update_both, update_field, update_sun
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.algebra.vector import ZERO, add, cross
from fsw.core.estimation import mekf
from fsw.core.estimation.kalman import Cause, Trace
from fsw.core.estimation.mekf import start
from fsw.core.estimation.parameters import NAMES, NOTHING, Parameters
from fsw.core.estimation.unobservable import unobservable_directions
from fsw.core.packing import pack
from sim.validate.reference.reference_table import DATA


def update(kind, estimate, measured, satellite, config):
    """The filter's update with what was measured, (3,) or (6,)."""
    values, b, s = tuple(map(float, measured)), satellite.b_eci_t, satellite.s_eci
    match kind:
        case "both":
            return update_both(estimate, values[:3], b, values[3:], s, config)
        case "field":
            return update_field(estimate, values, b, config)
        case _:
            return update_sun(estimate, values, s, config)


def test_a_start_knows_the_attitude_and_takes_the_satellite_as_in_its_table(satellite):
    config = satellite.config()
    begun = start(satellite.q, ZERO, config)
    assert (begun.q_body_from_eci, begun.omega_body_radps, begun.trace) == (satellite.q, ZERO, None)
    assert not any(begun.parameters.floats())
    np.testing.assert_array_equal(begun.covariance, config.initial_covariance)


def textbook(estimate, innovation, sensitivity, sigma):
    """Information form: P+ = (P^-1 + H^T R^-1 H)^-1, dx = P+ H^T R^-1 z, in scaled states."""
    scale = np.sqrt(estimate.covariance.diagonal())
    p, h = estimate.covariance / np.outer(scale, scale), sensitivity * scale / sigma[:, None]
    covariance = np.linalg.inv(np.linalg.inv(p) + h.T @ h)
    return scale * (covariance @ h.T @ (innovation / sigma)), covariance * np.outer(scale, scale)


def about_the_motion_after(satellite, before, after, covariance):
    """T P T^T: what the age of both samples hides lies along the motion, w and J^-1 ((J w + h) x w)."""
    if "delay_s" not in satellite.carried:
        return covariance

    def motion(estimate):
        xx, yy, zz, xy, xz, yz = estimate.parameters.inertia_error_kgm2
        inertia = np.add(satellite.inertia_kgm2, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        w = np.array(estimate.omega_body_radps)
        return np.concatenate(
            (w, np.linalg.solve(inertia, np.cross(inertia @ w + satellite.wheel_body_nms, w)))
        )

    turned = np.eye(satellite.size())
    turned[0:6, satellite.place("delay_s")] = 0.5 * np.outer(motion(after) - motion(before), (1.0, 1.0))
    return turned @ covariance @ turned.T


def along_what_no_sample_tells_after(satellite, before, after, covariance):
    """T P T^T, turned with the directions that no sample tells, where there are any."""
    config = satellite.config()
    if "inertia_error_kgm2" not in satellite.carried:
        assert config.unobservable is None
        return covariance
    along = [
        unobservable_directions(one.omega_body_radps, one.parameters, config.rotor, config.layout)
        for one in (before, after)
    ]
    coordinates = np.zeros((satellite.size(), 4))
    coordinates[satellite.place("sun_turn_rad"), 0:3] = np.eye(3)
    moments = slice(
        satellite.place("inertia_error_kgm2").start, satellite.place("inertia_error_kgm2").start + 3
    )
    coordinates[moments, 3] = 1.0 / along[0][moments, 3].sum()
    np.testing.assert_allclose(coordinates.T @ along[0], np.eye(4), atol=1e-12)
    turned = np.eye(satellite.size()) + (along[1] - along[0]) @ coordinates.T
    return turned @ covariance @ turned.T


@pytest.mark.parametrize("kind", ["field", "sun", "both"])
class TestUpdate:
    """At a satellite as in its table, where the sensitivity is exact."""

    def updated(self, kind, satellite):
        """(before, after, innovation)."""
        before = satellite.estimate(parameters=NOTHING)
        sigma = satellite.sigma[kind]
        innovation = sigma * np.array([0.7, -1.1, 0.9, -0.8, 0.6, -1.2])[: len(sigma)]
        measured = satellite.measured(kind, before) + innovation
        return before, update(kind, before, measured, satellite, satellite.config()), innovation

    def test_is_the_textbook_s_with_the_model_s_derivative(self, kind, satellite):
        before, after, innovation = self.updated(kind, satellite)
        h = satellite.sensitivity(kind, before, step=1e-3)
        dx, covariance = textbook(before, innovation, h, satellite.sigma[kind])
        covariance = about_the_motion_after(satellite, before, after, covariance)
        covariance = along_what_no_sample_tells_after(satellite, before, after, covariance)
        scale = np.sqrt(before.covariance.diagonal())
        unit = np.outer(scale, scale)
        np.testing.assert_allclose(after.covariance / unit, covariance / unit, rtol=0.0, atol=1e-6)
        moved = satellite.error(before, after)
        np.testing.assert_allclose(moved / scale, dx / scale, rtol=0.0, atol=1e-6)
        assert np.abs(moved / scale).max() > 1e-3

    def test_all_that_is_carried_moves_and_nothing_else(self, kind, satellite):
        before, after, _ = self.updated(kind, satellite)
        moved = {
            name for name in NAMES if getattr(after.parameters, name) != getattr(before.parameters, name)
        }
        assert moved == set(satellite.carried)

    def test_the_covariance_is_exactly_symmetric_and_shrinks(self, kind, satellite):
        before, after, _ = self.updated(kind, satellite)
        np.testing.assert_array_equal(after.covariance, after.covariance.T)
        assert (after.covariance.diagonal() < before.covariance.diagonal()).all()

    def test_the_mean_of_innovations_moves_towards_these_in_their_standard_deviations(self, kind, satellite):
        before, after, innovation = self.updated(kind, satellite)
        h, config = satellite.sensitivity(kind, before, step=1e-3), satellite.config()
        variances = (h @ before.covariance @ h.T).diagonal() + satellite.sigma[kind] ** 2
        expected = np.zeros(6)
        first = 3 if kind == "sun" else 0
        expected[first : first + len(innovation)] = innovation / np.sqrt(variances)
        np.testing.assert_allclose(after.lag, config.tick_s / mekf.LAG_S * expected, rtol=1e-4, atol=1e-9)

    def test_the_estimate_before_is_not_touched(self, kind, satellite):
        config, before = satellite.config(), satellite.estimate()
        kept, prior = before.covariance.copy(), config.initial_covariance.copy()
        near = np.array(satellite.measured(kind, before)) + 1e-9
        assert update(kind, before, near, satellite, config) is not None
        predict(
            before, satellite.e1_eci, satellite.b_eci_t, satellite.gravity_ps2, satellite.driven_am2, config
        )
        np.testing.assert_array_equal(before.covariance, kept)
        np.testing.assert_array_equal(config.initial_covariance, prior)


REFERENCE = DATA / "triad_mekf.csv"


def reference_cases():
    lines = [line for line in REFERENCE.read_text().splitlines() if not line.startswith("#")]
    return [pytest.param(row, id=f"{row['case']}-{row['kind']}") for row in csv.DictReader(lines)]


@pytest.mark.parametrize("row", reference_cases())
def test_from_no_knowledge_both_vectors_give_the_covariance_of_the_q_method(row, carrying):
    """With a prior P0 I, the inverse of P is that of the reference's p_dav plus I / P0.

    Linearised where the reference is, at its optimal attitude: measured as predicted there, so that the
    estimate stays.
    """
    p = {key: float(row[f"p_dav_{key}"]) for key in ("xx", "yy", "zz", "xy", "xz", "yz")}
    expected = np.array(
        [[p["xx"], p["xy"], p["xz"]], [p["xy"], p["yy"], p["yz"]], [p["xz"], p["yz"], p["zz"]]]
    )
    prior_rad2 = 1e3 * max(p.values())
    config = carrying().config(
        magnetometer_sigma_t=float(row["sigma1_rad"]),
        sun_sigma_rad=float(row["sigma2_rad"]),
        attitude_sigma_rad=prior_rad2**0.5,
    )
    q = normalise(tuple(float(row[f"q_dav_{index}"]) for index in range(4)))
    r1, r2 = (tuple(float(row[f"{name}_{axis}"]) for axis in "xyz") for name in ("r1", "r2"))
    estimate = start(q, ZERO, config)
    estimate = update_field(estimate, rotate(q, r1), r1, config)
    estimate = update_sun(estimate, rotate(q, r2), r2, config)
    assert angle_rad(estimate.q_body_from_eci, q) < 1e-12
    information = np.linalg.inv(estimate.covariance[0:3, 0:3]) - np.eye(3) / prior_rad2
    scale = np.sqrt(expected.diagonal())
    ours = np.linalg.inv(information * np.outer(scale, scale))
    np.testing.assert_allclose(ours, expected / np.outer(scale, scale), rtol=1e-6, atol=1e-6)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow is what is tried
class TestGate:
    DIRECTIONS = (
        (1, 0, 0, 0, 0, 0),
        (0, 1, 0, 0, 0, 1),
        (0, 0, 1, 0, 1, 0),
        (0.5, -0.7, 0.4, -0.6, 0.8, 0.3),
    )
    BAD = (nan, inf, -inf)

    def on_the_boundary(self, kind, before, satellite, direction):
        """The innovation along ``direction`` whose NIS is exactly one."""
        h = satellite.sensitivity(kind, before, step=1e-3)
        s = h @ before.covariance @ h.T + np.diag(satellite.sigma[kind] ** 2)
        along = satellite.sigma[kind] * np.array(direction[: len(s)], dtype=float)
        return along / np.sqrt(along @ np.linalg.solve(s, along))

    @pytest.mark.parametrize("direction", DIRECTIONS)
    @pytest.mark.parametrize(("nis", "taken"), [(0.0, True), (16.2, True), (16.35, False), (1e6, False)])
    @pytest.mark.parametrize("kind", ["field", "sun", "both"])
    def test_by_the_normalised_innovation(self, kind, nis, taken, direction, satellite):
        """What the parameters may explain widens it."""
        before = satellite.estimate(parameters=NOTHING)
        innovation = nis**0.5 * self.on_the_boundary(kind, before, satellite, direction)
        measured = satellite.measured(kind, before) + innovation
        after = update(kind, before, measured, satellite, satellite.config())
        assert (after is not None) is taken

    def test_an_outlier_is_refused_where_the_filter_is_sure_and_taken_where_it_is_not(self, satellite):
        """Here the field, seen from 7 deg aside."""
        config, b = satellite.config(), rotate(satellite.q, satellite.b_eci_t)
        off = add(b, cross(b, (0.09, -0.05, 0.07)))
        sure = satellite.estimate(np.diag(satellite.scales() ** 2), NOTHING)
        unsure = replace(sure, covariance=config.initial_covariance * 100.0)
        assert update_field(sure, off, satellite.b_eci_t, config) is None
        assert update_field(unsure, off, satellite.b_eci_t, config) is not None

    @pytest.mark.parametrize("bad", BAD)
    @pytest.mark.parametrize("kind", ["field", "sun", "both"])
    def test_what_is_no_number_never_gets_through(self, kind, bad, satellite):
        config = satellite.config()
        for axis in range(len(satellite.sigma[kind])):
            measured = satellite.measured(kind, satellite.estimate())
            measured[axis] = bad
            for covariance in (satellite.covariance(), config.initial_covariance * 1e12):
                assert update(kind, satellite.estimate(covariance), measured, satellite, config) is None

    @pytest.mark.long
    @given(
        st.tuples(*[st.floats(-1e300, 1e300) | st.sampled_from(BAD)] * 6),
        st.sampled_from(["field", "sun", "both"]),
        st.floats(1e-6, 1e6),
    )
    @example((0.0, 8.59e86, -1.275e209, 0.0, 0.0, 1.0), "field", 1.0)  # overflows to a NIS of -inf
    @settings(max_examples=300, deadline=None)
    @pytest.mark.slow
    def test_whatever_is_measured_what_comes_out_is_sound(self, full, measured, kind, widen):
        config = full.config()
        before = full.estimate(config.initial_covariance * widen)
        after = update(kind, before, measured[: len(full.sigma[kind])], full, config)
        if after is not None:
            assert mekf.healthy(after)
            assert np.isfinite(after.covariance).all()


class TestInPlace:
    """A step changes the estimate itself, and replaces its arrays."""

    def traced(self, satellite):
        effect = np.random.default_rng(3).normal(size=(satellite.size(), 2))
        estimate = satellite.estimate()
        estimate.trace = Trace((Cause(1, 1.0, 0.1),), effect, np.eye(2), 3)
        return estimate

    def test_what_is_refused_changes_nothing(self, satellite):
        estimate, config = self.traced(satellite), satellite.config()
        before = pack(estimate)
        away = add(rotate(satellite.q, satellite.b_eci_t), (5e-5, -4e-5, 6e-5))
        aside = normalise((0.0, *rotate(satellite.q, satellite.s_eci)))[:0:-1]
        assert not mekf.update_field(estimate, away, satellite.b_eci_t, config)
        assert not mekf.update_sun(estimate, aside, satellite.s_eci, config)
        assert not mekf.update_both(estimate, away, satellite.b_eci_t, aside, satellite.s_eci, config)
        assert pack(estimate) == before

    def test_a_copy_goes_on_by_itself(self, satellite):
        estimate, config = self.traced(satellite), satellite.config()
        before, copy = pack(estimate), estimate.copy()
        assert pack(copy) == before
        words = (satellite.e1_eci, satellite.b_eci_t, satellite.gravity_ps2, satellite.driven_am2, config)
        mekf.predict(copy, *words)
        near = tuple(np.add(satellite.measured("field", copy), 1e-9).tolist())
        assert mekf.update_field(copy, near, satellite.b_eci_t, config)
        mekf.correct(copy, 1e-3 * satellite.scales(), copy.covariance, config)
        assert pack(estimate) == before != pack(copy)

    @pytest.mark.parametrize("kind", ["field", "sun", "both"])
    def test_frozen_parameters_keep_their_values_and_what_is_known_of_them(self, kind, full):
        estimate, config = full.estimate(), full.config()
        parameters, covariance = estimate.parameters.copy(), estimate.covariance
        values = np.array(full.measured(kind, estimate)) + 0.5 * full.sigma[kind]
        assert updated_frozen(kind, estimate, tuple(values.tolist()), full, config)
        assert estimate.parameters == parameters
        assert estimate.omega_body_radps != full.omega
        known = slice(6, None)
        free = full.estimate()
        assert update(kind, free, values, full, config).parameters != parameters
        if config.unobservable is None:
            np.testing.assert_allclose(estimate.covariance[known, known], covariance[known, known])


def updated_frozen(kind, estimate, values, satellite, config):
    b, s = satellite.b_eci_t, satellite.s_eci
    match kind:
        case "both":
            return mekf.update_both(estimate, values[:3], b, values[3:], s, config, frozen=True)
        case "field":
            return mekf.update_field(estimate, values, b, config, frozen=True)
        case _:
            return mekf.update_sun(estimate, values, s, config, frozen=True)


class TestHealthy:
    def test_a_sound_estimate_is(self, satellite):
        assert mekf.healthy(satellite.estimate())

    @pytest.mark.parametrize("bad", [nan, inf, -inf])
    @pytest.mark.parametrize("field", ["q_body_from_eci", "omega_body_radps"])
    def test_a_number_that_is_none_is_not(self, field, bad, full):
        values = getattr(full.estimate(), field)
        for index in range(len(values)):
            broken = (*values[:index], bad, *values[index + 1 :])
            assert not mekf.healthy(replace(full.estimate(), **{field: broken}))

    @pytest.mark.parametrize("bad", [nan, inf, -inf])
    @pytest.mark.parametrize("name", NAMES)
    def test_nor_is_one_among_the_parameters(self, name, bad, full):
        values = getattr(full.parameters, name)
        for index in range(len(values)):
            broken = Parameters(**{name: (*values[:index], bad, *values[index + 1 :])})
            assert not mekf.healthy(full.estimate(parameters=broken))

    @pytest.mark.parametrize("bad", [nan, inf, -1e-12, 2e6, 1e300])
    def test_a_variance_that_is_none_is_not(self, bad, satellite):
        for index in range(satellite.size()):
            covariance = satellite.covariance()
            covariance[index, index] = bad
            assert not mekf.healthy(satellite.estimate(covariance))

    def test_attitude_and_rate_are_never_exact_but_a_part_of_a_parameter_may_be(self, full):
        """Coils that are turned but not weak have a G with a zero diagonal, known exactly."""
        for index in range(full.size()):
            covariance = full.covariance()
            covariance[index, :] = covariance[:, index] = 0.0
            assert mekf.healthy(full.estimate(covariance)) is (index >= 6)

    @pytest.mark.filterwarnings("ignore::RuntimeWarning")
    def test_what_is_broken_off_the_diagonal_shows_after_one_prediction(self, full):
        for row, column in ((0, 1), (2, 7), (11, 3), (14, 30)):
            covariance = full.covariance()
            covariance[row, column] = nan
            after = predict(
                full.estimate(covariance), full.e1_eci, full.b_eci_t, full.gravity_ps2, ZERO, full.config()
            )
            assert not mekf.healthy(after)

    def test_an_inertia_that_has_come_to_nothing_ends_the_estimate_not_the_loop(self, full):
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = full.config().rotor.inertia_kgm2
        gone = (-xx, -yy, -zz, -xy, -xz, -yz)
        before = full.estimate()
        before = replace(before, parameters=replace(before.parameters, inertia_error_kgm2=gone))
        after = predict(before, full.e1_eci, full.b_eci_t, full.gravity_ps2, ZERO, full.config())
        assert mekf.healthy(before)
        assert not mekf.healthy(after)


class TestBothAtOnce:
    """Field and Sun in one update: what the two give one after the other, behind no laxer gate."""

    @pytest.mark.long
    @settings(max_examples=50, deadline=None)
    @given(st.tuples(*[st.floats(-1.0, 1.0)] * 6))
    def test_equals_one_after_the_other_to_first_order(self, satellite, offsets):
        config, b_eci_t, s_eci = satellite.config(), satellite.b_eci_t, satellite.s_eci
        estimate = start(satellite.q, satellite.omega, config)
        b = tuple((np.array(rotate(satellite.q, b_eci_t)) + 2e-8 * np.array(offsets[:3])).tolist())
        s = tuple((np.array(rotate(satellite.q, s_eci)) + 1e-3 * np.array(offsets[3:])).tolist())
        both = update_both(estimate, b, b_eci_t, s, s_eci, config)
        later = update_sun(update_field(estimate, b, b_eci_t, config), s, s_eci, config)
        sigma = np.sqrt(both.covariance.diagonal())
        apart = satellite.error(both, later) / np.sqrt(config.initial_covariance.diagonal())
        assert np.abs(apart).max() < 1e-3
        unit = np.outer(sigma, sigma)
        np.testing.assert_allclose(both.covariance / unit, later.covariance / unit, rtol=0.0, atol=5e-3)

    @pytest.mark.parametrize("kind", ["neither", "field", "sun"])
    def test_takes_neither_when_one_alone_is_far_off(self, kind, satellite):
        config = satellite.config(attitude_sigma_rad=1e-4, rate_sigma_radps=1e-6)
        estimate = start(satellite.q, satellite.omega, config)
        b, s = rotate(satellite.q, satellite.b_eci_t), rotate(satellite.q, satellite.s_eci)
        b = (b[0] + 1e-5, b[1], b[2]) if kind == "field" else b
        s = (s[0], s[1] + 0.2, s[2]) if kind == "sun" else s
        both = update_both(estimate, b, satellite.b_eci_t, s, satellite.s_eci, config)
        assert (both is None) is (kind != "neither")
