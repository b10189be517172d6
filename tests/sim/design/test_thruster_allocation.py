"""A torque shared between coils and thrusters: given whole, within limits, with the least propellant."""

import numpy as np
import pytest

from sim.design.theory.bodies import BODIES
from sim.design.thruster_allocation import demands, given, pairs, propellant, share

BODY = BODIES[2]
ALL = pairs(1e-3, (0, 1, 2))
WANTED = demands(BODY, 2e-5, 15, 3)


def test_the_torque_is_given_whole_and_within_the_limits():
    for torque, b in zip(*WANTED, strict=True):
        found = share(torque, b, ALL, 0.7)
        assert np.cross(found.m_body_am2, b) + found.parts @ ALL == pytest.approx(torque, abs=1e-11)
        assert np.abs(found.m_body_am2).max() <= 0.7 * (1.0 + 1e-9)
        assert found.parts.min() >= 0.0


def test_with_strong_coils_thrusters_give_what_is_least_of_all_torques_with_the_part_along_b():
    """Of a torque T with T . b = M . b the least |T_1| + |T_2| + |T_3| is |M . b| / max |b_i|."""
    for torque, b in zip(*WANTED, strict=True):
        found = share(torque, b, ALL, 1e4)
        assert 1e-3 * found.parts.sum() == pytest.approx(
            abs(torque @ b) / np.abs(b).max(), rel=1e-6, abs=1e-12
        )


def test_without_coils_each_axis_has_its_thruster():
    for torque, b in zip(*WANTED, strict=True):
        assert 1e-3 * share(torque, b, ALL, 0.0).parts.sum() == pytest.approx(np.abs(torque).sum())


def test_what_cannot_be_given_is_said():
    b = np.array([0.0, 2e-5, 0.0])
    assert share(np.array([0.0, 1e-6, 0.0]), b, pairs(1e-3, (0, 2)), 10.0) is None
    assert share(np.array([0.0, 2e-3, 0.0]), b, ALL, 10.0) is None
    assert share(np.zeros(3), b, ALL, 10.0).parts.tolist() == [0.0] * 6


def test_coils_save_propellant_and_no_coils_save_none():
    with_coils, without = propellant(WANTED, ALL, 2.0), propellant(WANTED, ALL, 0.0)
    assert with_coils < 0.6 * without
    assert given(WANTED, ALL, 2.0) == 1.0
    assert given(WANTED, pairs(1e-3, (2,)), 0.0) == 0.0
    assert np.isnan(propellant(WANTED, pairs(1e-3, (2,)), 0.0))
