"""The laws of a pitch wheel compared: what yaw and springs are worth, and that averaging says the same."""

from math import sin

import numpy as np
import pytest

from sim.design.pitch_wheel_gains import LAWS, slowest
from sim.design.theory.bodies import Body, diagonal

BODY = Body("wheeled", diagonal((1.9, 1.95, 2.0)), 800.0, 98.6, (0.0, 0.0, 0.05))
STRONG = Body("strong", diagonal((1.9, 1.95, 2.0)), 800.0, 98.6, (0.0, 0.0, 0.5))
K1, K3 = 8000.0, 1e7


@pytest.fixture(scope="module")
def compared():
    return slowest(BODY, K1, K3)


def test_all_are_stable_and_faster_with_more_measured(compared):
    degrees = [compared[name] for name in LAWS][:4]
    assert max(degrees) < 0.0
    assert degrees == sorted(degrees, reverse=True)


def test_a_spring_of_either_sign_helps_alike(compared):
    plain = compared["roll and yaw"]
    assert LAWS["roll and yaw, springs reversed"].k5 < 0.0 < LAWS["roll and yaw, springs"].k5
    for name in ("roll and yaw, springs", "roll and yaw, springs reversed"):
        assert compared[name] / plain == pytest.approx(10.0 / 9.0, rel=0.02)


def test_averaging_says_the_same_of_a_strong_wheel():
    """9/8 (k1 + w0 k3) B0^2 sin^2 i / (h w0): the rates of the precession are w0 times the angles."""
    w0 = STRONG.rate_radps
    across = (STRONG.field_t * sin(np.radians(98.6))) ** 2
    expected = -9.0 / 8.0 * (K1 + w0 * K3) * across / (0.5 * w0)
    assert slowest(STRONG, K1, K3)["roll and yaw"] == pytest.approx(expected, rel=0.02)
