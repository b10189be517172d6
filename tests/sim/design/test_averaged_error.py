"""Feedback of an averaged error: its motion step by step, its error, and what the search finds."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.design.averaged_error import AveragedError, degree, error_matrix, search
from sim.design.theory.bodies import Body

BODY = Body("full", ((1.02, 0.02, 0.01), (0.02, 1.85, -0.03), (0.01, -0.03, 1.95)), 800.0, 98.6)
LAW = AveragedError(3.5e6, 900.0, 0.6, 2.0)


def test_near_the_goal_the_error_is_that_of_two_directions():
    """2 sum of w_i (C r_i) x u_i, beside the matrix."""
    theta = 1e-6 * np.array([1.0, -2.0, 3.0])
    c = Rotation.from_rotvec(theta).as_matrix().T
    parts = [2.0 * w * np.cross(c @ u, u) for w, u in ((0.3, np.eye(3)[0]), (0.7, np.eye(3)[2]))]
    assert error_matrix(0.3) @ theta == pytest.approx(sum(parts), rel=1e-4)


@pytest.mark.parametrize("law", [LAW, LAW._replace(orbits=0.0), LAW._replace(k_w=-1e6)])
def test_the_degree_is_that_of_the_motion(law):
    """Linear motion in small steps of Euler, the dipole held over 1/48 orbit, from nine starts."""
    j, w0, i = np.array(BODY.inertia_kgm2), BODY.rate_radps, np.radians(98.6)
    e1, e3 = np.eye(3)[0], np.eye(3)[2]
    parts = 200
    h = 2.0 * pi / w0 / 48 / parts
    over = 1.0 if law.orbits == 0.0 else 1.0 - np.exp(-1.0 / 48.0 / law.orbits)

    def matrix(of):
        return np.array([of(axis) for axis in np.eye(3)]).T

    def torque(rate, turn):
        """To first order about the nominal attitude: gyroscopic, and of the gravity gradient."""
        a = rate - w0 * np.cross(turn, e3)
        gyro = -np.cross(a, j @ (w0 * e3)) - w0 * np.cross(e3, j @ a)
        down = -np.cross(turn, e1)
        return gyro + 3.0 * w0**2 * (np.cross(down, j @ e1) + np.cross(e1, j @ down))

    by_rate = np.linalg.inv(j) @ matrix(lambda v: torque(v, np.zeros(3)))
    by_rate += matrix(lambda v: w0 * np.cross(v, e3))
    by_turn = np.linalg.inv(j) @ matrix(lambda v: torque(np.zeros(3), v))
    step = np.block([[np.eye(3) + h * by_rate, h * by_turn], [h * np.eye(3), np.eye(3)]])
    whole, held = np.eye(6), np.zeros((6, 6))
    for _ in range(parts):
        held = held + whole
        whole = step @ whole
    ends = []
    for start in np.diag(np.repeat([w0, 1.0, 1.0], 3)):
        omega, theta, mean = np.split(start, 3)
        for u in 2.0 * pi * (np.arange(48) + 0.5) / 48:
            b = BODY.field_t * np.array([-2.0 * np.sin(i) * np.sin(u), np.sin(i) * np.cos(u), np.cos(i)])
            mean = mean + over * (error_matrix(law.share) @ theta - mean)
            m = -np.cross(b, law.k_w * omega + law.k_a * mean)
            push = held[:, :3] @ np.linalg.solve(j, np.cross(m, b)) * h
            omega, theta = np.split(whole @ np.concatenate([omega, theta]) + push, 2)
        ends.append(np.concatenate([omega / w0, theta, mean]))
    largest = np.abs(np.linalg.eigvals(np.array(ends).T)).max()
    assert degree(BODY, law) == pytest.approx(np.log(largest) / (2.0 * pi), abs=0.005)


@pytest.mark.long
def test_the_search_finds_gains_that_hold_and_none_better_nearby():
    found = search(BODY, 1.0)
    assert found.degree < -0.15
    assert degree(BODY, found.law) == pytest.approx(found.degree)
    for factor in (0.5, 2.0):
        for other in ({"k_w": factor * found.law.k_w}, {"k_a": factor * found.law.k_a}):
            assert degree(BODY, found.law._replace(**other)) > found.degree


def test_over_the_equator_the_field_stands_still_and_nothing_holds():
    assert degree(replace(BODY, inclination_deg=0.0), LAW) > -0.01
