"""The scheduler by itself: its timing, its own timers, and what it owes."""

from dataclasses import replace
from math import exp, inf

import numpy as np
import pytest
from actuator_samples import then
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.actuation import pulses
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.laws.plan.pulse_model import Pulse

RATES = (1, 2, 3, 7, 10, 50)
SHARED_OR_NOT = pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TICK = 10_000
DIAGONAL_T = (3e-5, 3e-5, 3e-5)
PAID_NMS = (1e-5, -2e-5, 3e-5)


def make_config(tick_hz=1, shared=True, leak_s=300.0):
    pulse_ticks, backoff_ticks, duration_ms = pulses.pulse_timing(tick_hz, 3000, 100_000)
    return PulseConfig(
        pulse_ticks,
        backoff_ticks,
        duration_ms,
        shared,
        (0.5, 2.0, 8.0),
        duration_ms / 1000.0,
        1.0 / tick_hz,
        leak_s,
        rate_metric=IDENTITY,
        energy_metric=IDENTITY,
    )


def owing(config, impulse_nms, ready_tick=(0, 0, 0), busy_until=0):
    """A state that owes an impulse; unless told otherwise its timers ran out long ago."""
    return replace(
        pulses.boot(0, config),
        ready_tick=ready_tick,
        busy_until=busy_until,
        pending_impulse_body_nms=impulse_nms,
    )


def impulse(config, coil, level, b_body_t):
    """T m x b of a pulse, by numpy."""
    dipole_am2 = np.sign(level) * config.levels_am2[abs(level) - 1] * np.eye(3)[coil]
    return config.pulse_s * np.cross(dipole_am2, b_body_t)


# Timing


@pytest.mark.parametrize(
    ("tick_hz", "pulse_ticks", "backoff_ticks", "duration_ms"),
    [
        (1, 3, 100, 3000),
        (2, 6, 200, 3000),
        (3, 9, 300, 3000),
        (7, 21, 700, 3000),
        (10, 30, 1000, 3000),
        (50, 150, 5000, 3000),
    ],
)
def test_three_seconds_and_a_hundred_are_whole_ticks_at_every_rate(
    tick_hz, pulse_ticks, backoff_ticks, duration_ms
):
    assert pulses.pulse_timing(tick_hz, 3000, 100_000) == (pulse_ticks, backoff_ticks, duration_ms)


@pytest.mark.parametrize(
    ("tick_hz", "pulse_ms", "backoff_ms", "expected"),
    [
        (1, 2999, 99_001, (2, 100, 2000)),
        (1, 1000, 99_999, (1, 100, 1000)),
        (2, 2999, 100_001, (5, 201, 2500)),
        (3, 2999, 100_001, (8, 301, 2666)),
        (7, 2999, 99_999, (20, 700, 2857)),
        (7, 150, 1, (1, 1, 142)),
        (10, 3000, 0, (30, 0, 3000)),
        (50, 2999, 100_001, (149, 5001, 2980)),
        (100, 10, 100_000, (1, 10_000, 10)),
    ],
)
def test_what_is_not_whole_ticks_is_rounded_to_the_safe_side(tick_hz, pulse_ms, backoff_ms, expected):
    assert pulses.pulse_timing(tick_hz, pulse_ms, backoff_ms) == expected


@given(st.integers(1, 100), st.integers(10, 3000), st.integers(0, 160_000))
def test_a_pulse_is_never_longer_and_a_gap_never_shorter_and_both_by_less_than_a_tick(
    tick_hz, pulse_ms, backoff_ms
):
    if pulse_ms * tick_hz < 1000:
        with pytest.raises(ValueError, match="shorter than one tick"):
            pulses.pulse_timing(tick_hz, pulse_ms, backoff_ms)
        return
    pulse_ticks, backoff_ticks, duration_ms = pulses.pulse_timing(tick_hz, pulse_ms, backoff_ms)
    assert pulse_ticks * 1000 <= pulse_ms * tick_hz < (pulse_ticks + 1) * 1000
    assert (backoff_ticks - 1) * 1000 < backoff_ms * tick_hz <= backoff_ticks * 1000
    assert duration_ms <= pulse_ms
    assert duration_ms * tick_hz <= pulse_ticks * 1000 < (duration_ms + 1) * tick_hz


@pytest.mark.parametrize(("tick_hz", "pulse_ms"), [(1, 999), (2, 499), (10, 99), (1, 0)])
def test_a_pulse_shorter_than_a_tick_is_an_error(tick_hz, pulse_ms):
    with pytest.raises(
        ValueError, match=f"a pulse of {pulse_ms} ms is shorter than one tick at {tick_hz} Hz"
    ):
        pulses.pulse_timing(tick_hz, pulse_ms, 100_000)


# Own timers

WANTED = {coil: tuple(impulse(make_config(), coil, 3, DIAGONAL_T)) for coil in range(3)}


def may_fire(state, tick, config):
    """The coils that are fired at ``tick`` when each in its turn would pay all that is owed."""
    chosen = (
        pulses.choose(state, wanted, config.rate_metric, tick, DIAGONAL_T, config)
        for wanted in WANTED.values()
    )
    return {pulse.coil for pulse in chosen if pulse is not None}


@pytest.mark.parametrize("tick_hz", RATES)
@SHARED_OR_NOT
@pytest.mark.parametrize("boot_tick", [0, 1, 54_321])
def test_after_boot_a_whole_back_off_passes_first(tick_hz, shared, boot_tick):
    config = make_config(tick_hz, shared)
    state = pulses.boot(boot_tick, config)
    assert state.pending_impulse_body_nms == (0.0, 0.0, 0.0)
    assert state.busy_until == boot_tick, "no pulse is under way"
    free = boot_tick + 100 * tick_hz
    assert all(may_fire(state, tick, config) == set() for tick in range(boot_tick, free))
    assert may_fire(state, free, config) == {0, 1, 2}


@pytest.mark.parametrize("tick_hz", RATES)
@pytest.mark.parametrize("coil", [0, 1, 2])
def test_shared_no_coil_fires_again_before_a_back_off_after_the_end_of_the_pulse(tick_hz, coil):
    config = make_config(tick_hz, shared=True)
    state = then(pulses.fire, pulses.boot(0, config), Pulse(coil, -2), PAID_NMS, TICK, config)
    free = TICK + 103 * tick_hz
    assert all(may_fire(state, tick, config) == set() for tick in range(TICK, free))
    assert may_fire(state, free, config) == {0, 1, 2}


@pytest.mark.parametrize("tick_hz", RATES)
@pytest.mark.parametrize("coil", [0, 1, 2])
def test_per_coil_the_others_wait_for_the_end_of_the_pulse_alone(tick_hz, coil):
    config = make_config(tick_hz, shared=False)
    state = then(pulses.fire, pulses.boot(0, config), Pulse(coil, 1), PAID_NMS, TICK, config)
    end, free = TICK + 3 * tick_hz, TICK + 103 * tick_hz
    assert all(may_fire(state, tick, config) == set() for tick in range(TICK, end))
    assert all(may_fire(state, tick, config) == {0, 1, 2} - {coil} for tick in range(end, free))
    assert may_fire(state, free, config) == {0, 1, 2}


def test_per_coil_a_pulse_leaves_the_timers_of_the_other_coils_as_they_were():
    config = make_config(shared=False)
    state = owing(config, (0.0, 0.0, 0.0), ready_tick=(TICK, TICK - 7, TICK + 55))
    after = then(pulses.fire, state, Pulse(0, 1), PAID_NMS, TICK, config)
    assert after.ready_tick == (TICK + 103, TICK - 7, TICK + 55)
    assert after.busy_until == TICK + 3


# What is owed


STRONG_T = (10.0, 0.0, 0.0)
"""A field in which a pulse could pay more than these tests ask for."""


def test_a_torque_asked_for_is_owed_as_impulse_and_leaks():
    """r <- (1 - h / tau) r + T h, component by component."""
    config = make_config(tick_hz=2, leak_s=100.0)
    state = owing(config, (1.0, -2.0, 4.0))
    after = then(pulses.owe, state, (10.0, 20.0, -30.0), STRONG_T, config)
    keep = 1.0 - 0.5 / 100.0
    assert after.pending_impulse_body_nms == (keep * 1.0 + 5.0, keep * -2.0 + 10.0, keep * 4.0 - 15.0)
    assert (after.ready_tick, after.busy_until) == (state.ready_tick, state.busy_until)


@pytest.mark.parametrize("tick_hz", RATES)
def test_what_is_owed_is_forgotten_with_the_time_constant_of_the_leak_at_every_rate(tick_hz):
    config = make_config(tick_hz, leak_s=300.0)
    state = owing(config, (1.0, -1.0, 0.0))
    for _ in range(300 * tick_hz):
        pulses.owe(state, (0.0, 0.0, 0.0), STRONG_T, config)
    assert state.pending_impulse_body_nms == pytest.approx((exp(-1.0), -exp(-1.0), 0.0), rel=2e-3)


@pytest.mark.parametrize("tick_hz", RATES)
def test_a_lasting_torque_is_owed_up_to_torque_times_leak(tick_hz):
    config = make_config(tick_hz, leak_s=20.0)
    state = owing(config, (0.0, 0.0, 0.0))
    for _ in range(400 * tick_hz):
        pulses.owe(state, (2e-6, 0.0, -1e-6), STRONG_T, config)
    assert state.pending_impulse_body_nms == pytest.approx((4e-5, 0.0, -2e-5), rel=1e-6)


@pytest.mark.parametrize("tick_hz", RATES)
def test_no_more_is_owed_than_the_strongest_pulse_can_pay_and_its_direction_stays(tick_hz):
    """|r| <= T m_3 |b|: here 3 s, 8 A m^2, 50 uT."""
    config = make_config(tick_hz)
    b_body_t = (0.0, 3e-5, -4e-5)
    most = 3.0 * 8.0 * 5e-5
    state = owing(config, (0.0, 0.0, 0.0))
    for _ in range(10 * tick_hz):
        pulses.owe(state, (0.3, -0.6, 0.6), b_body_t, config)
        size = np.linalg.norm(state.pending_impulse_body_nms)
        assert size <= most * (1.0 + 1e-12)
    assert state.pending_impulse_body_nms == pytest.approx((most / 3, -2 * most / 3, 2 * most / 3))


def test_up_to_the_bound_nothing_is_taken_away():
    config = make_config(leak_s=inf)
    b_body_t = (0.0, 3e-5, -4e-5)
    below = (0.999 * 3.0 * 8.0 * 5e-5, 0.0, 0.0)
    assert (
        then(pulses.owe, owing(config, (0.0,) * 3), below, b_body_t, config).pending_impulse_body_nms == below
    )


def test_without_a_field_nothing_is_owed():
    config = make_config()
    for owed in ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0)):
        state = then(pulses.owe, owing(config, owed), owed, (0.0, 0.0, 0.0), config)
        assert state.pending_impulse_body_nms == (0.0, 0.0, 0.0)


# What is due


@pytest.mark.parametrize("tick_hz", [1, 2, 10, 50])
def test_due_is_what_will_be_owed_half_way_to_the_next_pulse(tick_hz):
    """At every rate: a pulse of 3 s and a back-off of 100 s stand for 103 s."""
    config = make_config(tick_hz)
    state = owing(config, (1.0, -2.0, 4.0))
    due = pulses.due(state, (0.1, 0.02, -0.04), STRONG_T, config)
    assert due == pytest.approx((1.0 + 5.15, -2.0 + 1.03, 4.0 - 2.06), rel=1e-12)


def test_no_more_is_due_than_the_strongest_pulse_can_pay_and_its_direction_stays():
    config = make_config()
    b_body_t = (0.0, 3e-5, -4e-5)
    most = 3.0 * 8.0 * 5e-5
    due = pulses.due(owing(config, (0.1, -0.2, 0.2)), (0.3, -0.6, 0.6), b_body_t, config)
    assert due == pytest.approx((most / 3, -2 * most / 3, 2 * most / 3))


@pytest.mark.parametrize(
    ("shared", "m_am2"),
    [(True, (0.05, 0.0, 0.0)), (False, (0.05, 0.0, 0.0)), (False, (-0.09, 0.05, 0.01))],
)
def test_a_lasting_demand_is_paid_though_what_is_owed_leaks(shared, m_am2):
    """To a twentieth; paid only when it is owed, an eighth of it and more would be forgotten."""
    config, b_body_t = make_config(shared=shared), (2e-5, -3e-5, 1e-5)
    torque = tuple(np.cross(m_am2, b_body_t).tolist())
    state, paid, ticks = pulses.boot(0, config), np.zeros(3), 30_000
    for tick in range(ticks):
        pulses.owe(state, torque, b_body_t, config)
        due = pulses.due(state, torque, b_body_t, config)
        pulse = pulses.choose(state, due, config.rate_metric, tick, b_body_t, config)
        if pulse is not None:
            given = pulses.impulse(pulse, b_body_t, config)
            pulses.fire(state, pulse, given, tick, config)
            paid += given
    assert paid / ticks @ torque / np.dot(torque, torque) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("level", [-3, -2, -1, 1, 2, 3])
@pytest.mark.parametrize("coil", [0, 1, 2])
def test_the_impulse_of_a_pulse(coil, level):
    """T m x b, with the sign of the level."""
    config = make_config(tick_hz=7)
    b_body_t = (2e-5, -3e-5, 1e-5)
    expected = tuple(impulse(config, coil, level, b_body_t))
    assert pulses.impulse(Pulse(coil, level), b_body_t, config) == pytest.approx(expected, abs=1e-18)


@pytest.mark.parametrize("level", [-3, -2, -1, 1, 2, 3])
@pytest.mark.parametrize("coil", [0, 1, 2])
def test_a_pulse_pays_its_impulse(coil, level):
    """r <- r - T m x b, whatever is left."""
    config = make_config()
    b_body_t = (2e-5, -3e-5, 1e-5)
    owed = (1e-5, 2e-5, 3e-5)
    pulse = Pulse(coil, level)
    after = then(
        pulses.fire, owing(config, owed), pulse, pulses.impulse(pulse, b_body_t, config), TICK, config
    )
    expected = np.array(owed) - impulse(config, coil, level, b_body_t)
    assert after.pending_impulse_body_nms == pytest.approx(tuple(expected), abs=1e-18)


@pytest.mark.parametrize(
    ("level", "dipole_am2"), [(-3, -8.0), (-2, -2.0), (-1, -0.5), (0, 0.0), (1, 0.5), (2, 2.0), (3, 8.0)]
)
def test_the_dipole_of_a_level(level, dipole_am2):
    assert pulses.dipole_am2(level, (0.5, 2.0, 8.0)) == dipole_am2


def test_a_skip_of_the_count_delays_the_timers_that_run_and_no_other():
    state = pulses.PulseState(ready_tick=(150, 90, 101), busy_until=102)
    later = then(pulses.delay, state, 121, 20)
    assert (later.ready_tick, later.busy_until) == ((170, 90, 121), 122)
    done = then(pulses.delay, state, 171, 20)
    assert (done.ready_tick, done.busy_until) == ((150, 90, 101), 102)
