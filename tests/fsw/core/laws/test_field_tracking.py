"""Field tracking: the equation, where it converges and where not, and the hand-over to the PD law."""

import numpy as np
import pytest

from fsw.core.laws.field_tracking import (
    HandOverGains,
    field_tracking,
    field_tracking_dipole,
    pd_after_tracking,
    tracking_before_pd,
)
from fsw.core.laws.interface import FieldSample
from fsw.core.laws.pd import pd

FIRM = np.diag([0.3, 2.0, 2.2])
NO_SAMPLE = FieldSample()
GAINS = {"field_tracking_pd": HandOverGains(share_w=0.3, share_a=0.5)}


@pytest.fixture(scope="module")
def from_nominal(bench, turned):
    """Fly from a turn away from nominal, at a rate relative to the orbital frame."""

    def fly(law, axis, angle_deg, orbits, body, k_w, k_a, relative=(0.0, 0.0, 0.0), **more):
        orbit, c0 = bench.Orbit(), turned(axis, angle_deg)
        return bench.fly(
            law,
            bench.setpoint(k_w=k_w, k_a=k_a),
            gains=GAINS,
            orbit=orbit,
            body=body,
            c_body_from_orbit=c0,
            omega_body=np.array(relative) + orbit.rate_radps * c0[:, 2],
            seconds=orbits * orbit.period_s,
            step_s=8.0,
            **more,
        )

    return fly


def test_the_equation():
    """m = -k1 (b - B) - k2 (db/dt - dB/dt), k1 = 2 k_a, k2 = k_w."""
    m = field_tracking_dipole((1e-6, -2e-6, 3e-6), (4e-9, 5e-9, -6e-9), 1e7, 1e3)
    assert m == pytest.approx((-2e-3 - 4e-2, 4e-3 - 5e-2, -6e-3 + 6e-2))


def test_to_first_order_it_is_the_pd_law_less_the_turning_of_the_field(bench, turned):
    """m = -k_a b x S - k_w (b x Omega + dB/dt x theta), S = 2 theta."""
    orbit, theta, rate, k_w, k_a = (
        bench.Orbit(),
        1e-5 * np.array([3, -2, 4]),
        1e-8 * np.array([2, 5, -3]),
        1e6,
        800.0,
    )
    settings, point = bench.config(bench.Body(), 1.0), bench.setpoint(k_w=k_w, k_a=k_a)
    before, memory = FieldSample(), ()
    for tick in (700, 701):
        angle = theta + rate * (tick - 700.5)
        c = turned(angle, np.degrees(np.linalg.norm(angle))) @ orbit.c_orbit_from_eci(tick)
        demand = field_tracking(
            bench.inputs_at(orbit, tick, 1.0, c, np.zeros(3), before), memory, point, settings
        )
        before, memory = FieldSample((0.0, 0.0, 0.0), tick), demand.memory

    def expected_t(t_s):
        return orbit.c_orbit_from_eci(t_s) @ orbit.b_eci_t(t_s)

    b, turning = expected_t(701.0), expected_t(701.0) - expected_t(700.0)
    pd_part = -2.0 * k_a * np.cross(b, theta + 0.5 * rate) - k_w * np.cross(b, rate)
    left = -k_w * np.cross(turning, theta)
    np.testing.assert_allclose(demand.m_body_am2, pd_part + left, rtol=2e-3, atol=1e-3 * np.linalg.norm(left))
    assert np.linalg.norm(left) > 0.2 * np.linalg.norm(pd_part)


@pytest.mark.long
class TestFlights:
    def test_with_a_wheel_along_the_normal_it_comes_to_nominal(self, from_nominal, bench):
        body = bench.Body(inertia=np.diag([1.9, 1.95, 2.0]), wheel=(0.0, 0.0, 0.05))
        run = from_nominal(field_tracking, (1, 1, 1), 20.0, 4.0, body, k_w=1e7, k_a=2000.0, known=False)
        assert run.angle_deg[-1] < 0.5

    def test_with_gains_found_for_pd_and_no_wheel_it_does_not(self, from_nominal, bench):
        """Why the hand-over has gains of its own; the PD law converges from there."""
        case = {
            "axis": (1, 1, 1),
            "angle_deg": 20.0,
            "orbits": 2.0,
            "body": bench.Body(),
            "k_w": 6.27e6,
            "k_a": 1615.0,
        }
        assert from_nominal(field_tracking, **case).angle_deg[-300:].min() > 20.0
        assert from_nominal(pd, **case).angle_deg[-1] < 0.5

    @pytest.mark.parametrize(
        ("axis", "angle_deg", "relative"),
        [((1, -1, 0.5), 60.0, (0.002, -0.003, 0.001)), ((1, 0, 0), 150.0, (0, 0, 0))],
    )
    def test_with_gravity_gradient_and_handed_over_it_ends_pointed(
        self, from_nominal, bench, axis, angle_deg, relative
    ):
        hand_over_s = 3.5 * bench.Orbit().period_s
        run = from_nominal(
            tracking_before_pd,
            axis,
            angle_deg,
            6.0,
            bench.Body(inertia=FIRM),
            k_w=4e6,
            k_a=1600.0,
            relative=relative,
            switch=(hand_over_s, pd_after_tracking),
        )
        at_hand_over = run.angle_deg[int(hand_over_s / 8.0)]
        assert at_hand_over < 20.0
        assert run.angle_deg[-200:].max() < 0.1


class TestMemory:
    @pytest.fixture
    def inputs(self, bench, turned):
        def at(tick, sampled=True, before=NO_SAMPLE):
            c = turned((1, 2, 3), 25.0) @ bench.Orbit().c_orbit_from_eci(tick)
            return bench.inputs_at(bench.Orbit(), tick, 1.0, c, np.zeros(3), before, sampled=sampled)

        return at

    @pytest.fixture
    def fly(self, bench):
        point, settings = bench.setpoint(k_w=1e7, k_a=2000.0), bench.config(bench.Body(), 1.0, GAINS)
        return lambda law, inputs, memory: law(inputs, memory, point, settings)

    def test_one_sample_tells_no_change(self, inputs, fly):
        demand = fly(field_tracking, inputs(50), ())
        assert demand.m_body_am2 == (0.0, 0.0, 0.0)
        assert fly(field_tracking, inputs(51), demand.memory).m_body_am2 != (0.0, 0.0, 0.0)

    def test_a_tick_without_a_sample_asks_for_nothing_and_forgets_nothing(self, inputs, fly):
        first = fly(field_tracking, inputs(50), ())
        blanked = fly(field_tracking, inputs(51, sampled=False, before=inputs(50).sample), first.memory)
        assert blanked.m_body_am2 == (0.0, 0.0, 0.0)
        assert blanked.memory == first.memory
        assert fly(field_tracking, inputs(52), blanked.memory).m_body_am2 != (0.0, 0.0, 0.0)

    def test_an_old_sample_tells_no_change(self, inputs, fly):
        first = fly(field_tracking, inputs(50), ())
        assert fly(field_tracking, inputs(61), first.memory).m_body_am2 == (0.0, 0.0, 0.0)

    def test_before_the_hand_over_each_gain_has_its_own_share(self, inputs, bench):
        first, second = inputs(50), inputs(51)
        settings = bench.config(bench.Body(), 1.0, GAINS)
        before, tracked = (
            law(second, law(first, (), point, settings).memory, point, settings).m_body_am2
            for law, point in (
                (tracking_before_pd, bench.setpoint(k_w=1e7, k_a=2000.0)),
                (field_tracking, bench.setpoint(k_w=0.3 * 1e7, k_a=0.5 * 2000.0)),
            )
        )
        assert before == pytest.approx(tracked, rel=1e-12)

    def test_neither_law_of_the_hand_over_takes_the_other_s_memory_for_its_own(self, inputs, fly):
        tracked, integral = fly(tracking_before_pd, inputs(50), ()).memory, (10.0, -20.0, 30.0)
        assert fly(pd_after_tracking, inputs(51), tracked) == fly(pd_after_tracking, inputs(51), ())
        assert fly(tracking_before_pd, inputs(51), integral) == fly(tracking_before_pd, inputs(51), ())
        assert fly(pd_after_tracking, inputs(51), integral).memory == integral
