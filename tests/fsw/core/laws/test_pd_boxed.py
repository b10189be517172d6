"""The nearest torque within the limits: bounded least squares, nearer than the projection cut to them."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.pd import pd
from fsw.core.laws.pd_boxed import boxed, boxed_dipole, boxed_far
from fsw.core.laws.projection import torque_dipole

MOST = 0.5


def cases():
    rng = np.random.default_rng(7)
    return [(rng.standard_normal(3) * 2e-5, rng.standard_normal(3) * 2e-5) for _ in range(60)]


def miss(m, b, torque):
    return np.linalg.norm(np.cross(m, b) - torque)


def test_no_dipole_within_the_limits_comes_nearer():
    for b, torque in cases():
        found = boxed_dipole(tuple(torque), tuple(b), MOST)
        best = lsq_linear(np.cross(np.eye(3), b).T, torque, (-MOST, MOST)).x
        assert max(map(abs, found)) <= MOST
        size = np.linalg.norm(b) * MOST
        assert miss(found, b, torque) <= miss(best, b, torque) + 2e-3 * size


def test_the_projection_cut_to_the_limits_is_never_nearer_and_often_farther():
    """What the source claims for least squares: of the cases in which a limit is met, most."""
    misses = []
    for b, torque in cases():
        free = np.array(torque_dipole(tuple(torque), tuple(b)))
        cut = np.clip(free, -MOST, MOST)
        if np.array_equal(free, cut):
            continue
        found = boxed_dipole(tuple(torque), tuple(b), MOST)
        misses.append((miss(found, b, torque), miss(cut, b, torque), np.linalg.norm(b) * MOST))
    found, cut, size = np.array(misses).T
    assert np.all(found <= cut + 2e-3 * size)
    assert len(size) > 20
    assert np.mean(found < cut - 1e-3 * size) > 0.5


def test_where_no_limit_is_met_the_torque_is_that_of_the_projection():
    for b, torque in cases():
        small = 1e-3 * torque
        projected = np.cross(torque_dipole(tuple(small), tuple(b)), b)
        given = np.cross(boxed_dipole(tuple(small), tuple(b), MOST), b)
        assert np.linalg.norm(given - projected) < 3e-4 * MOST * np.linalg.norm(b)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_along_the_field_no_dipole_is_wasted(axis):
    """A field along a coil: what that coil does is nothing to the torque."""
    b, torque = np.zeros(3), np.array([1e-6, -2e-6, 3e-6])
    b[axis] = 3e-5
    assert boxed_dipole(tuple(torque), tuple(b), MOST)[axis] == 0.0
    assert np.abs(boxed_dipole(tuple(torque), tuple(b), MOST)).max() > 0.01


@pytest.mark.interpreted
@pytest.mark.parametrize("most", [0, 1, 4])
def test_the_search_ends_after_so_many_changes_of_a_coil(monkeypatch, most):
    """At most two more, within a round of all three."""
    monkeypatch.setattr("fsw.core.laws.pd_boxed.UPDATES", most)
    for b, torque in cases():
        bits = np.abs(boxed_dipole(tuple(torque), tuple(b), MOST)) / MOST * 2**15
        changes = sum(int(bit).bit_count() for bit in bits)
        assert changes <= most + 2 if most else changes == 0


def test_without_a_field_there_is_no_dipole():
    assert boxed_dipole((1e-6, 0.0, 0.0), (0.0, 0.0, 0.0), MOST) == (0.0, 0.0, 0.0)


@pytest.mark.long
def test_with_coils_at_their_limits_it_flies_as_pd_does(bench, turned):
    """10 mA m^2: the sum of the squared angle from 40 deg. A nearer torque is not a quicker flight."""
    body = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=0.01)

    def cost(law):
        flown = bench.fly_from_rest(
            law,
            bench.setpoint(k_w=6.2694e6, k_a=1614.9),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), 40.0),
            orbits=1.5,
            step_s=20.0,
        )
        return np.sum(flown.angle_deg**2)

    assert cost(boxed) == pytest.approx(cost(pd), rel=0.05)


@pytest.mark.parametrize("law", [boxed, boxed_far])
def test_without_an_attitude_nothing_is_asked_for(bench, law):
    orbit, settings = bench.Orbit(), bench.config(bench.Body(most_am2=2.0), 1.0)
    inputs = bench.inputs_at(orbit, 9, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    point = bench.setpoint(k_a=1600.0)
    assert any(law(inputs, (), point, settings).m_body_am2)
    assert law(inputs.replace(attitude=UNKNOWN), (), point, settings).m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("law", "angle_deg"), [(boxed, 60.0), (boxed_far, 60.0), (boxed_far, 170.0)])
def test_the_torque_is_against_the_turn(bench, turned, law, angle_deg):
    """From rest in the orbital frame, in fields of many places; both signs of a quaternion are one turn."""
    orbit, settings = bench.Orbit(), bench.config(bench.Body(most_am2=2.0), 1.0)
    c = turned((1, -2, 3), angle_deg)
    for tick in range(0, 6000, 700):
        omega = orbit.rate_radps * c[:, 2]
        inputs = bench.inputs_at(orbit, tick, 1.0, c @ orbit.c_orbit_from_eci(float(tick)), omega, None)
        other = inputs.attitude.replace(
            q_body_from_orbit=tuple(-x for x in inputs.attitude.q_body_from_orbit)
        )
        for attitude in (inputs.attitude, other):
            demand = law(inputs.replace(attitude=attitude), (), bench.setpoint(k_a=1600.0), settings)
            assert np.cross(demand.m_body_am2, inputs.b_body_t) @ np.array([1.0, -2.0, 3.0]) < 0.0
