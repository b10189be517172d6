"""A pitch wheel whose speed is controlled: pitch by the wheel, its axis and its momentum by the coils."""

import numpy as np
import pytest

from fsw.core.laws.interface import FieldSample, Wheel
from fsw.core.laws.pitch_wheel import (
    PitchWheelGains,
    momentum_dipole,
    pitch_torque,
    pitch_wheel,
)

WHEEL = Wheel((0.0, 0.0, 1.0), 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=4.0, stale_ticks=10)
B = (2.1e-5, -1.4e-5, 0.9e-5)


def test_the_pitch_is_that_of_a_damped_spring():
    gains = PitchWheelGains(pitch_rad=0.3, frequency_radps=0.05, damping=0.8)
    turning = 0.05**2 * np.sin(0.3 - 0.1)
    expected = 1.95 * (turning - 2.0 * 0.8 * 0.05 * 2e-3)
    assert pitch_torque(0.1, 2e-3, 1.95, gains) == pytest.approx(expected, rel=1e-12)


def test_the_coils_take_an_excess_of_momentum_away_about_axis_3():
    torque = np.cross(momentum_dipole(B, 0.02, 1e-3), B)
    across = (B[0] ** 2 + B[1] ** 2) / np.dot(B, B)
    assert torque[2] == pytest.approx(-1e-3 * 0.02 * across, rel=1e-12)
    assert momentum_dipole((0.0, 0.0, 0.0), 0.02, 1e-3) == (0.0, 0.0, 0.0)


def flown(bench, turned, first=((1, -2, 3), 15.0), orbits=2.0, begin_nms=0.05, k_w=1e7, **gains):
    orbit = bench.Orbit(500.0, 80.0)
    wheel = gains.pop("wheel", WHEEL)
    return bench.fly(
        pitch_wheel,
        bench.setpoint("pitch_wheel", k_w=k_w, k_a=4000.0),
        gains={"pitch_wheel": PitchWheelGains(**gains)},
        orbit=orbit,
        body=bench.Body(most_am2=8.0, driven=wheel, driven_nms=begin_nms),
        c_body_from_orbit=turned(*first),
        omega_body=(0.0, 0.0, orbit.rate_radps),
        seconds=orbits * orbit.period_s,
    )


def test_the_wheel_turns_the_body_against_its_moment_about_axis_3(bench, turned):
    orbit, gains = bench.Orbit(500.0, 80.0), PitchWheelGains(pitch_rad=0.1, damping=0.8)
    inertia = np.array([[1.02, 0.13, -0.09], [0.13, 0.65, 0.21], [-0.09, 0.21, 1.95]])
    settings = bench.config(bench.Body(inertia, driven=WHEEL), 4.0, {"pitch_wheel": gains})
    c = turned((0, 0, 1), 20.0) @ orbit.c_orbit_from_eci(400.0)
    inputs = bench.inputs_at(orbit, 100, 4.0, c, (0.0, 0.0, orbit.rate_radps + 1e-3), FieldSample())
    demand = pitch_wheel(inputs.replace(wheel_nms=0.05), (), bench.setpoint(), settings)
    on_body_nm = 1.95 * (0.02**2 * np.sin(0.1 - np.radians(20.0)) - 2.0 * 0.8 * 0.02 * 1e-3)
    assert demand.wheel_torque_nm == pytest.approx(-on_body_nm, rel=1e-9)


def pitches_deg(flight):
    c = flight.c_body_from_orbit
    return np.degrees(np.arctan2(c[:, 0, 1] - c[:, 1, 0], c[:, 0, 0] + c[:, 1, 1]))


def test_a_turn_in_pitch_takes_minutes_and_the_wheel_gives_it(bench, turned):
    """The coils of ``dual_spin`` take orbits for it: (1 + w_n t) exp(-w_n t) here."""
    flight = flown(bench, turned, first=((0, 0, 1), 20.0), orbits=0.1)
    expected = 20.0 * (1.0 + 0.02 * flight.t_s) * np.exp(-0.02 * flight.t_s)
    assert np.abs(pitches_deg(flight)) == pytest.approx(expected, abs=1.0)
    assert np.abs(flight.wheel_nms - 0.05).max() > 1e-3


@pytest.mark.long
def test_all_three_axes_come_to_rest(bench, turned):
    flight = flown(bench, turned, orbits=4.0)
    assert flight.angle_deg[-300:].max() < 1.5
    assert flight.angle_deg[-300:].max() < 0.1 * flight.angle_deg[0]


@pytest.mark.long
@pytest.mark.parametrize("begin_nms", [0.08, 0.02])
def test_the_momentum_is_brought_to_its_bias(bench, turned, begin_nms):
    flight = flown(bench, turned, begin_nms=begin_nms, orbits=2.0)
    assert flight.wheel_nms[-1] == pytest.approx(0.05, abs=2e-3)


def test_a_wheel_that_turns_the_other_way_is_only_spun_up(bench, turned):
    """Coil 3 would drive its axis away from the normal.

    The pitch is held meanwhile but for the coils' torque, at most k (h_0 - h), on its spring J_33 w_n^2.
    """
    flight = flown(bench, turned, first=((0, 0, 1), 5.0), begin_nms=-0.01, orbits=0.5)
    backwards = flight.wheel_nms < 0.0
    assert 50 < np.sum(backwards) < len(backwards) - 50
    assert not flight.m_body[backwards, 2].any()
    assert flight.m_body[~backwards, 2].any()
    held_off_deg = np.degrees(5e-4 * (0.05 - flight.wheel_nms) / (bench.Body().inertia[2][2] * 0.02**2))
    assert (np.abs(pitches_deg(flight)) < held_off_deg)[-20:].all()
    assert held_off_deg[-20:].max() < 1.0


@pytest.mark.long
def test_a_pitch_of_its_own_is_held(bench, turned):
    flight = flown(bench, turned, first=((0, 0, 1), 0.0), pitch_rad=0.35, orbits=0.5)
    assert pitches_deg(flight)[-1] == pytest.approx(np.degrees(0.35), abs=0.3)


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (0.0, 0.0, -1.0)])
def test_a_wheel_along_another_axis_is_not_driven(bench, turned, axis):
    wheel = Wheel(axis, 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=4.0, stale_ticks=10)
    flight = flown(bench, turned, wheel=wheel, orbits=0.05)
    assert (flight.wheel_nms == 0.05).all()
    assert not flight.m_body.any()


@pytest.mark.parametrize(
    "wrong",
    [
        {"frequency_radps": 0.0},
        {"damping": 20.0},
        {"pitch_rad": 4.0},
        {"bias_nms": 0.0},
        {"unload_per_s": 1.0},
    ],
)
def test_gains_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        PitchWheelGains(**wrong)
