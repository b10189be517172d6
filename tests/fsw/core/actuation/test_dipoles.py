"""The continuous driver: a dipole a tick as asked for, and an impulse in the timing of the pulses."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from actuator_samples import answered, then
from gate_samples import measured
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.actuation import dipoles, pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, update_view
from fsw.core.actuation.dipoles import MOST, DipoleConfig, RequestedDipole, dipole_am2, request, saturate
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import ZERO, inverse
from fsw.core.laws.interface import Demand
from fsw.core.laws.predictive import best_impulse
from fsw.wire.messages import CoilDipole, CoilDipoleStatus, CoilStatus

INERTIA = ((1.02, 0.13, -0.09), (0.13, 1.85, 0.21), (-0.09, 0.21, 1.55))
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
FULL_SCALE_AM2 = 9.6
CONFIG = DipoleConfig(FULL_SCALE_AM2, INERTIA, genetic=False)
GENETIC = replace(CONFIG, genetic=True)
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
IMPULSE_NMS = (2e-4, 1e-4, -3e-4)
LSB = 2.0**-16


def make_timing(tick_hz=1):
    pulse_ticks, backoff_ticks, duration_ms = pulses.pulse_timing(tick_hz, 3000, 100_000)
    return PulseConfig(
        pulse_ticks=pulse_ticks,
        backoff_ticks=backoff_ticks,
        duration_ms=duration_ms,
        shared=True,
        levels_am2=(0.5, 2.0, 8.0),
        pulse_s=duration_ms / 1000.0,
        tick_s=1.0 / tick_hz,
        leak_s=300.0,
        rate_metric=IDENTITY,
        energy_metric=inverse(INERTIA),
    )


TIMING = make_timing()


def am2(sent):
    return FULL_SCALE_AM2 * np.array([sent.m_x, sent.m_y, sent.m_z])


def driven_by(sent, config):
    return dipole_am2((sent.m_x, sent.m_y, sent.m_z), config)


class TestSaturation:
    def test_a_dipole_that_fits_is_sent_as_it_is(self):
        assert am2(saturate((1.0, -9.5, 4.0), CONFIG)) == pytest.approx((1.0, -9.5, 4.0))

    @given(st.tuples(*[st.floats(-1e3, 1e3)] * 3))
    def test_what_does_not_fit_is_shortened_and_not_turned(self, m_body_am2):
        sent = am2(saturate(m_body_am2, CONFIG))
        most = max(abs(c) for c in m_body_am2)
        limit = MOST * FULL_SCALE_AM2
        expected = np.array(m_body_am2) * min(1.0, limit / most if most > 0.0 else 1.0)
        np.testing.assert_allclose(sent, expected, rtol=1e-12, atol=1e-300)
        assert max(abs(sent)) <= limit * (1.0 + 1e-15)

    @pytest.mark.parametrize("m_body_am2", [(50.0, 0.0, 0.0), (-50.0, 9.6, -50.0), (9.6, -9.6, 9.6)])
    def test_the_largest_is_what_the_wire_can_bear(self, m_body_am2):
        """And comes off it with the sign it went on it with."""
        sent = saturate(m_body_am2, CONFIG)
        report = CoilDipole.decode(sent.encode().data)
        np.testing.assert_allclose(am2(report), am2(sent), atol=LSB * FULL_SCALE_AM2)
        assert max(abs(c) for c in report.values()[:3]) == MOST

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize("value", [nan, inf, -inf])
    def test_what_is_not_a_number_asks_for_nothing(self, axis, value):
        """On the wire it would be full scale."""
        m_body_am2 = tuple(value if i == axis else 1.0 for i in range(3))
        assert saturate(m_body_am2, CONFIG) == CoilDipole(0.0, 0.0, 0.0)

    def test_none_is_none(self):
        assert saturate(ZERO, CONFIG) == CoilDipole(0.0, 0.0, 0.0)


class TestDriven:
    def test_is_what_the_board_says_of_full_scale(self):
        assert dipole_am2((0.5, -0.25, 0.125), CONFIG) == pytest.approx((4.8, -2.4, 1.2))

    @pytest.mark.parametrize(("age", "driven_am2"), [(1, (1.0, 2.0, 3.0)), (0, ZERO), (2, ZERO)])
    def test_without_a_report_it_is_what_was_asked_for_this_tick(self, age, driven_am2):
        view = CoilView(requested=RequestedDipole(44 - age, (1.0, 2.0, 3.0)))
        view = then(update_view, view, measured(), 44, ActuatorConfig(TIMING, CONFIG))
        assert view.driven_am2 == driven_am2
        assert not view.requested.reported

    def test_it_is_what_the_view_holds_and_no_level_is(self):
        coils = ActuatorConfig(TIMING, CONFIG)
        readings = measured(coil=CoilStatus(0, 1, 0, 0, 0, 0), dipole=CoilDipoleStatus(0.5, -0.25, 0.125))
        view = then(update_view, CoilView(), readings, 44, coils)
        assert view.driven_am2 == pytest.approx((4.8, -2.4, 1.2))
        assert view.driven_level == 0
        assert view.requested.reported


class TestCoilsOutOfSquare:
    """The columns of the matrix are their dipoles per unit nominal one."""

    TRUE = ((0.98, 0.01, -0.03), (0.05, 1.03, 0.02), (-0.02, 0.04, 0.97))
    COILS = replace(CONFIG, body_from_coils=TRUE, coils_from_body=inverse(TRUE))

    def test_what_the_board_says_is_driven_by_the_true_ones(self):
        driven_am2 = dipole_am2((0.5, -0.25, 0.125), self.COILS)
        assert driven_am2 == pytest.approx(np.array(self.TRUE) @ (4.8, -2.4, 1.2), rel=1e-12)

    def test_the_request_is_what_makes_them_give_the_dipole_wanted(self):
        wanted_am2 = (1.0, -5.5, 4.0)
        assert driven_by(saturate(wanted_am2, self.COILS), self.COILS) == pytest.approx(wanted_am2, rel=1e-12)

    def test_what_does_not_fit_is_shortened_in_the_body_too(self):
        wanted_am2 = np.array((30.0, -40.0, 20.0))
        sent = saturate(tuple(wanted_am2), self.COILS)
        driven_am2 = np.array(driven_by(sent, self.COILS))
        assert max(map(abs, sent.values()[:3])) == MOST
        assert np.dot(driven_am2, wanted_am2) > 0.0
        assert np.cross(driven_am2, wanted_am2) == pytest.approx(ZERO, abs=1e-9)


def history(demands, config=CONFIG, timing=TIMING, b=lambda tick: B_BODY_T, boot_tick=0):
    """What is sent in each tick from boot on, A m^2."""
    state, sent = pulses.boot(boot_tick, timing), []
    for tick, demand in enumerate(demands, boot_tick):
        message = request(state, demand, b(tick), tick, config, timing)
        sent.append(am2(message))
    return np.array(sent)


def missing(impulse=IMPULSE_NMS):
    return Demand(impulse_body_nms=impulse)


def best_am2(impulse=IMPULSE_NMS, b=B_BODY_T, timing=TIMING):
    """M = b x p / (T b^2): the shortest dipole that gives p."""
    p = np.array(best_impulse(impulse, b, INERTIA))
    return np.cross(b, p) / (timing.pulse_s * np.dot(b, b))


class TestContinuousLaw:
    def test_each_tick_has_its_own_dipole_from_the_first_on(self):
        """No timing of pulses: the board ends a request by itself."""
        asked = [(0.1 * n, -0.2 * n, 0.3) for n in range(12)]
        np.testing.assert_allclose(history([Demand(m) for m in asked]), asked, rtol=1e-12, atol=1e-15)

    def test_nothing_is_owed(self):
        state = then(request, pulses.boot(0, TIMING), Demand((1e3, 1e3, 1e3)), B_BODY_T, 5, CONFIG, TIMING)
        assert state == pulses.boot(0, TIMING)


class TestImpulses:
    def test_the_dipole_gives_the_best_impulse_over_a_pulse(self):
        sent = history([missing()] * 103)[102]
        given_nms = TIMING.pulse_s * np.cross(sent, B_BODY_T)
        np.testing.assert_allclose(given_nms, best_impulse(IMPULSE_NMS, B_BODY_T, INERTIA), rtol=1e-9)
        assert abs(sent @ np.array(B_BODY_T)) < 1e-12 * np.linalg.norm(sent)
        assert np.linalg.norm(sent) > 0.1

    @pytest.mark.parametrize("tick_hz", [1, 2, 7, 10])
    @pytest.mark.parametrize("boot_tick", [0, 17])
    def test_the_timing_is_that_of_the_pulses(self, tick_hz, boot_tick):
        """A back-off after boot, then 3 s on and 100 s off."""
        timing = make_timing(tick_hz)
        sent = history([missing()] * (310 * tick_hz), timing=timing, boot_tick=boot_tick)
        on = [any(m) for m in sent]
        changes = [tick / tick_hz for tick in range(1, len(on)) if on[tick] is not on[tick - 1]]
        assert changes == [100.0, 103.0, 203.0, 206.0, 306.0, 309.0]
        assert not on[0]

    def test_the_coils_fire_when_a_pulse_would(self):
        """The first ticks of both, under the same lasting demand."""
        state, fired = pulses.boot(0, TIMING), []
        for tick in range(310):
            pulse = pulses.choose(state, IMPULSE_NMS, TIMING.energy_metric, tick, B_BODY_T, TIMING)
            if pulse is not None:
                fired.append(tick)
                pulses.fire(state, pulse, ZERO, tick, TIMING)
        sent = history([missing()] * 310)
        assert fired == [t for t in range(310) if any(sent[t]) and not any(sent[t - 1])]

    def test_it_is_held_whatever_the_field_and_the_demand_do_meanwhile(self):
        demands = [missing()] * 101 + [missing((1.0, 1.0, 1.0)), missing(ZERO), missing((1.0, 1.0, 1.0))]
        sent = history(demands, b=lambda tick: B_BODY_T if tick <= 100 else (3e-5, 1e-5, 0.0))
        for tick in (100, 101, 102):
            np.testing.assert_allclose(sent[tick], best_am2(), rtol=1e-12)
        assert not any(sent[103])

    @pytest.mark.parametrize("config", [CONFIG, GENETIC], ids=["closed form", "genetic"])
    def test_without_a_field_nothing_is_begun_and_the_first_field_serves(self, config):
        sent = history([missing()] * 110, config, b=lambda tick: ZERO if tick < 107 else B_BODY_T)
        assert not sent[:107].any()
        assert sent[107:].any(axis=1).all()

    def test_the_search_finds_what_the_closed_form_does(self):
        """To a hundredth of the energy that can be taken away."""
        metric, r = np.array(TIMING.energy_metric), np.array(IMPULSE_NMS)

        def cost(m):
            left = r - TIMING.pulse_s * np.cross(m, B_BODY_T)
            return left @ metric @ left

        by_search = history([missing()] * 101, GENETIC)[100]
        assert cost(by_search) <= cost(best_am2()) + 0.01 * (cost(np.zeros(3)) - cost(best_am2()))
        assert not np.array_equal(by_search, history([missing()] * 101)[100])

    def test_the_search_differs_from_pulse_to_pulse_and_is_the_same_in_each_flight(self):
        once, again = (history([missing()] * 310, GENETIC) for _ in range(2))
        np.testing.assert_array_equal(once, again)
        assert not np.array_equal(once[100], once[203])
        np.testing.assert_array_equal(once[100], once[102])

    def test_a_law_of_dipoles_is_not_kept_waiting_by_a_pulse(self):
        sent = history([missing()] * 101 + [Demand((1.0, 2.0, 3.0))])
        np.testing.assert_allclose(sent[101], (1.0, 2.0, 3.0))


class TestActuate:
    """The continuous driver behind the same door as the pulses."""

    COILS = ActuatorConfig(TIMING, CONFIG)
    HEARD = measured(dipole=CoilDipoleStatus(0.0, 0.0, 0.0))

    def run(self, demand, readings=HEARD, tick=500):
        state = replace(
            pulses.boot(0, TIMING), ready_tick=(0, 0, 0), pending_impulse_body_nms=(1.0, 1.0, 1.0)
        )
        return answered(state, CoilView(), demand, B_BODY_T, readings, tick, self.COILS)

    def test_a_request_goes_out_at_once(self):
        assert self.run(Demand((1.0, -2.0, 3.0)))[2] == saturate((1.0, -2.0, 3.0), CONFIG)
        assert np.array(am2(self.run(missing())[2])) == pytest.approx(best_am2())

    def test_it_is_remembered_as_it_is_on_the_wire(self):
        _, view, sent = self.run(Demand((1.0, -2.0, 3.0)))
        assert view.requested == RequestedDipole(
            500, driven_by(CoilDipole.decode(sent.encode().data), CONFIG)
        )
        assert view.requested.m_body_am2 == pytest.approx((1.0, -2.0, 3.0), abs=FULL_SCALE_AM2 * LSB)

    def test_one_that_was_not_sent_is_not(self):
        for demand, readings in ((None, self.HEARD), (missing(), measured())):
            assert self.run(demand, readings)[1] == CoilView()

    @pytest.mark.parametrize("demand", [Demand((1.0, -2.0, 3.0)), missing()], ids=["dipole", "impulse"])
    def test_nothing_goes_to_a_board_that_is_not_heard(self, demand):
        assert self.run(demand, measured())[2] is None
        assert self.run(demand, measured(coil=CoilStatus(0, 0, 0, 0, 0, 0)))[2] is None

    def test_without_a_law_nothing_is_sent_and_nothing_owed(self):
        state, _, sent = self.run(None)
        assert sent is None
        assert state.pending_impulse_body_nms == ZERO


def test_full_scale_of_the_wire_is_below_one():
    assert 1.0 - LSB == MOST == dipoles.MOST
