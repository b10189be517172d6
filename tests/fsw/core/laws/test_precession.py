"""Precession of a spinning body: by its roll, to a target, by relays in stages, and by steps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.relay_stages import (
    SpinStage,
    StageGains,
    direction_switch,
    nutation_switch,
    relay,
    relay_stages,
    spin_switches,
    stage,
)
from fsw.core.laws.roll_precession import RollGains, roll_dipole, roll_precession
from fsw.core.laws.spin_axis import reorientation_dipole
from fsw.core.laws.stepped_precession import StepGains, step_level, stepped_precession
from fsw.core.laws.target_precession import PrecessionGains, precession_dipole, target_precession

INERTIA = np.diag([1.2, 1.3, 2.0])
TARGET = (0.3, -0.5, 0.8)
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
directions = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(
    lambda v: tuple(float(c) for c in np.array(v) / np.linalg.norm(v))
)
axes = st.integers(0, 2)


@pytest.fixture(scope="module")
def spinning(bench, turned):
    """Fly a body that spins about axis 3, its axis tilted from the orbit normal."""

    def fly(law, gains, orbits, spin=0.1, most_am2=20.0, omega=(0.0, 0.0), k_w=3e6, flip=False):
        orbit = bench.Orbit()
        return bench.fly(
            law,
            bench.setpoint(k_w=k_w, spin_radps=spin),
            gains={law.__name__: gains},
            orbit=orbit,
            body=bench.Body(inertia=INERTIA, gravity=False, most_am2=most_am2),
            c_body_from_orbit=turned((4, 3, 0), 180.0 - 25.0 if flip else 25.0),
            omega_body=(*omega, spin),
            seconds=orbits * orbit.period_s,
            step_s=4.0,
        )

    return fly


def normal_deg(run):
    """Of the body's third axis from the orbit normal."""
    return np.degrees(np.arccos(np.clip(run.c_body_from_orbit[:, 2, 2], -1.0, 1.0)))


class TestRoll:
    def test_the_dipole_by_hand(self):
        """k_h |h| (e . r)(b . v) = 1e6 * 0.2 * -0.1 * 3e-5."""
        m = roll_dipole((1e-5, 3e-5, -2e-5), (0.99, 0.0, -0.1), (0.0, 1.0, 0.0), 0.2, 2, 1e6)
        assert m == pytest.approx((0.0, 0.0, -0.6))

    @given(fields, st.floats(-0.1, 0.1))
    def test_its_torque_takes_roll_away(self, b, roll):
        """Near the normal: the torque along the radius has the sign against the roll, or is none."""
        m = roll_dipole(b, (1.0, 0.0, roll), (0.0, 1.0, 0.0), 0.2, 2, 1e6)
        assert np.cross((0.0, 0.0, m[2]), b)[0] * roll <= 0.0

    @pytest.mark.long
    @pytest.mark.parametrize(("spin", "flip"), [(0.1, False), (-0.1, True)])
    def test_the_momentum_comes_to_the_normal_and_the_nutation_ends(self, spinning, spin, flip):
        run = spinning(roll_precession, RollGains(3.0, 1e6), 3.0, spin, omega=(0.003, 0.0), flip=flip)
        off = normal_deg(run) if spin > 0.0 else 180.0 - normal_deg(run)
        assert off[0] > 20.0
        assert off[-1] < 7.0
        assert np.linalg.norm(run.omega_body[-1, :2]) < 1e-3
        assert run.omega_body[-1, 2] == pytest.approx(spin, rel=1e-3)


class TestTarget:
    @pytest.mark.long
    @given(fields, directions, axes)
    def test_without_a_bend_it_is_reorientation_along_the_target(self, b, target, axis):
        ours = precession_dipole(b, target, axis, 3e5, 1.0)
        assert ours == pytest.approx(reorientation_dipole(b, target, axis, 3e5), abs=1e-12)

    def test_the_bend_by_hand(self):
        """b1 f(t2) - b2 f(t1) with t1 = 0.6 cut to 0.3, t2 = -0.1."""
        m = precession_dipole((2e-5, 1e-5, 0.0), (0.6, -0.1, 0.79), 2, 1e5, 0.3)
        assert m == pytest.approx((0.0, 0.0, 1e5 * (-2e-6 - 3e-6)))

    @pytest.mark.long
    @given(directions, directions, st.floats(0.01, 1.0))
    def test_in_the_mean_over_a_turn_the_torque_is_along_the_target(self, b, target, limit):
        """Not at each instant, but for any f of the sign of its argument; of one that bends, to 1 / n^2."""
        means, turn = [], np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
        across = abs(b[0] * target[1] - b[1] * target[0])
        for angle in turn:
            c = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
            b_body, t_body = c @ b, c @ target
            m = precession_dipole(tuple(b_body), tuple(t_body), 2, 1.0, limit)
            means.append(np.cross(m, b_body) @ t_body)
        assert np.mean(means) >= -4.0 * across / len(turn) ** 2 - 1e-12

    @pytest.mark.long
    @pytest.mark.parametrize("limit", [1.0, 0.3])
    def test_the_momentum_comes_to_the_target_with_any_f(self, spinning, limit):
        run = spinning(target_precession, PrecessionGains(3.0, *TARGET, 1e6, limit), 2.0)
        assert run.angle_to_deg(TARGET)[0] > 80.0
        assert run.angle_to_deg(TARGET)[-1] < 16.0
        assert run.omega_body[-1, 2] == pytest.approx(0.1, rel=1e-3)

    def test_a_bend_beyond_one_is_none(self):
        with pytest.raises(ValueError, match="between 0 and 1"):
            PrecessionGains(limit=1.5)


class TestStages:
    @pytest.mark.long
    @given(fields, vectors, axes)
    def test_nutation_loses_energy(self, b, rate, axis):
        e = np.eye(3)[axis]
        m = nutation_switch(tuple(np.cross(b, rate)), axis) * e
        assert np.dot(rate, np.cross(m, b)) <= 0.0

    @pytest.mark.long
    @given(fields, st.floats(-0.1, 0.1), axes)
    def test_both_coils_of_the_spin_turn_the_same_way(self, b, lacking, axis):
        for coil, switch in zip(
            ((axis + 1) % 3, (axis + 2) % 3), spin_switches(b, lacking, axis), strict=True
        ):
            torque = np.cross(switch * np.eye(3)[coil], b)
            assert torque[axis] * lacking >= 0.0

    @pytest.mark.long
    @given(fields, directions, axes)
    def test_the_direction_is_approached(self, b, target, axis):
        m = direction_switch(b, target, axis) * np.eye(3)[axis]
        assert np.dot(np.cross(m, b), target) >= 0.0

    def test_the_relay_is_off_in_its_dead_zone(self):
        assert [relay(s, 0.1, 2.0) for s in (-0.5, -0.05, 0.0, 0.1, 0.2)] == [-2.0, 0.0, 0.0, 0.0, 2.0]

    def test_nutation_comes_first_and_direction_last(self):
        gains = StageGains(nutation_deg=3.0, spin_band_radps=0.003)
        assert stage(4.0, 0.1, gains) is SpinStage.NUTATION
        assert stage(2.0, -0.1, gains) is SpinStage.SPIN
        assert stage(2.0, 0.002, gains) is SpinStage.DIRECTION

    @pytest.mark.parametrize("number", [1, 2, 3])
    def test_the_spin_has_both_coils_across_its_axis_fully_on(self, bench, turned, number):
        """Each with the sign by which its own torque is about the axis."""
        axis, lacking = number - 1, 0.04
        c = turned((4, 3, 1), 40.0) @ bench.Orbit().c_orbit_from_eci(300.0)
        inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, 0.06 * np.eye(3)[axis], FieldSample())
        settings = bench.config(bench.Body(most_am2=2.0), 1.0, {"relay_stages": StageGains(number, *TARGET)})
        m = np.array(relay_stages(inputs, (), bench.setpoint(spin_radps=0.06 + lacking), settings).m_body_am2)
        assert sorted(np.abs(m)) == [0.0, 2.0, 2.0]
        assert m[axis] == 0.0
        for coil in {0, 1, 2} - {axis}:
            assert np.cross(m[coil] * np.eye(3)[coil], inputs.b_body_t)[axis] > 0.0

    def test_with_the_spin_that_is_wanted_in_space_the_direction_is_left(self, bench, turned):
        """The absolute rate counts: that against the orbital frame would lack a part of w0."""
        c = turned((4, 3, 1), 40.0) @ bench.Orbit().c_orbit_from_eci(300.0)
        inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, np.array([0.0, 0.0, 0.1]), FieldSample())
        own = {"relay_stages": StageGains(3.0, *TARGET, spin_band_radps=1e-6)}
        settings = bench.config(bench.Body(INERTIA, most_am2=2.0), 1.0, own)
        m = relay_stages(inputs, (), bench.setpoint(spin_radps=0.1), settings).m_body_am2
        b, t = inputs.b_body_t, c @ TARGET
        assert m == (0.0, 0.0, 2.0 * np.sign(b[0] * t[1] - b[1] * t[0]))

    @pytest.mark.long
    def test_a_tumble_ends_in_the_spin_along_the_target(self, spinning):
        gains = StageGains(3.0, *TARGET)
        run = spinning(relay_stages, gains, 3.5, 0.1, 3.0, omega=(0.02, -0.03))
        assert set(np.abs(run.m_body).ravel()) == {0.0, 3.0}
        assert run.angle_to_deg(TARGET)[0] > 60.0
        assert run.angle_to_deg(TARGET)[-500:].max() < 8.0
        assert run.omega_body[-1, 2] == pytest.approx(0.1, abs=0.005)

    def test_a_nutation_without_two_samples_is_left_alone(self, bench, turned):
        c = turned((4, 3, 0), 25.0) @ bench.Orbit().c_orbit_from_eci(300.0)
        inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, np.array([0.05, 0.0, 0.1]), FieldSample())
        settings = bench.config(bench.Body(), 1.0, {"relay_stages": StageGains(3.0, *TARGET)})
        assert relay_stages(inputs, (), bench.setpoint(spin_radps=0.1), settings).m_body_am2 == (0.0,) * 3


class TestSteps:
    @given(fields, st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
    def test_the_level_takes_the_sum_of_the_squares_down(self, b, roll, yaw):
        """Torque m (-b_v, b_r) on (roll, yaw)."""
        level = step_level(b[0], b[1], roll, yaw, 0.0)
        assert level * (-b[1] * roll + b[0] * yaw) <= 0.0
        assert level in (-1.0, 0.0, 1.0)

    @pytest.mark.long
    @pytest.mark.parametrize(("spin", "flip"), [(0.1, False), (-0.1, True)])
    def test_three_levels_bring_the_momentum_to_the_normal(self, spinning, bench, spin, flip):
        run = spinning(stepped_precession, StepGains(3.0), 2.0, spin, 2.0, flip=flip)
        off = run.angle_to_deg(bench.Orbit().c_orbit_from_eci(0.0)[2])
        assert off[0] > 20.0
        assert off[-300:].max() < 6.0
        assert set(np.abs(run.m_body[:, 2])) == {0.0, 2.0}

    def test_a_level_is_held(self, spinning):
        """It changes every 120 s at most, 30 steps."""
        level = spinning(stepped_precession, StepGains(3.0), 0.5, 0.1, 2.0).m_body[:, 2]
        changes = np.flatnonzero(np.diff(level)) + 1
        assert changes.size > 3
        assert np.all(changes % 30 == 0)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: RollGains(k_h=0.0),
        lambda: StageGains(dead=-1.0),
        lambda: StepGains(hold_s=0.0),
        lambda: StepGains(axis=4.0),
    ],
)
def test_gains_without_sense_are_refused(wrong):
    with pytest.raises(ValueError, match=r"must be positive|body axis 1, 2 or 3"):
        wrong()
