"""Attitude algebra on histories, against the flight software's own and scipy's."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import canonical, conjugate, dcm, multiply, rotate
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, normal_in_body, relative

seeds = st.integers(0, 2**32 - 1)


def quaternions(seed, count=20):
    return Rotation.random(count, np.random.default_rng(seed)).as_quat(scalar_first=True)


@pytest.mark.long
@given(seeds)
def test_relative_is_the_turn_from_the_first_to_the_second(seed):
    p, q = quaternions(seed), quaternions(seed + 1)
    for turn, first, second in zip(relative(p, q), p, q, strict=True):
        expected = canonical(multiply(conjugate(tuple(first)), tuple(second)))
        assert tuple(turn) == pytest.approx(expected, abs=1e-14)


def test_of_an_attitude_and_itself_there_is_no_turn_whatever_the_signs():
    q = quaternions(1)
    np.testing.assert_allclose(relative(q, -q), np.tile([1.0, 0.0, 0.0, 0.0], (20, 1)), atol=1e-15)


def test_what_is_unknown_stays_unknown():
    q = quaternions(1, 3)
    unknown = np.vstack((q[:1], np.full((1, 4), np.nan), q[2:]))
    assert np.isnan(relative(unknown, q)).any(axis=1).tolist() == [False, True, False]
    assert np.isnan(angle_rad(relative(unknown, q))).tolist() == [False, True, False]


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 1.0, pi / 2, 3.0, pi])
def test_angle_is_exact_from_nothing_to_a_half_turn(angle):
    axis = np.array([0.6, -0.48, 0.64])
    turn = np.array([[np.cos(angle / 2), *(np.sin(angle / 2) * axis)]])
    assert angle_rad(turn)[0] == pytest.approx(angle, rel=1e-12, abs=1e-16)
    assert angle_rad(-turn)[0] == pytest.approx(angle, rel=1e-12, abs=1e-16)


@pytest.mark.long
@given(seeds)
def test_axis_1_against_the_vertical_and_the_normal_in_the_body(seed):
    q = quaternions(seed)
    for one, angle, normal in zip(q, axis1_angle_rad(q), normal_in_body(q), strict=True):
        assert np.cos(angle) == pytest.approx(dcm(tuple(one))[0][0], abs=1e-14)
        assert tuple(normal) == pytest.approx(rotate(tuple(one), (0.0, 0.0, 1.0)), abs=1e-14)


def test_a_turn_about_the_vertical_does_not_tilt_axis_1():
    about = np.array([[np.cos(0.7), np.sin(0.7), 0.0, 0.0]])
    assert axis1_angle_rad(about)[0] == 0.0
    assert angle_rad(about)[0] == pytest.approx(1.4)


@pytest.mark.parametrize("tilt", [1e-8, 0.1, pi / 2, 3.1, pi])
def test_a_tilt_does(tilt):
    q = np.array([[np.cos(tilt / 2), 0.0, 0.6 * np.sin(tilt / 2), -0.8 * np.sin(tilt / 2)]])
    assert axis1_angle_rad(q)[0] == pytest.approx(tilt, rel=1e-9)
