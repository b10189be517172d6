"""Torques made dipoles: what is nearest, what the weights buy and what they cost, and where lambda leads."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.pd import pd
from fsw.core.laws.projection import (
    RegularGains,
    WeightGains,
    reference_torque,
    regularised,
    regularised_dipole,
    torque_dipole,
    weighted,
    weighted_projection,
)
from fsw.core.laws.table import LAWS

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: tuple(4e-5 * c for c in v))
torques = vectors.map(lambda v: tuple(1e-5 * c for c in v))
weights = st.tuples(*[st.floats(0.1, 100.0)] * 3)

UNEQUAL = np.diag([1.0, 10.0, 10.5])
K_W, K_A = 2e7, 5000.0


@pytest.mark.long
@given(torques, fields, weights)
def test_the_weighted_projection_is_normal_to_the_field(torque, b, q):
    assert np.dot(weighted_projection(torque, b, q), b) == pytest.approx(0.0, abs=1e-22)


@pytest.mark.long
@given(torques, fields, weights, st.tuples(component, component))
def test_no_other_torque_normal_to_the_field_is_nearer(torque, b, q, other):
    """In the norm of Q."""
    plane = np.linalg.svd(np.array(b)[None, :])[2][1:]
    found = np.array(weighted_projection(torque, b, q))
    elsewhere = found + 1e-5 * np.array(other) @ plane

    def error(m):
        return np.sum(np.array(q) * (np.array(torque) - m) ** 2)

    assert error(found) <= error(elsewhere) * (1.0 + 1e-9)


@given(torques, fields, st.floats(0.1, 10.0))
def test_with_equal_weights_it_is_the_plain_projection(torque, b, q):
    unit = np.array(b) / np.linalg.norm(b)
    expected = np.array(torque) - unit * (unit @ torque)
    assert weighted_projection(torque, b, (q, q, q)) == pytest.approx(expected, abs=1e-17)


@given(torques, fields)
def test_the_dipole_of_a_torque_gives_its_part_normal_to_the_field(torque, b):
    got = np.cross(torque_dipole(torque, b), b)
    assert got == pytest.approx(weighted_projection(torque, b, (1.0, 1.0, 1.0)), abs=1e-17)


@given(torques, fields, st.floats(1e-6, 1e-4))
def test_the_regularised_dipole_is_the_formula_of_the_source(torque, b, floor_t):
    x, y, z = b
    turning = -np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])  # m to m x b
    matrix = turning.T @ turning + floor_t**2 * np.eye(3)
    expected = np.linalg.solve(matrix, turning.T @ torque)
    assert regularised_dipole(torque, b, floor_t) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@given(torques, fields)
def test_as_lambda_vanishes_the_regularised_dipole_becomes_the_projection(torque, b):
    projected = np.array(torque_dipole(torque, b))
    size = np.linalg.norm(b)
    missing = [
        np.linalg.norm(projected - regularised_dipole(torque, b, part * size)) for part in (0.3, 0.03, 0.003)
    ]
    assert missing[1] == pytest.approx(0.0109 * missing[0], rel=0.01, abs=1e-18)
    assert missing[2] == pytest.approx(0.01 * missing[1], rel=0.01, abs=1e-18)


def test_without_a_field_no_dipole_is_asked_for():
    torque, none = (1e-5, -2e-5, 3e-5), (0.0, 0.0, 0.0)
    assert weighted_projection(torque, none, (1.0, 2.0, 3.0)) == none
    assert torque_dipole(torque, none) == none
    assert regularised_dipole(torque, none, 5e-6) == none
    assert regularised_dipole(torque, none, 0.0) == none


@pytest.fixture
def settings(bench):
    def of(name, own):
        return bench.config(bench.Body(UNEQUAL), 1.0, {name: own})

    return of


@pytest.fixture
def inputs(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    return bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)


def test_with_equal_weights_or_no_lambda_the_law_is_pd(bench, settings, inputs):
    point = bench.setpoint(k_w=K_W, k_a=K_A)
    plain = pd(inputs, (), point, settings("pd", None)).m_body_am2
    equal = weighted(inputs, (), point, settings("pd_weighted", WeightGains(2.0, 2.0, 2.0)))
    bare = regularised(inputs, (), point, settings("pd_regularised", RegularGains(0.0)))
    assert equal.m_body_am2 == pytest.approx(plain, rel=1e-9)
    assert bare.m_body_am2 == pytest.approx(plain, rel=1e-9)


@pytest.mark.parametrize("weights", [(10.0, 0.0, 0.0), (1.0, 2.0, -1.0), (-1.0, -1.0, -1.0)])
def test_some_weights_without_the_others_are_refused(weights):
    with pytest.raises(ValueError, match="q1, q2 and q3 must all be positive, or all 0"):
        WeightGains(*weights)


def test_unless_weights_are_given_they_are_the_inverse_moments(bench, settings, inputs):
    point = bench.setpoint(k_w=K_W, k_a=K_A)
    own = weighted(inputs, (), point, settings("pd_weighted", WeightGains()))
    given_ = weighted(inputs, (), point, settings("pd_weighted", WeightGains(1.0, 0.1, 1.0 / 10.5)))
    other = weighted(inputs, (), point, settings("pd_weighted", WeightGains(1.0, 1.0, 1.0)))
    assert own.m_body_am2 == pytest.approx(given_.m_body_am2, rel=1e-12)
    assert own.m_body_am2 != pytest.approx(other.m_body_am2, rel=1e-2)


def test_the_reference_torque_is_the_one_whose_projection_is_pd(bench):
    point = bench.setpoint(k_w=K_W, k_a=K_A)
    torque = reference_torque((3e-5, 0.0, 0.0), (1e-3, 0.0, 2e-3), (0.0, 0.1, -0.2), point)
    assert torque == pytest.approx(
        (-9e-10 * K_W * 1e-3, -9e-10 * K_A * 0.1, -9e-10 * (K_W * 2e-3 - K_A * 0.2))
    )


@pytest.fixture(scope="module")
def axes_deg(bench, turned):
    """RMS about each axis over the last two of eight orbits, in a constant torque, by weights."""

    def run(own):
        flight = bench.fly_from_rest(
            weighted,
            bench.setpoint(k_w=K_W, k_a=K_A),
            gains={"pd_weighted": own},
            body=bench.Body(UNEQUAL, most_am2=5.0, torque=(1e-7, 1e-7, 1e-7)),
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=8.0,
            step_s=10.0,
        )
        c = flight.c_body_from_orbit[-len(flight.t_s) // 4 :]
        parts = [c[:, 1, 2] - c[:, 2, 1], c[:, 2, 0] - c[:, 0, 2], c[:, 0, 1] - c[:, 1, 0]]
        return np.degrees(0.5 * np.sqrt(np.mean(np.square(parts), axis=1)))

    return run


@pytest.mark.long
def test_a_weight_on_the_axis_of_small_moment_steadies_it_at_the_others_cost(axes_deg):
    """The property claimed by the source, for moments that differ tenfold."""
    plain, own = axes_deg(WeightGains(1.0, 1.0, 1.0)), axes_deg(WeightGains(10.0, 1.0, 1.0))
    assert own[0] < 0.8 * plain[0]
    assert own[1] > plain[1]
    assert own[2] > plain[2]


@pytest.mark.parametrize("name", ["pd_weighted", "pd_regularised"])
@pytest.mark.parametrize("mode", ["acquire", "point"])
def test_an_unknown_attitude_asks_for_nothing(bench, settings, inputs, name, mode):
    law, point = getattr(LAWS[name], mode), bench.setpoint(k_w=K_W, k_a=K_A)
    given_ = settings(name, LAWS[name].gains())
    assert law(inputs.replace(attitude=UNKNOWN), (), point, given_).m_body_am2 == (0.0, 0.0, 0.0)
    assert any(law(inputs, (), point, given_).m_body_am2)


@pytest.mark.parametrize("name", ["pd_weighted", "pd_regularised"])
def test_upside_down_the_far_form_turns_and_the_near_form_rests(bench, settings, inputs, name):
    over = replace_attitude(inputs, (0.0, 1.0, 0.0, 0.0))
    point, given_ = bench.setpoint(k_w=0.0, k_a=K_A), settings(name, LAWS[name].gains())
    assert np.linalg.norm(LAWS[name].acquire(over, (), point, given_).m_body_am2) > 1e-3
    assert np.linalg.norm(LAWS[name].point(over, (), point, given_).m_body_am2) < 1e-9


def replace_attitude(inputs, q):
    return inputs.replace(attitude=inputs.attitude.replace(q_body_from_orbit=q))
