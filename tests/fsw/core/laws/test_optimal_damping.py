"""Damping at the bound of the coils: no other dipole within it takes more away at once."""

from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fsw.core.laws.damping import rate_damping
from fsw.core.laws.interface import FieldSample
from fsw.core.laws.optimal_damping import (
    EnergyGains,
    ModelGains,
    MomentumGains,
    fastest_dipole,
    least_energy,
    least_momentum,
    model_torque,
    rate_model,
)

INERTIA = np.array([[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]])
TUMBLE = (0.02, -0.03, 0.025)
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))


def test_the_momentum_is_that_of_the_products_of_inertia_too(bench):
    """Within a wide band, beside the spin that is wanted: m = -m0 b x J (omega - spin) / (|b| h0)."""
    orbit, own = bench.Orbit(), {"least_momentum": MomentumGains(1e3)}
    inputs = bench.inputs_at(orbit, 100, 1.0, np.eye(3), np.array(TUMBLE), FieldSample())
    settings = bench.config(bench.Body(INERTIA, most_am2=2.0), 1.0, own)
    m = least_momentum(inputs, (), bench.setpoint(spin_radps=0.01), settings).m_body_am2
    left, b = INERTIA @ np.subtract(TUMBLE, (0.01, 0.0, 0.0)), np.array(inputs.b_body_t)
    assert m == pytest.approx(-2.0 * np.cross(b, left) / np.linalg.norm(b), rel=1e-9)


class TestDipole:
    def test_by_hand(self):
        """b x v = (1, 2, -2) x (3, 0, 1) = (2, -7, -6) e-5, |b| v0 = 3e-5 * 2."""
        m = fastest_dipole((1e-5, 2e-5, -2e-5), (3.0, 0.0, 1.0), 2.0, 0.6)
        assert m == pytest.approx((-0.2, 0.6, 0.6))

    @pytest.mark.long
    @given(fields, vectors)
    def test_no_other_dipole_within_the_bound_is_faster(self, b, v):
        """Beyond the band: the power v . (m x b) against that of all corners."""
        assume(min(abs(np.cross(b, v))) > 1e-9)
        best = np.dot(v, np.cross(fastest_dipole(b, v, 1e-9, 2.0), b))
        others = [np.dot(v, np.cross(corner, b)) for corner in product((-2.0, 0.0, 2.0), repeat=3)]
        assert best == pytest.approx(min(others), rel=1e-9)
        assert best < 0.0

    def test_within_the_band_it_is_a_straight_line(self):
        b, v = (1e-5, 2e-5, -2e-5), (3e-4, 1e-4, 2e-4)
        half = fastest_dipole(b, tuple(0.5 * c for c in v), 1e-3, 1.0)
        assert half == pytest.approx(tuple(0.5 * c for c in fastest_dipole(b, v, 1e-3, 1.0)))


@pytest.fixture(scope="module")
def flown(bench):
    def fly(law, gains=None, k_w=0.0, spin_radps=0.0, seconds=4000.0):
        return bench.fly(
            law,
            bench.setpoint(k_w=k_w, spin_radps=spin_radps),
            gains=gains,
            body=bench.Body(inertia=INERTIA, gravity=False, most_am2=1.0),
            omega_body=TUMBLE,
            seconds=seconds,
        )

    return fly


@pytest.mark.long
class TestFlights:
    def test_the_momentum_falls_in_every_step(self, flown):
        run = flown(least_momentum, {"least_momentum": MomentumGains(5.0)})
        momentum = np.linalg.norm(run.momentum_eci, axis=1)
        assert np.all(np.diff(momentum) < 1e-6)
        assert momentum[-1] < 0.01 * momentum[0]

    def test_the_energy_falls_in_every_step(self, flown):
        run = flown(least_energy, {"least_energy": EnergyGains(0.002)})
        assert np.all(np.diff(run.energy_j) < 1e-9)
        assert run.energy_j[-1] < 1e-3 * run.energy_j[0]

    def test_both_are_faster_than_a_gain_that_begins_at_the_bound(self, flown):
        """The source's claim; the gain fills the coils (1 A m^2) at the rate of the start."""
        linear = flown(rate_damping, k_w=6e5)
        relay = flown(least_momentum, {"least_momentum": MomentumGains(5.0)})
        assert np.abs(linear.m_body).max() > 0.7
        left = [np.linalg.norm(run.momentum_eci[-1]) for run in (linear, relay)]
        assert left[1] < 0.05 * left[0]

    @pytest.mark.parametrize(
        ("law", "gains"),
        [
            (least_momentum, {"least_momentum": MomentumGains(5.0)}),
            (least_energy, {"least_energy": EnergyGains(0.002)}),
            (rate_model, {"rate_model": ModelGains(0.002, 0.001, 0.003)}),
        ],
    )
    def test_they_end_in_the_spin_of_the_setpoint(self, flown, law, gains):
        run = flown(law, gains, spin_radps=0.01, seconds=9000.0)
        assert run.omega_body[-1] == pytest.approx((0.01, 0.0, 0.0), abs=3e-3)


class TestModel:
    def test_its_torque_gives_the_acceleration_that_is_wanted(self):
        """J d(omega)/dt = M - omega x h, solved by numpy."""
        omega, wanted = np.array(TUMBLE), np.array([1e-5, -3e-5, 2e-5])
        momentum = INERTIA @ omega + np.array([0.01, -0.02, 0.03])
        torque = model_torque(tuple(omega), tuple(momentum), tuple(INERTIA @ wanted))
        got = np.linalg.solve(INERTIA, np.array(torque) - np.cross(omega, momentum))
        np.testing.assert_allclose(got, wanted)

    def test_the_law_asks_for_the_part_of_that_torque_across_the_field(self, bench, turned):
        """Each axis by its own decay."""
        body, decay = bench.Body(inertia=INERTIA, wheel=(0.01, -0.02, 0.03)), np.array([1e-3, 2e-3, 3e-3])
        c, omega = turned((1, 2, 3), 40.0) @ bench.Orbit().c_orbit_from_eci(300.0), np.array(TUMBLE)
        inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, omega, FieldSample())
        settings = bench.config(body, 1.0, {"rate_model": ModelGains(*decay)})
        m = rate_model(inputs, (), bench.setpoint(), settings).m_body_am2
        wanted = np.cross(omega, INERTIA @ omega + body.wheel) - INERTIA @ (decay * omega)
        b = np.array(inputs.b_body_t)
        normal = wanted - b * (b @ wanted) / (b @ b)
        np.testing.assert_allclose(np.cross(m, b), normal, atol=1e-9)

    @pytest.mark.long
    def test_what_the_coils_cannot_give_of_it_delays_the_decay(self, flown):
        """Unlike the other laws it may add energy: the gyroscopic part has power once projected."""
        run = flown(rate_model, {"rate_model": ModelGains()})
        assert np.diff(run.energy_j).max() > 1e-7


@pytest.mark.parametrize(
    "wrong", [lambda: MomentumGains(0.0), lambda: EnergyGains(-1.0), lambda: ModelGains(decay_2=0.0)]
)
def test_gains_without_sense_are_refused(wrong):
    with pytest.raises(ValueError, match="must be positive"):
        wrong()
