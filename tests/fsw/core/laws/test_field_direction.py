"""A direction held to the field: the torque turns it there the shorter way and brakes it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.field_direction import FieldDirectionGains, direction_torque, field_direction
from fsw.core.laws.interface import FieldSample

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 0.1)
OWN = FieldDirectionGains(0.0, 2.0, 1.0)
NOTHING = (0.0, 0.0, 0.0)


@pytest.mark.long
@given(vectors, vectors)
def test_the_torque_turns_the_target_onto_the_field(b, t):
    """A small turn d about it takes t to t + d x t, nearer to n."""
    b, t = 4e-5 * np.array(b), np.array(t) / np.linalg.norm(t)
    n = b / np.linalg.norm(b)
    torque = np.array(direction_torque(tuple(b), tuple(t - n), NOTHING, 0.0, 1.0))
    turned = t + 1e-3 * np.cross(torque / max(np.linalg.norm(torque), 1e-30), t)
    assert turned @ n >= t @ n - 1e-6
    assert torque @ n == pytest.approx(0.0, abs=1e-22)


@pytest.mark.long
@given(vectors, vectors)
def test_turning_across_the_field_is_braked(b, omega):
    """de/dt = -n x omega for a fixed target: M = -k_w |b|^2 omega_across."""
    b, omega = 4e-5 * np.array(b), 1e-3 * np.array(omega)
    n = b / np.linalg.norm(b)
    torque = direction_torque(tuple(b), NOTHING, tuple(-np.cross(n, omega)), 5.0, 0.0)
    assert torque == pytest.approx(-5.0 * (b @ b) * (omega - n * (n @ omega)), abs=1e-20)


@pytest.fixture
def fly(bench, turned):
    def run(own, body, orbits=4.0, k_w=1e7, k_a=2000.0, angle_deg=20.0):
        return bench.Orbit(), bench.fly_from_rest(
            field_direction,
            bench.setpoint(k_w=k_w, k_a=k_a),
            gains={"field_direction": own},
            body=body,
            c_body_from_orbit=turned((1, 1, 1), angle_deg),
            orbits=orbits,
            step_s=5.0,
            known=False,
        )

    return run


@pytest.mark.long
def test_an_axis_follows_the_field_as_a_bar_magnet_would(bench, fly):
    """From far off, by the magnetometer alone, the turn about the field free."""
    orbit, run = fly(OWN, bench.Body(np.diag([1.6, 1.6, 1.6])), orbits=2.0, k_a=2e4)
    b = np.einsum("tij,tj->ti", run.c_body_from_eci, orbit.b_eci_t(run.t_s))
    off = bench.angles_deg(b, (0.0, 2.0, 1.0))
    assert off[0] > 40.0
    assert off[len(off) // 2 :].max() < 15.0


@pytest.mark.long
def test_without_a_target_and_with_a_wheel_the_whole_attitude_follows(bench, fly):
    body = bench.Body(inertia=np.diag([1.9, 1.95, 2.0]), wheel=(0.0, 0.0, 0.05))
    _, run = fly(FieldDirectionGains(), body)
    assert run.angle_deg[0] == pytest.approx(20.0)
    assert run.angle_deg[-100:].max() < 0.5


@pytest.fixture
def asked(bench, turned):
    settings = bench.config(bench.Body(), 1.0, {"field_direction": OWN})

    def ask(tick, memory, known_orbit=True):
        c = turned((1, 2, 3), 0.5 * tick)
        inputs = bench.inputs_at(bench.Orbit(), tick, 1.0, c, np.zeros(3), FieldSample(), known=False)
        inputs = inputs if known_orbit else inputs.replace(reference=None)
        return field_direction(inputs, memory, bench.setpoint(k_w=1e7, k_a=2000.0), settings)

    return ask


def test_two_samples_are_needed_no_more_than_ten_seconds_apart(asked):
    first = asked(30, ())
    assert first.m_body_am2 == NOTHING
    assert any(asked(31, first.memory).m_body_am2)
    assert asked(41, first.memory).m_body_am2 == NOTHING


def test_a_target_of_its_own_needs_no_orbit(asked):
    first = asked(30, (), known_orbit=False)
    assert any(asked(31, first.memory, known_orbit=False).m_body_am2)


def test_the_size_of_the_field_is_no_error(bench, turned):
    """A magnetometer whose scale is off asks for the dipole of the same turn, not for more."""
    settings = bench.config(bench.Body(), 1.0, {"field_direction": FieldDirectionGains()})
    point, memory, asked = bench.setpoint(k_w=0.0, k_a=2000.0), (), None
    for tick in (700, 701):
        c = bench.Orbit().c_orbit_from_eci(tick)
        inputs = bench.inputs_at(bench.Orbit(), tick, 1.0, c, np.zeros(3), FieldSample(), known=False)
        scaled = FieldSample(tuple(1.1 * part for part in inputs.sample.b_body_t), tick)
        asked = field_direction(inputs.replace(sample=scaled), memory, point, settings)
        memory = asked.memory
    assert asked.m_body_am2 == pytest.approx(NOTHING, abs=1e-9)
