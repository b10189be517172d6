"""Roll alone near the equator: torques, the filter, Routh's condition, and yaw that needs no sensor."""

import numpy as np
import pytest

from fsw.core.laws.horizon_roll import (
    HorizonRollGains,
    filtered,
    horizon_dipole,
    horizon_roll,
    horizon_roll_angle,
)

B = (1.7e-6, -2.3e-6, 3.1e-5)
NEAR_EQUATOR = {"inclination_deg": 5.0, "gains": HorizonRollGains()}
K_A, BY_ROUTH = 4e4, 2.0 * 4e4 * 1.95 / 0.05


def test_roll_turns_the_momentum_and_its_rate_is_braked():
    m = horizon_dipole(B, 0.02, 0.0, 1e6, 300.0)
    assert np.cross(m, B)[0] == pytest.approx(-600.0 * B[2] ** 2 * 0.02)
    m = horizon_dipole(B, 0.0, 1e-3, 1e6, 300.0)
    assert np.cross(m, B)[1] == pytest.approx(-1e6 * B[2] ** 2 * 1e-3)


def rows(matrix):
    return tuple(map(tuple, matrix.tolist()))


@pytest.mark.parametrize("roll_deg", [-70.0, -3.0, 3.0, 70.0])
def test_the_sensor_shows_the_turn_about_axis_2(turned, roll_deg):
    assert np.degrees(horizon_roll_angle(rows(turned((0, 1, 0), roll_deg)))) == pytest.approx(roll_deg)


def test_the_sensor_does_not_see_yaw(turned):
    assert horizon_roll_angle(rows(turned((1, 0, 0), 20.0))) == pytest.approx(0.0, abs=1e-12)


def test_the_filter_follows_a_steady_rate_exactly_and_smooths_a_jump():
    state = (0.3, 0.0)
    for step in range(1, 60):
        state = filtered(0.3 + 2e-3 * step, state, 1.0, 0.3)
    assert state == pytest.approx((0.3 + 2e-3 * 59, 2e-3), rel=1e-4)
    roll, rate = filtered(0.01, (0.0, 0.0), 1.0, 0.1)
    p = np.exp(-0.1)
    assert (roll, rate) == pytest.approx((0.01 * (1 - p * p), 0.01 * (1 - p) ** 2))


@pytest.mark.parametrize("rate", [0.05, -0.05])
def test_the_filter_follows_a_turn_through_half_a_turn_back(rate):
    """The sensor's angle jumps by a whole turn there; the body does not."""
    state = (3.0, rate) if rate > 0.0 else (-3.0, rate)
    begun = state[0]
    for step in range(1, 200):
        shown = np.remainder(begun + rate * step + np.pi, 2.0 * np.pi) - np.pi
        state = filtered(shown, state, 1.0, 0.2)
        assert abs(state[0]) <= np.pi
        assert state[1] == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize("value", [0.0, -1.0, 101.0, float("nan")])
def test_a_bandwidth_out_of_range_is_named(value):
    with pytest.raises(ValueError, match="bandwidth_radps must be"):
        HorizonRollGains(value)


class TestMemory:
    @pytest.fixture
    def ask(self, bench, turned):
        def asked(tick, memory):
            orbit, c = bench.Orbit(inclination_deg=5.0), turned((0, 1, 0), 3.0)
            motion = c @ orbit.c_orbit_from_eci(tick), orbit.rate_radps * c[:, 2], None
            settings = bench.config(
                bench.Body(wheel=(0.0, 0.0, 0.05)), 1.0, {"horizon_roll": HorizonRollGains()}
            )
            inputs = bench.inputs_at(orbit, tick, 1.0, *motion)
            return horizon_roll(inputs, memory, bench.setpoint(k_w=1e7, k_a=K_A), settings)

        return asked

    def test_the_first_sample_and_one_after_a_gap_only_begin(self, ask):
        first = ask(700, ())
        assert first.m_body_am2 == (0.0, 0.0, 0.0)
        assert first.memory == pytest.approx((700.0, np.radians(3.0), 0.0))
        late = ask(720, first.memory)
        assert late.m_body_am2 == (0.0, 0.0, 0.0)
        assert late.memory == pytest.approx((720.0, np.radians(3.0), 0.0))
        assert ask(702, first.memory).m_body_am2 != (0.0, 0.0, 0.0)

    def test_the_same_tick_twice_does_not_divide_by_zero(self, ask):
        memory = (700.0, 0.01, 1e-4)
        assert ask(700, memory).memory == memory


@pytest.mark.long
class TestFlights:
    def test_yaw_is_taken_away_by_roll_alone(self, lean):
        """It begins as yaw: about axis 1."""
        run = lean(horizon_roll, axis=(1, 0, 0), k_w=1e7, k_a=K_A, **NEAR_EQUATOR)
        assert run.most_deg(0) > 9.0
        assert run.lean_deg[-1] < 0.3

    def test_the_slow_motion_decays_as_its_equation_says(self, lean, bench):
        """By exp(-(2 k_a + w0 k_w) b3^2 / 2 h t): h is the wheel's and the body's."""
        orbit, k_w = bench.Orbit(inclination_deg=0.0), 3e6
        b3 = 7.812e15 / orbit.radius_m**3
        rate = (2.0 * 1e4 + orbit.rate_radps * k_w) * b3**2 / 2.0 / 0.05
        run = lean(
            horizon_roll,
            gains=HorizonRollGains(),
            axis=(1, 0, 0),
            angle_deg=0.5,
            inclination_deg=0.0,
            k_w=k_w,
            k_a=1e4,
        )
        fallen = -np.log(run.lean_deg[2 * run.orbit_ticks - 1] / run.lean_deg[run.orbit_ticks])
        assert fallen == pytest.approx(rate * orbit.period_s, rel=0.1)

    @pytest.mark.parametrize(("part", "damped"), [(1.4, True), (0.6, False)])
    def test_nutation_is_damped_where_routh_says(self, lean, part, damped):
        run = lean(
            horizon_roll,
            angle_deg=0.01,
            relative=(2e-4, 0.0, 0.0),
            k_w=part * BY_ROUTH,
            k_a=K_A,
            orbits=1.0,
            step_s=4.0,
            **NEAR_EQUATOR,
        )
        swing = np.linalg.norm(run.run.relative_body[:, :2], axis=1)
        assert (swing[-100:].max() < swing[:100].max()) == damped
