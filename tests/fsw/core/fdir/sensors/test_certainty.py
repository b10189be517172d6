"""How far the attitude of an estimate may be off, and where its linear equations no longer judge a sample."""

from math import cos, radians, sin

import numpy as np
import pytest
from filter_steps import plain_filter
from with_values import with_values

from fsw.core.algebra.vector import cross
from fsw.core.estimation import mekf
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.sensors.certainty import (
    UNSURE_RAD,
    across_variance,
    is_linear,
    is_linear_cosine,
    is_unsure,
    turn_variance,
)

CONFIG = plain_filter((1.0, 2.0, 3.0))
AXIS = (0.6, 0.0, 0.8)
NOISE, AXES = 0.01**2 * np.eye(3), np.eye(3)


def known(*sigmas_rad, along=AXES):
    """An estimate with these standard deviations of its attitude about the columns of ``along``."""
    estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0,) * 3, CONFIG)
    covariance = estimate.covariance.copy()
    covariance[0:3, 0:3] = along @ np.diag(np.square(sigmas_rad)) @ along.T
    return with_values(estimate, covariance=covariance)


def seen(v):
    """A direction and H of it."""
    rows = np.zeros((3, CONFIG.layout.size))
    rows[:, 0:3] = np.array([cross(v, tuple(axis)) for axis in AXES.tolist()]).T
    return v, rows


@pytest.mark.parametrize(
    ("sigmas_rad", "unsure"),
    [((0.05, 0.05, 0.05), False), ((0.0, 0.0, 0.099), False), ((0.0, 0.0, 0.101), True), ((0.06,) * 3, True)],
)
def test_it_is_unsure_by_all_axes_together(sigmas_rad, unsure):
    assert is_unsure(known(*sigmas_rad)) == unsure
    assert UNSURE_RAD == 0.1


def test_an_attitude_of_damaged_numbers_is_unsure():
    assert is_unsure(known(float("nan"), 0.01, 0.01))


def test_a_turn_about_a_direction_does_not_move_it():
    estimate = known(0.3, 0.02, 0.01)
    assert across_variance(estimate, (1.0, 0.0, 0.0)) == pytest.approx(0.02**2 + 0.01**2)
    assert across_variance(estimate, (0.0, 1.0, 0.0)) == pytest.approx(0.3**2 + 0.01**2)
    assert turn_variance(estimate, (0.0, 0.0, 2.0)) == pytest.approx(4.0 * 0.01**2)


def turned(v, axis, angle):
    """The vector as axes show it that are turned about a unit vector across it."""
    return np.cos(angle) * np.array(v) - np.sin(angle) * np.array(cross(axis, v))


@pytest.mark.parametrize("sigma_rad", [0.01, 0.05, 0.065, 0.078, 0.15, 0.6])
def test_where_it_is_linear_noise_hides_what_the_equations_leave_out(sigma_rad):
    """Of a turn by ``SIGMAS`` standard deviations about one axis."""
    v, axis = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    estimate, prediction = known(sigma_rad, 0.0, 0.0), seen(v)
    angle = SIGMAS * sigma_rad
    left_out = turned(v, axis, angle) - (np.array(v) + prediction[1][:, 0:3] @ (angle * np.array(axis)))
    hidden = float(left_out[2]) >= -SIGMAS * 0.01 * 1.01
    assert is_linear(estimate, prediction, NOISE) == hidden


def test_a_turn_about_the_direction_itself_leaves_it_linear():
    about = np.array((AXIS, (0.0, 1.0, 0.0), (-0.8, 0.0, 0.6))).T
    estimate = known(1.0, 0.01, 0.01, along=about)
    assert is_linear(estimate, seen(AXIS), NOISE)
    assert not is_linear(estimate, seen((0.0, 1.0, 0.0)), NOISE)


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 60.0])
@pytest.mark.parametrize(("sigma_deg", "linear"), [(1.0, True), (37.0, False)])
def test_a_cell_is_judged_by_its_cosine_where_that_is_linear(angle_deg, sigma_deg, linear):
    angle, sigma = radians(angle_deg), radians(sigma_deg)
    s, normal = (0.0, 0.0, 1.0), (sin(angle), 0.0, cos(angle))
    row = np.zeros((1, CONFIG.layout.size))
    row[0, 0:3] = cross(normal, s)
    estimate = known(sigma, sigma, sigma)
    assert is_linear_cosine(estimate, cos(angle), s, row, 0.01) == linear
