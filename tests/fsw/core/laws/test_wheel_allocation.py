"""Torque shared between coils and wheels: exact where it can be, of least effort."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.core.laws.interface import Wheel
from fsw.core.laws.wheel_allocation import (
    FLOORS,
    AllocationGains,
    affordable,
    least_effort,
    wheel_allocation,
)

B = (2.1e-5, -1.4e-5, 0.9e-5)
T = (2e-5, 5e-5, -3e-5)
AXES = ((0.48, -0.6, 0.64), (0.6, 0.8, 0.0), (0.0, 0.28, -0.96))
MOST_AM2, MOST_NM = 8.0, (2e-3, 1e-3, 5e-4)
PART = st.floats(-1.0, 1.0)
VECTOR = st.tuples(PART, PART, PART).filter(lambda v: np.linalg.norm(v) > 0.1)


def given_torque(shares, b=B, axes=AXES):
    """Of coils and wheels on the body."""
    wheels = zip(axes, shares.wheel_torques_nm, strict=False)
    return np.cross(shares.m_body_am2, b) - sum((t * np.array(w) for w, t in wheels), np.zeros(3))


@pytest.mark.parametrize("wheels", [1, 2, 3])
def test_with_a_wheel_that_reaches_along_the_field_the_whole_torque_is_given(wheels):
    shares = least_effort(T, B, AXES[:wheels], MOST_AM2, MOST_NM[:wheels])
    assert len(shares.wheel_torques_nm) == wheels
    assert given_torque(shares) == pytest.approx(T, rel=1e-9)


@pytest.mark.parametrize("wheels", [1, 2, 3])
@pytest.mark.parametrize("floor_nm", [0.0, 3e-5])
def test_it_is_the_least_squares_solution_of_another_implementation(wheels, floor_nm):
    """min |G u - T|^2 / e^2 + |R^(1/2) u|^2 by numpy; with e = 0 that of least norm."""
    sizes = np.array([MOST_AM2] * 3 + list(MOST_NM[:wheels]))
    b1, b2, b3 = B
    coils = np.array([[0.0, b3, -b2], [-b3, 0.0, b1], [b2, -b1, 0.0]])  # m x b
    g = np.column_stack([coils, *AXES[:wheels]]) * sizes
    if floor_nm:
        left = np.vstack([g / floor_nm, np.eye(3 + wheels)])
        u = np.linalg.lstsq(left, np.array([*np.array(T) / floor_nm, *[0.0] * (3 + wheels)]), rcond=None)[0]
    else:
        u = np.linalg.lstsq(g, np.array(T), rcond=None)[0]
    shares = least_effort(T, B, AXES[:wheels], MOST_AM2, MOST_NM[:wheels], floor_nm)
    mine = np.array([*shares.m_body_am2, *(-t for t in shares.wheel_torques_nm)])
    assert mine == pytest.approx(u * sizes, rel=1e-6, abs=1e-12)


def test_without_a_wheel_it_is_the_projection_across_the_field():
    shares = least_effort(T, B, (), MOST_AM2, (), floor_nm=1e-8)
    across = np.array(T) - np.dot(T, B) / np.dot(B, B) * np.array(B)
    assert given_torque(shares) == pytest.approx(across, rel=1e-5)
    assert least_effort(T, B, (), MOST_AM2, ()) is None


def test_with_a_wheel_normal_to_the_field_nothing_is_given_along_it():
    axis = np.cross(B, T) / np.linalg.norm(np.cross(B, T))
    assert least_effort(T, B, (tuple(axis),), MOST_AM2, MOST_NM[:1]) is None
    shares = least_effort(T, B, (tuple(axis),), MOST_AM2, MOST_NM[:1], floor_nm=1e-6)
    assert np.dot(given_torque(shares, axes=(axis,)), B) == pytest.approx(0.0, abs=1e-15)


def test_without_a_field_nothing_can_be_shared():
    assert least_effort(T, (0.0, 0.0, 0.0), AXES[:1], MOST_AM2, MOST_NM[:1]) is None
    assert affordable(T, (0.0, 0.0, 0.0), AXES[0], MOST_AM2, MOST_NM[0]) is None


@settings(max_examples=60, deadline=None)
@given(torque=VECTOR, field=VECTOR, axis=VECTOR, size=st.floats(1e-8, 1e-2))
def test_what_is_affordable_is_within_the_limits(torque, field, axis, size):
    axis = tuple(np.array(axis) / np.linalg.norm(axis))
    torque, field = tuple(size * np.array(torque)), tuple(3e-5 * np.array(field))
    m, wheel_nm = affordable(torque, field, axis, MOST_AM2, MOST_NM[0])
    assert np.linalg.norm(m) <= MOST_AM2 * (1.0 + 1e-9)
    assert abs(wheel_nm) <= MOST_NM[0] * (1.0 + 1e-9)


@pytest.mark.parametrize("most_nm", [2e-3, 0.05, 1.0, 50.0])
@pytest.mark.parametrize("cosine", [1.0, 0.1, 0.003])
def test_a_wheel_however_strong_and_weak_coils_give_the_whole_torque_if_they_can(most_nm, cosine):
    """Coils of 1.6e-6 N m across the field, which they have to give 7e-7 N m of."""
    along = np.array(B) / np.linalg.norm(B)
    normal = np.cross(along, (1.0, 0.0, 0.0)) / np.linalg.norm(np.cross(along, (1.0, 0.0, 0.0)))
    axis = tuple((cosine * along + np.sqrt(1.0 - cosine**2) * normal).tolist())
    torque = tuple((5e-7 * cosine * along + 4e-7 * np.cross(along, normal) - 1e-7 * normal).tolist())
    effort = affordable(torque, B, axis, 0.06, most_nm)
    given = np.cross(effort.m_body_am2, B) - effort.wheel_torque_nm * np.array(axis)
    assert np.linalg.norm(effort.m_body_am2) <= 0.06
    assert given == pytest.approx(torque, abs=1e-11)


def test_a_strong_wheel_is_used_up_to_its_own_limit():
    along = np.array(B) / np.linalg.norm(B)
    effort = affordable(tuple(0.04 * along), B, tuple(along), 0.06, 0.05)
    assert effort.wheel_torque_nm == pytest.approx(-0.04, rel=1e-6)


def nearly_normal_wheel():
    """Directions along the field and normal to it, and a wheel's axis that leans from the second by 0.01."""
    along = np.array(B) / np.linalg.norm(B)
    normal = np.cross(along, (1.0, 0.0, 0.0))
    normal /= np.linalg.norm(normal)
    axis = normal + 0.01 * along
    return along, normal, tuple(axis / np.linalg.norm(axis))


def test_what_costs_too_much_is_given_up_along_the_field_first():
    """The wheel nearly normal to the field: across it the torque is still almost all there."""
    along, _, axis = nearly_normal_wheel()
    effort = affordable(T, B, axis, MOST_AM2, MOST_NM[0])
    given = np.cross(effort.m_body_am2, B) - effort.wheel_torque_nm * np.array(axis)
    across = np.array(T) - np.dot(T, along) * along
    assert np.linalg.norm(np.cross(given - across, along)) < 0.4 * np.linalg.norm(across)
    assert np.dot(given, across) > 0.6 * np.dot(across, across)
    assert abs(np.dot(given, along)) < abs(np.dot(T, along))


def test_what_is_given_up_is_by_the_least_floor_with_the_wheels_own_limit():
    """Of the effort, as ``least_effort`` weighs it: the first of the floors that the coils can pay."""
    along, normal, axis = nearly_normal_wheel()
    unit_nm = MOST_AM2 * float(np.linalg.norm(B))
    weak_nm, torque = 0.2 * unit_nm, tuple(0.05 * unit_nm * (0.6 * along + 0.8 * normal))
    tried = [
        least_effort(torque, B, (axis,), MOST_AM2, (weak_nm,), floor * unit_nm) for floor in (0.0, *FLOORS)
    ]
    paid = [
        shares
        for shares in tried
        if np.linalg.norm(shares.m_body_am2) <= MOST_AM2 and abs(shares.wheel_torques_nm[0]) <= weak_nm
    ]
    effort = affordable(torque, B, axis, MOST_AM2, weak_nm)
    assert 0 < len(paid) < len(tried)
    assert effort.m_body_am2 == pytest.approx(paid[0].m_body_am2, rel=1e-9)
    assert effort.wheel_torque_nm == pytest.approx(paid[0].wheel_torques_nm[0], rel=1e-9)


class TestInFlight:
    """The 50 kg body at 51.6 deg with a wheel along axis 3."""

    def flown(self, bench, turned, torque=(3e-8, -2e-8, 4e-8), orbits=1.0, first_deg=15.0, **gains):
        wheel = Wheel((0.0, 0.0, 1.0), 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=4.0, stale_ticks=10)
        body = bench.Body(most_am2=8.0, torque=torque, driven=wheel)
        orbit = bench.Orbit(500.0, 51.6)
        return bench.fly(
            wheel_allocation,
            bench.setpoint("wheel_allocation"),
            gains={"wheel_allocation": AllocationGains(**gains)},
            orbit=orbit,
            body=body,
            c_body_from_orbit=turned((1, -2, 3), first_deg),
            omega_body=(0.0, 0.0, orbit.rate_radps),
            seconds=orbits * orbit.period_s,
        )

    def test_it_comes_to_rest_from_forty_degrees(self, bench, turned):
        flight = self.flown(bench, turned, first_deg=40.0, orbits=0.5)
        assert flight.angle_deg[-100:].max() < 0.1

    @pytest.mark.long
    def test_a_torque_about_the_wheel_fills_it(self, bench, turned):
        """By the torque times the time: the attitude held, nothing takes it away."""
        flight = self.flown(bench, turned, torque=(0.0, 0.0, 5e-7), first_deg=0.0)
        half = len(flight.t_s) // 2
        gained = flight.wheel_nms[-1] - flight.wheel_nms[half]
        assert gained == pytest.approx(5e-7 * (flight.t_s[-1] - flight.t_s[half]), rel=0.15)


@pytest.mark.parametrize("wrong", [{"frequency_radps": 0.0}, {"damping": -1.0}])
def test_gains_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        AllocationGains(**wrong)
