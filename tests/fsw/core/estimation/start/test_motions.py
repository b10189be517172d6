"""Many motions at once against the filter's own motion, one tick after the other."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, inverse, unit
from fsw.core.estimation.dynamics.motion import Acting, advanced, middle, turn
from fsw.core.estimation.parameters import Rotor
from fsw.core.estimation.start.motions import (
    MOST_STEPS,
    STEP_RAD,
    Disturbed,
    Leg,
    all_in_body,
    flown,
    in_body,
    steps_of_leg,
    turned_by,
)

INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
CHANGE = (0.03, -0.04, 0.02, 0.01, -0.015, 0.02)
WHEEL = (0.01, -0.02, 0.015)
E1, B, GRAVITY = unit((0.3, 0.7, -0.5)), (1.7e-5, -2.3e-5, 3.1e-5), 3.3e-6
M, D, T = (0.5, -0.8, 0.3), (0.02, 0.03, -0.01), (4e-8, -2e-8, 3e-8)
RANDOM = np.random.default_rng(7)
Q = np.array([normalise(tuple(v)) for v in RANDOM.normal(size=(5, 4))])
OMEGA = RANDOM.uniform(-0.006, 0.006, (5, 3))


def rows(v):
    return np.tile(v, (5, 1)).astype(float)


def leg(length_s):
    return Leg(length_s, np.array(E1), np.array(B), GRAVITY, np.array(M))


def test_in_body_is_the_turn_of_the_core():
    v, w = (0.3, -1.2, 0.7), (-2.0, 0.4, 1.1)
    for q, found in zip(Q, in_body(Q, np.array(v)), strict=True):
        assert found == pytest.approx(rotate(tuple(q), v))
    both = all_in_body(Q, np.array((v, w)))
    np.testing.assert_array_equal(both[0].T, in_body(Q, np.array(v)))
    np.testing.assert_array_equal(both[1].T, in_body(Q, np.array(w)))


def test_turned_by_is_a_further_turn_of_the_body():
    small = (1e-4, -2e-4, 1.5e-4)
    for q, found in zip(Q, turned_by(Q, rows(small)), strict=True):
        expected = normalise(multiply(tuple(q), (1.0, *(0.5 * part for part in small))))
        assert found == pytest.approx(expected)


def stepped(q, omega, torque, rotor, seconds):
    """The filter's own motion, a second at a time."""
    m = tuple(np.add(M, D))
    for _ in range(seconds):
        acting = Acting(E1, B, GRAVITY, m, torque, rotor)
        _, motion = middle(q, omega, acting, 1.0)
        rotation, omega = advanced(q, omega, motion, acting, 1.0)
        q = normalise(multiply(q, turn(rotation)))
    return q, omega


@pytest.mark.parametrize("wheel", [ZERO, WHEEL])
def test_a_leg_leads_where_single_ticks_lead(wheel):
    rotor = Rotor(INERTIA, inverse(INERTIA), wheel)
    disturbed = Disturbed(rows(D), rows(T), np.zeros((5, 6)))
    ends, rates = flown(Q, OMEGA, leg(20.0), disturbed, rotor)
    for q, omega, end, rate in zip(Q, OMEGA, ends, rates, strict=True):
        expected, after = stepped(tuple(q), tuple(omega), T, rotor, 20)
        assert abs(np.dot(end, expected)) == pytest.approx(1.0, abs=1e-7)
        np.testing.assert_allclose(rate, after, atol=2e-6)


class TestFast:
    """What turns far in a leg takes several steps, and leaves the bits of the others as they are."""

    ROTOR = Rotor(INERTIA, inverse(INERTIA), WHEEL)
    DISTURBED = Disturbed(rows(D), rows(T), np.zeros((5, 6)))

    @pytest.mark.parametrize("degps", [3.0, 5.0])
    def test_twenty_legs_lead_where_single_ticks_lead(self, degps):
        fast = np.radians(degps) * OMEGA / np.linalg.norm(OMEGA, axis=1)[:, None]
        ends, rates = Q, fast
        for _ in range(20):
            ends, rates = flown(ends, rates, leg(20.0), self.DISTURBED, self.ROTOR)
        for q, omega, end in zip(Q, fast, ends, strict=True):
            expected, _ = stepped(tuple(q), tuple(omega), T, self.ROTOR, 400)
            assert abs(np.dot(end, expected)) > np.cos(np.radians(0.25))

    def test_a_slow_one_beside_a_fast_one_keeps_its_bits(self):
        mixed = OMEGA.copy()
        mixed[2] = (0.05, -0.06, 0.04)
        alone, beside = (flown(Q, rates, leg(20.0), self.DISTURBED, self.ROTOR) for rates in (OMEGA, mixed))
        slow = [0, 1, 3, 4]
        for one, other in zip(alone, beside, strict=True):
            np.testing.assert_array_equal(one[slow], other[slow])
            assert (one[2] != other[2]).all()

    def test_those_that_are_alike_take_the_steps_of_the_first(self):
        """One just above the limit beside one just below: the difference is that of the motions alone."""
        rate = STEP_RAD / 20.0
        q, turning = Q[[0, 0]], np.array([[0.0, 0.0, 0.99999 * rate], [0.0, 0.0, 1.00001 * rate]])
        of_two = self.DISTURBED.chosen(slice(2))
        ends, _ = flown(q, turning, leg(20.0), of_two, self.ROTOR, alike=1)
        first, _ = flown(q[:1], turning[:1], leg(20.0), of_two.chosen(slice(1)), self.ROTOR)
        np.testing.assert_array_equal(ends[0], first[0])
        moved = 2.0 * np.linalg.norm(ends[1] - ends[0])
        assert moved == pytest.approx(20.0 * (turning[1, 2] - turning[0, 2]), rel=0.1)

    def test_the_steps_are_as_many_as_the_turn_needs_and_not_more_than_there_can_be(self):
        turns = np.array([0.0, 0.99, 1.01, 3.5, 1e3, np.inf, np.nan])
        omega = np.outer(turns * STEP_RAD / 20.0, (0.6, -0.48, 0.64))
        assert steps_of_leg(omega, 20.0).tolist() == [1, 1, 2, 4, MOST_STEPS, MOST_STEPS, 1]


def test_another_inertia_is_that_to_first_order():
    xx, yy, zz, xy, xz, yz = CHANGE
    changed = np.add(INERTIA, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    true = Rotor(
        tuple(map(tuple, changed.tolist())), tuple(map(tuple, np.linalg.inv(changed).tolist())), WHEEL
    )
    rotor = Rotor(INERTIA, inverse(INERTIA), WHEEL)
    fast = 10.0 * OMEGA
    none = np.zeros((5, 6))
    _, exact = flown(Q, fast, leg(5.0), Disturbed(rows(D), rows(T), none), true)
    _, nominal = flown(Q, fast, leg(5.0), Disturbed(rows(D), rows(T), none), rotor)
    _, first = flown(Q, fast, leg(5.0), Disturbed(rows(D), rows(T), rows(CHANGE)), rotor)
    assert np.abs(first - exact).max() < 0.15 * np.abs(nominal - exact).max()
