"""What fsw reports: values, saturation, counters, and events on changes alone."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from flight_states import altered
from gate_samples import measured

from fsw.core import telemetry
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState, Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import NAMES, layout, with_component
from fsw.core.estimation.parameters import NOTHING as AS_THE_TABLE
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor
from fsw.core.rates import RateGroup, RateTable
from fsw.core.step import boot
from fsw.core.telemetry import COUNTED, SEVERITY, Event, Happening, first_counters
from fsw.wire.messages import (
    CLASSES,
    CoilDipole,
    CoilFire,
    CoilRefused,
    Component,
    FswBoot,
    FswEvent,
    FswHeartbeat,
    Mode,
    NavAttitude,
    NavParameter,
    NavQuality,
    NavRate,
    Severity,
    TcAck,
    WheelTorque,
    intact,
)

ATTITUDE = Attitude((0.8, 0.36, -0.288, 0.384), (0.011, -0.007, 0.005), 0.02, 3e-4, True)


@pytest.fixture(scope="module")
def state(make_world):
    return altered(boot(make_world().config), modes=ModeState(Mode.POINT, trips=1))


def telemetry_rates(parameter_ticks):
    every = RateGroup(1)
    return RateTable(attitude=every, quality=every, parameter=RateGroup(parameter_ticks), heartbeat=every)


def decoded(message):
    return type(message).decode(message.encode().data)


class TestMessages:
    def test_attitude_and_rate(self):
        attitude, rate = (decoded(message) for message in telemetry.attitude_messages(ATTITUDE))
        assert attitude.values()[:4] == pytest.approx((1, 0.36, -0.288, 0.384), abs=2**-16)
        assert rate.values()[:4] == pytest.approx((1, 0.011, -0.007, 0.005), abs=2**-19)

    def test_an_attitude_that_is_not_known_says_so(self):
        attitude, rate = telemetry.attitude_messages(UNKNOWN)
        assert (attitude.valid, rate.valid) == (0, 0)

    @pytest.mark.parametrize("trips", [0, 1, 255, 256, 70000])
    def test_quality(self, trips):
        modes = ModeState(Mode.ACQUIRE, trips=trips)
        message = decoded(telemetry.quality_message(ATTITUDE, modes, Used(True, False, True), lit=False))
        assert message.mode == Mode.ACQUIRE
        assert message.sigma3_attitude == pytest.approx(0.02, abs=2**-14)
        assert message.sigma3_rate == pytest.approx(3e-4, abs=2**-22)
        assert (message.mag_used, message.sun_used, message.mag_blanked) == (1, 0, 1)
        assert (message.eclipse, message.estimate_valid) == (1, 1)
        assert (message.tripped, message.trips) == (int(trips > 0), min(trips, 255))

    def test_what_is_no_number_goes_out_as_the_end_of_the_range(self):
        broken = Attitude((nan, nan, nan, nan), (nan, nan, nan), nan, nan, False)
        attitude, rate = (decoded(message) for message in telemetry.attitude_messages(broken))
        quality = decoded(telemetry.quality_message(broken, ModeState(), Used(False, False, False), lit=True))
        assert attitude.values()[:4] == (0, -1.0, -1.0, -1.0)
        assert rate.values()[:4] == (0, -0.125, -0.125, -0.125)
        assert (quality.sigma3_attitude, quality.estimate_valid) == (0.0, 0)

    @pytest.mark.parametrize(("rejects", "told"), [(0, 0), (65535, 65535), (65536, 65535), (10**9, 65535)])
    def test_heartbeat(self, rejects, told):
        message = decoded(telemetry.heartbeat_message(123456, ModeState(Mode.DETUMBLE), rejects))
        assert (message.state, message.rejects) == (Mode.DETUMBLE, told)
        assert (message.slips, message.tick) == (0, 123456 & 0xFFFF)

    def test_boot(self):
        frame = telemetry.boot_frame(0xCAFEF00D)
        assert intact(frame)
        assert FswBoot.decode(frame.data) == FswBoot(0, telemetry.CONTRACT_VERSION, 0xCAFEF00D, counter=0)


def estimate_with(component, place, value, sigma, size=9):
    """One in which a component has this value, and this standard deviation at its place."""
    covariance = np.diag([2.0] * size)
    covariance[place, place] = sigma**2
    parameters = with_component(AS_THE_TABLE, component, value)
    return Estimate((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), parameters, covariance)


class TestParameter:
    @pytest.mark.parametrize(
        ("value", "sigma"),
        [
            (3.456789e-7, 2.5e-8),
            (-3.456789e-7, 2.5e-8),
            (1.2e-9, 4.321e-5),
            (-0.0, 7.7e-3),
            (12.345678, 1e-9),
            (9.99996e-4, 9.99994e-4),
            (1e-40, 3e-41),
        ],
    )
    def test_value_and_deviation_have_four_decimal_places_of_the_larger(self, value, sigma):
        message = decoded(telemetry.parameter_message(estimate_with(4, 7, value, sigma), 4, 7))
        unit, larger = 10.0**message.exponent, max(abs(value), sigma)
        assert message.component == Component.TORQUE_Y
        assert message.value * unit == pytest.approx(value, rel=0.0, abs=0.5001e-4 * larger)
        assert message.sigma * unit == pytest.approx(sigma, rel=0.0, abs=0.5001e-4 * larger)

    def reports(self, state, estimate, carried, tick):
        rates = telemetry_rates(10)
        running = altered(state, tick=tick, estimator=EstimatorState(estimate))
        return telemetry.parameter_messages(running, layout(carried), rates)

    def test_each_that_is_carried_has_its_turn_and_no_other(self, state):
        estimate = estimate_with(4, 7, 2e-8, 1e-8, size=11)
        sent = {
            tick: self.reports(state, estimate, {"torque_body_nm", "delay_s"}, tick) for tick in range(60)
        }
        assert [tick for tick, messages in sent.items() if messages] == [0, 10, 20, 30, 40, 50]
        numbers = [Component(sent[tick][0].component).name for tick in (0, 10, 20, 30, 40, 50)]
        assert numbers == ["TORQUE_X", "TORQUE_Y", "TORQUE_Z", "MAG_DELAY", "SUN_DELAY", "TORQUE_X"]
        assert sent[10] == [NavParameter(Component.TORQUE_Y, -12, 20000, 10000)]

    @pytest.mark.parametrize("broken", [nan, inf, -1.0])
    def test_without_a_sound_estimate_there_is_none(self, state, broken):
        estimate = estimate_with(4, 7, 2e-8, 1e-8)
        covariance = estimate.covariance.copy()
        covariance[7, 7] = broken
        assert len(self.reports(state, estimate, {"torque_body_nm"}, 10)) == 1
        assert self.reports(state, None, {"torque_body_nm"}, 10) == []
        assert self.reports(state, replace(estimate, covariance=covariance), {"torque_body_nm"}, 10) == []

    def test_of_a_table_that_is_exact_there_is_none(self, state):
        assert self.reports(state, estimate_with(4, 7, 0.0, 1.0), set(), 10) == []

    def test_a_full_round_reports_every_number_on_the_bus_once(self, state):
        estimate = estimate_with(4, 10, 2e-8, 1e-8, size=6 + len(Component))
        excess = (0.01, -0.02, 0.03, -0.04, 0.05, -0.06)
        known = replace(estimate.parameters, cell_excess=excess, cell_gain=excess[::-1], earth_light=(0.07,))
        estimate = replace(estimate, parameters=known)
        sent = [self.reports(state, estimate, set(NAMES), 10 * n)[0] for n in range(len(Component))]
        assert [message.component for message in sent] == list(Component)


class TestNumbering:
    def test_each_message_counts_for_itself(self):
        nav, rate, beat = NavAttitude(1, 0.1, 0.2, 0.3), NavRate(1, 0.0, 0.0, 0.0), FswHeartbeat(0, 0, 0, 0)
        counters, observed = (
            first_counters(with_wheel=True),
            {NavAttitude.ID: [], NavRate.ID: [], FswHeartbeat.ID: []},
        )
        for tick in range(40):
            for frame in telemetry.number([nav, rate] + [beat] * (tick % 5 == 0), counters):
                assert intact(frame)
                observed[frame.can_id].append(CLASSES[frame.can_id].decode(frame.data).counter)
        assert observed[NavAttitude.ID] == observed[NavRate.ID] == [n % 16 for n in range(40)]
        assert observed[FswHeartbeat.ID] == list(range(8))

    def test_several_of_a_kind_in_one_tick(self):
        event, counters = FswEvent(0, 1, 2, 3), first_counters(with_wheel=True)
        frames = telemetry.number([event] * 3, counters)
        assert [FswEvent.decode(frame.data).counter for frame in frames] == [0, 1, 2]
        assert counters[COUNTED.index(FswEvent.ID)] == 3

    def test_order_and_values_stay(self):
        messages = [CoilFire(-2, 1, 5, 7, 3000), NavAttitude(1, 0.5, -0.25, 0.125)]
        frames = telemetry.number(messages, first_counters(with_wheel=True))
        assert [CLASSES[frame.can_id].decode(frame.data) for frame in frames] == messages

    def test_all_that_fsw_sends_now_and_then_is_numbered(self):
        assert len(set(COUNTED)) == len(COUNTED) == len(first_counters(with_wheel=True))
        assert set(COUNTED) == {
            m.ID
            for m in (
                CoilFire,
                CoilDipole,
                NavAttitude,
                NavRate,
                NavQuality,
                NavParameter,
                TcAck,
                FswEvent,
                FswHeartbeat,
                WheelTorque,
            )
        }

    def test_without_a_wheel_there_is_no_counter_of_its_torque(self):
        assert len(first_counters(with_wheel=False)) == len(COUNTED) - 1
        assert COUNTED[-1] == WheelTorque.ID


class TestEvents:
    NOTHING = measured()

    def found(self, before, after, readings=NOTHING, violated=None):
        return telemetry.happenings(telemetry.Before(before), after, readings, violated, 60)

    def test_nothing_happened(self, state):
        assert self.found(state, altered(state, tick=7)) == []

    def test_a_new_mode(self, state):
        after = altered(state, modes=replace(state.modes, mode=Mode.ACQUIRE))
        assert self.found(state, after) == [Happening(Event.MODE_CHANGED, Mode.ACQUIRE)]

    def test_a_trip_is_told_with_its_monitor_before_the_mode_that_follows(self, state):
        after = altered(state, modes=ModeState(Mode.SAFE, trips=2))
        assert self.found(state, after, violated=Monitor.FIELD_FRESH) == [
            Happening(Event.MONITOR_TRIPPED, Monitor.FIELD_FRESH),
            Happening(Event.MODE_CHANGED, Mode.SAFE),
        ]

    def test_a_violation_that_begins_in_safe_is_told_too(self, state):
        safe = altered(state, modes=ModeState(Mode.SAFE, trips=2))
        after = altered(safe, tick=8, violated=Monitor.ORBIT_KNOWN)
        told = [Happening(Event.MONITOR_TRIPPED, Monitor.ORBIT_KNOWN)]
        assert self.found(safe, after, violated=Monitor.ORBIT_KNOWN) == told
        other = altered(safe, violated=Monitor.FIELD_FRESH)
        assert self.found(other, after, violated=Monitor.ORBIT_KNOWN) == told

    def test_a_violation_that_lasts_is_told_once(self, state):
        safe = altered(state, modes=ModeState(Mode.SAFE, trips=2), violated=Monitor.FIELD_FRESH)
        assert self.found(safe, altered(safe, tick=8), violated=Monitor.FIELD_FRESH) == []

    def test_the_filter_starts_and_restarts(self, state):
        known = Estimate((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), AS_THE_TABLE, np.eye(6))
        running = altered(state, estimator=EstimatorState(known))
        lost = altered(state, estimator=EstimatorState(None, restarts=1))
        again = altered(state, estimator=EstimatorState(known, restarts=1))
        assert self.found(state, running) == [Happening(Event.FILTER_STARTED, 0)]
        assert self.found(running, running) == []
        assert self.found(running, lost) == [Happening(Event.FILTER_RESTARTED, 1)]
        assert self.found(lost, lost) == []
        assert self.found(lost, again) == [Happening(Event.FILTER_STARTED, 1)]
        assert self.found(running, again) == [Happening(Event.FILTER_RESTARTED, 1)]

    def test_each_refusal_is_told_with_its_reason(self, state):
        refused = measured(refused=(CoilRefused(1, 9, 8, 0), CoilRefused(1, 9, 3, 0)))
        told = [Happening(Event.REQUEST_REFUSED, 8), Happening(Event.REQUEST_REFUSED, 3)]
        assert self.found(state, state, refused) == told

    @pytest.mark.parametrize("error_s", [1, -1, -86400])
    def test_a_clock_that_is_off_is_told_when_it_changes(self, state, error_s):
        off = altered(state, time_error_s=error_s)
        assert self.found(state, off) == [Happening(Event.TIME_MISMATCH, error_s)]
        assert self.found(off, off) == []
        assert self.found(off, state) == [Happening(Event.TIME_MISMATCH, 0)]

    def test_the_numbers_are_those_that_logs_hold(self):
        assert {event.name: event.value for event in Event} == {
            "MODE_CHANGED": 1,
            "FILTER_STARTED": 2,
            "FILTER_RESTARTED": 3,
            "MONITOR_TRIPPED": 4,
            "REQUEST_REFUSED": 5,
            "TIME_MISMATCH": 6,
            "SENSOR_ISOLATED": 7,
            "SENSOR_READMITTED": 8,
            "SENSORS_DISAGREE": 9,
            "COIL_FAULT": 10,
            "SECOND_SENDER": 11,
            "STRANGE_SYNC": 12,
            "PLANT_RESTARTED": 13,
            "FALSE_END": 14,
            "COIL_READMITTED": 15,
            "FILTER_EASED": 16,
        }

    def test_every_event_has_a_severity_and_fits_its_signal(self):
        assert set(SEVERITY) == set(Event)
        assert all(0 < event < 256 for event in Event)
        assert SEVERITY[Event.MONITOR_TRIPPED] is Severity.ERROR

    @pytest.mark.parametrize("argument", [0, 3, -1, -(2**31), 2**31 - 1])
    def test_on_the_bus(self, argument):
        message = decoded(telemetry.event_message(Happening(Event.TIME_MISMATCH, argument), tick=70003))
        assert message == FswEvent(Severity.WARNING, Event.TIME_MISMATCH, 70003 & 0xFF, argument)

    @pytest.mark.parametrize(
        ("argument", "told"),
        [(2867542878, 2**31 - 1), (2**31, 2**31 - 1), (2**32 - 1, 2**31 - 1), (-(2**31) - 1, -(2**31))],
    )
    def test_a_time_out_of_range_saturates(self, argument, told):
        """A time is off by up to 136 years; the wrapped number would be one of the other sign."""
        message = decoded(telemetry.event_message(Happening(Event.TIME_MISMATCH, argument), tick=7))
        assert message.argument == told
