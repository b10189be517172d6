"""What flights are made of: long ones with many pulses, ties, zeros, and what is no whole number of ticks."""

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from sim.testing import Fire, Reboot, audit_scheduler, flights, limits, timings_ms
from sim.testing.strategies import BROKEN_RATES, MOST_TICKS, WHOLE_RATES

EXAMPLES = 100


class Eager:
    """Fires whenever the board allows it, without timers of its own."""

    def __init__(self, limits):
        self.pulse_ms = limits.pulse_ms * limits.tick_hz // 1000 * 1000 // limits.tick_hz

    def step(self, heard):
        status = heard.status
        if status is None or status.lockout_ms or status.remaining_ms:
            return []
        return [Fire(status.coil, 3, self.pulse_ms)]


def drawn(strategy):
    examples = []

    @settings(
        max_examples=EXAMPLES,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @seed(1)
    @given(strategy)
    def keep(example):
        examples.append(example)

    keep()
    return examples


@pytest.fixture(scope="module")
def some():
    return drawn(flights())


def demands(some):
    return [[stretch.m_body_am2 for stretch in flight.stretches] for flight in some]


@pytest.mark.long
@pytest.mark.slow
def test_some_of_a_hundred_hold_a_thousand_pulses_between_reboots(some):
    calm = [one for one in some if all(stretch.reboot is Reboot.NOBODY for stretch in one.stretches)]
    longest = sorted(calm, key=lambda one: one.laps * sum(stretch.ticks for stretch in one.stretches))[-15:]
    many = [one for one in longest if len(audit_scheduler(Eager, one).pulses) >= 1000]
    assert (
        len(many) >= 3
    )  # Hypothesis draws constants of the modules that are loaded too: 4 to 8 by what else has run


@pytest.mark.long
def test_none_is_too_long_to_be_flown_in_a_second(some):
    """But where a lap alone is."""
    ticks = [(one.laps, one.laps * sum(stretch.ticks for stretch in one.stretches)) for one in some]
    assert all(count <= MOST_TICKS for laps, count in ticks if laps > 1)


@pytest.mark.long
@pytest.mark.parametrize(
    "tie",
    [
        lambda m: m[0] == m[1] == m[2] != 0.0,
        lambda m: abs(m[0]) == abs(m[1]) == abs(m[2]) != 0.0 and len(set(m)) == 2,
        lambda m: 0.0 in m and len({abs(one) for one in m}) == 2,
        lambda m: m == (0.0, 0.0, 0.0),
    ],
    ids=["equal in value", "equal in size alone", "two equal or one alone", "nothing asked for"],
)
def test_some_of_a_hundred_have_demands_that_tie(some, tie):
    assert sum(any(map(tie, asked)) for asked in demands(some)) >= 5


def test_some_have_demands_of_no_order_at_all(some):
    assert sum(any(len({*map(abs, m), 0.0}) == 4 for m in asked) for asked in demands(some)) >= 10


def test_pulse_and_back_off_are_whole_ticks_in_some_and_not_in_others(some):
    for name in ("pulse_ms", "backoff_ms"):
        whole = sum(getattr(one.limits, name) * one.limits.tick_hz % 1000 == 0 for one in some)
        assert 20 <= whole <= 80, name


@pytest.mark.parametrize("tick_hz", WHOLE_RATES + BROKEN_RATES)
def test_a_pulse_is_a_tick_long_at_least_and_no_back_off_is_nothing(tick_hz):
    for pulse_ms, backoff_ms in drawn(timings_ms(tick_hz)):
        assert pulse_ms * tick_hz >= 1000
        assert backoff_ms >= 1


@pytest.mark.long
def test_limits_are_as_told():
    for one in drawn(flights(limits(st.just(2), st.just((3000, 100_000)), st.just(True)))):
        assert (one.limits.tick_hz, one.limits.pulse_ms, one.limits.backoff_ms) == (2, 3000, 100_000)
        assert one.limits.shared


@pytest.mark.long
def test_demands_are_as_told():
    for one in drawn(flights(demands=st.just((1.0, 2.0, 3.0)))):
        assert {stretch.m_body_am2 for stretch in one.stretches} == {(1.0, 2.0, 3.0)}


def test_a_hundred_are_a_hundred_flights_and_not_variants_of_a_few(some):
    assert len({one.limits for one in some}) >= 60
