"""Every monitor: what it lets pass, what trips it, and that it is the one that is named."""

from math import inf, nan

import pytest

from fsw.core.estimation.attitude import RATE_LIMIT_RADPS, UNKNOWN, Attitude
from fsw.core.monitors import Monitor, MonitorInput, first_violation

Q = (0.5, -0.5, 0.5, 0.5)
OMEGA = (0.01, -0.02, 0.03)
WELL = MonitorInput(
    attitude=Attitude(Q, OMEGA, 0.01, 1e-4, True),
    pending_impulse_body_nms=(1e-4, -2e-4, 3e-4),
    field_age_ticks=59,
    status_age_ticks=59,
    time_age_ticks=119,
    unexpected_drive=False,
    orbit_available=True,
    second_sender=False,
    stale_after_ticks=60,
)


def with_q(*q):
    return WELL.replace(attitude=WELL.attitude.replace(q_body_from_orbit=q))


def with_rate(*omega):
    return WELL.replace(attitude=WELL.attitude.replace(omega_body_orbit_radps=omega))


def owing(*impulse):
    return WELL.replace(pending_impulse_body_nms=impulse)


@pytest.mark.parametrize(
    "watched",
    [
        WELL,
        WELL.replace(attitude=UNKNOWN),
        WELL.replace(attitude=WELL.attitude.replace(valid=False)),
        with_q(1.0, 0.0, 0.0, 0.0),
        with_q(*(c * (1.0 + 4e-7) for c in Q)),
        with_rate(0.499, -0.499, 0.499),
        WELL.replace(field_age_ticks=0, status_age_ticks=0, time_age_ticks=0),
    ],
)
def test_all_is_well(watched):
    assert first_violation(watched) is None


TRIPS = [
    (Monitor.ATTITUDE_FINITE, with_q(nan, 0.0, 0.0, 0.0)),
    (Monitor.ATTITUDE_FINITE, with_q(inf, 0.0, 0.0, 0.0)),
    (Monitor.ATTITUDE_FINITE, with_q(inf, -inf, 0.0, 0.0)),
    (Monitor.ATTITUDE_FINITE, with_rate(0.0, nan, 0.0)),
    (Monitor.ATTITUDE_FINITE, with_rate(inf, 0.0, -inf)),
    (Monitor.QUATERNION_UNIT, with_q(0.0, 0.0, 0.0, 0.0)),
    (Monitor.QUATERNION_UNIT, with_q(*(c * (1.0 + 6e-7) for c in Q))),
    (Monitor.QUATERNION_UNIT, with_q(*(c * (1.0 - 6e-7) for c in Q))),
    (Monitor.RATE_BOUNDED, with_rate(RATE_LIMIT_RADPS, 0.0, 0.0)),
    (Monitor.RATE_BOUNDED, with_rate(0.0, -0.501, 0.0)),
    (Monitor.RATE_BOUNDED, with_rate(0.0, 0.0, 1e6)),
    (Monitor.OWED_FINITE, owing(nan, 0.0, 0.0)),
    (Monitor.OWED_FINITE, owing(0.0, inf, -inf)),
    (Monitor.FIELD_FRESH, WELL.replace(field_age_ticks=60)),
    (Monitor.COIL_STATUS_FRESH, WELL.replace(status_age_ticks=60)),
    (Monitor.COIL_AS_COMMANDED, WELL.replace(unexpected_drive=True)),
    (Monitor.ORBIT_KNOWN, WELL.replace(orbit_available=False)),
    (Monitor.NO_SECOND_SENDER, WELL.replace(second_sender=True)),
    (Monitor.TIME_AGREES, WELL.replace(time_age_ticks=120)),
]


@pytest.mark.requirement(
    "REQ-TRIP-01",
    "REQ-TRIP-02",
    "REQ-TRIP-03",
    "REQ-TRIP-04",
    "REQ-TRIP-05",
    "REQ-TRIP-06",
    "REQ-TRIP-07",
    "REQ-TRIP-08",
    "REQ-TRIP-09",
)
@pytest.mark.parametrize(("monitor", "watched"), TRIPS, ids=[monitor.name for monitor, _ in TRIPS])
def test_trips_and_is_named(monitor, watched):
    assert first_violation(watched) is monitor


def test_every_monitor_is_seen_to_trip():
    assert {monitor for monitor, _ in TRIPS} == set(Monitor)


def test_the_numbers_fit_the_event_s_argument_and_are_unique():
    assert sorted(Monitor) == list(range(1, len(Monitor) + 1))


def test_of_several_violations_the_first_of_the_list_is_named():
    everything = MonitorInput(
        Attitude((nan, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0), nan, nan, True),
        (nan, 0.0, 0.0),
        99,
        99,
        120,
        True,
        False,
        True,
        60,
    )
    assert first_violation(everything) is Monitor.ATTITUDE_FINITE
    assert first_violation(everything.replace(attitude=WELL.attitude)) is Monitor.OWED_FINITE


def test_the_rate_is_judged_by_component():
    edge = 0.999 * RATE_LIMIT_RADPS
    assert first_violation(with_rate(edge, edge, edge)) is None
