"""The wheel as the controller sees it: which reports count, what the filter gets, what is asked for."""

from dataclasses import replace
from math import inf, nan, sqrt

import pytest
from actuator_samples import then
from gate_samples import measured

from fsw.core.actuation.wheel import (
    UNIT_NM,
    WheelView,
    friction_nm,
    momentum_nms,
    request,
    update_view,
    wheel_motion,
)
from fsw.core.laws.interface import Demand, Wheel
from fsw.wire.messages import WheelStatus, WheelTorque

AXIS = (0.48, -0.6, 0.64)
WHEEL = Wheel(AXIS, 2e-4, 2e-3, 0.12, 2e-7, 2e-5, tick_s=0.5, stale_ticks=20)


def reported(speed_radps, valid=1):
    return measured(wheel=WheelStatus(valid, 1, speed_radps, 0.0))


def after(*speeds, first_tick=0):
    """The view after reports in tick after tick; None: none came."""
    view = WheelView()
    for tick, speed in enumerate(speeds, start=first_tick):
        update_view(view, measured() if speed is None else reported(speed), tick, WHEEL)
    return view


def test_without_a_wheel_there_is_no_momentum():
    assert momentum_nms(None, None) is None
    assert wheel_motion(None, 3, 1, None) is None


def test_a_report_gives_momentum_and_its_change():
    view = after(100.0, 103.0)
    assert (view.speed_radps, view.tick, view.refused) == (103.0, 1, 0)
    assert view.change_nms == pytest.approx(3.0 * 2e-4)
    assert momentum_nms(view, WHEEL) == pytest.approx(103.0 * 2e-4)


def test_the_first_report_is_no_change():
    view = after(300.0)
    assert (view.change_nms, view.has_speed) == (0.0, True)


@pytest.mark.parametrize(
    "readings", [measured(), reported(1e4), reported(104.0, valid=0)], ids=["lost", "beyond", "invalid"]
)
def test_a_change_counts_once_and_not_again_where_no_report_follows(readings):
    moved = after(100.0, 103.0)
    assert moved.change_nms > 0.0
    view = then(update_view, moved, readings, 2, WHEEL)
    assert (view.change_nms, view.speed_radps, view.tick) == (0.0, 103.0, 1)


def test_what_is_missed_is_taken_with_the_next_report():
    view = after(100.0, None, None)
    assert (view.change_nms, view.speed_radps, view.tick) == (0.0, 100.0, 0)
    assert then(update_view, view, reported(110.0), 3, WHEEL).change_nms == pytest.approx(10.0 * 2e-4)


@pytest.mark.parametrize("speed_radps", [nan, inf, 751.0, -751.0])
def test_a_report_beyond_the_range_is_refused(speed_radps):
    view = after(speed_radps)
    assert (view.tick, view.refused, view.has_speed) == (-1, 1, False)
    assert momentum_nms(view, WHEEL) is None


def test_one_that_says_it_is_not_valid_is_refused():
    view = then(update_view, after(100.0), reported(101.0, valid=0), 1, WHEEL)
    assert (view.tick, view.refused, view.change_nms) == (0, 1, 0.0)


REACH_RADPS = 1.25 * (2e-3 + 2e-7 * 600.0 + 2e-5) * 0.5 / 2e-4 + 0.2
"""In a tick: by motor and friction, and the margin."""


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("ticks", [1, 4])
def test_a_report_out_of_reach_since_the_last_one_is_refused(sign, ticks):
    lost = [None] * (ticks - 1)
    reach = 0.2 + ticks * (REACH_RADPS - 0.2)
    assert after(100.0, *lost, 100.0 + sign * 0.999 * reach).refused == 0
    view = after(100.0, *lost, 100.0 + sign * 1.001 * reach)
    assert (view.refused, view.speed_radps, view.change_nms) == (1, 100.0, 0.0)


def test_after_too_long_without_one_the_next_within_the_range_counts_again():
    """And its change is the whole of it, which the body has felt."""
    kept = after(100.0, *[None] * 20)
    assert momentum_nms(kept, WHEEL) is not None
    gone = then(update_view, kept, measured(), 21, WHEEL)
    assert gone.tick == -1
    assert momentum_nms(gone, WHEEL) is None
    back = then(update_view, gone, reported(-400.0), 22, WHEEL)
    assert (back.tick, back.refused) == (22, 0)
    assert back.change_nms == pytest.approx(-500.0 * 2e-4)


class TestFilter:
    def test_it_gets_the_mean_momentum_and_the_torque_of_its_change(self):
        motion = wheel_motion(after(100.0, 103.0), 1, 1, WHEEL)
        mean, rate = 101.5 * 2e-4, 3.0 * 2e-4 / 0.5
        assert motion.momentum_nms == pytest.approx([mean * part for part in AXIS])
        assert motion.reaction_nm == pytest.approx([-rate * part for part in AXIS])

    def test_over_ticks_that_were_skipped_the_torque_is_the_mean(self):
        view = then(update_view, after(100.0), reported(106.0), 3, WHEEL)
        rate = 6.0 * 2e-4 / 1.5
        assert wheel_motion(view, 3, 3, WHEEL).reaction_nm == pytest.approx([-rate * part for part in AXIS])

    def test_without_a_report_the_momentum_is_the_last_one_and_what_was_asked_for_in_doubt(self):
        view = then(update_view, replace(after(100.0), requested_nm=-1e-3), measured(), 1, WHEEL)
        motion, sure = wheel_motion(view, 1, 1, WHEEL), wheel_motion(after(100.0, 100.0), 1, 1, WHEEL)
        assert motion.momentum_nms == sure.momentum_nms
        assert motion.reaction_nm == sure.doubted_nms == (0.0, 0.0, 0.0)
        assert motion.doubted_nms == pytest.approx([1e-3 * 0.5 * part for part in AXIS])

    def test_of_a_change_that_was_reported_half_a_percent_is_in_doubt(self):
        motion = wheel_motion(after(100.0, 103.0), 1, 1, WHEEL)
        assert motion.doubted_nms == pytest.approx([0.005 * 3.0 * 2e-4 * part for part in AXIS])


def asked(torque_nm, speed_radps=0.0):
    """The view after a request for this torque, and the request."""
    view = after(speed_radps)
    return view, request(view, Demand(wheel_torque_nm=torque_nm), 0, WHEEL)


class TestRequest:
    @pytest.mark.parametrize(
        "demand", [None, Demand((1.0, 2.0, 3.0)), Demand(wheel_torque_nm=nan), Demand(wheel_torque_nm=inf)]
    )
    def test_nothing_is_asked_for_without_a_demand(self, demand):
        view = replace(after(100.0), requested_nm=1e-3)
        assert request(view, demand, 0, WHEEL) is None
        assert view.requested_nm == 0.0

    def test_nothing_while_its_momentum_is_not_known(self):
        view = WheelView()
        assert request(view, Demand(wheel_torque_nm=1e-3), 0, WHEEL) is None
        assert view.requested_nm == 0.0

    @pytest.mark.parametrize("speed_radps", [250.0, -250.0, 0.5])
    def test_friction_is_added(self, speed_radps):
        view, message = asked(3e-4, speed_radps)
        friction = 2e-7 * speed_radps + 2e-5 * speed_radps / sqrt(speed_radps**2 + 1.0)
        assert friction_nm(speed_radps, WHEEL) == pytest.approx(friction)
        assert message.values() == (pytest.approx(3e-4 + friction), 0, 0)
        assert view.requested_nm == message.torque

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_never_more_than_the_board_takes_on_the_wire_too(self, sign):
        _, message = asked(sign * 1.0)
        on_wire = WheelTorque.decode(message.encode().data)
        assert abs(on_wire.torque) <= WHEEL.max_torque_nm
        assert on_wire.torque == pytest.approx(sign * WHEEL.max_torque_nm, abs=2.0 * UNIT_NM)

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_a_full_wheel_is_not_sped_up(self, sign):
        assert asked(sign * 1e-3, sign * 600.0)[1].torque == 0.0
        assert asked(-sign * 1e-3, sign * 600.0)[1].torque * sign < -8e-4
        assert asked(sign * 1e-3, sign * 599.0)[1].torque * sign > 1e-3

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    @pytest.mark.parametrize("slowing_nm", [0.0, 5e-5])
    def test_nor_is_the_friction_of_a_full_wheel_made_up_for(self, sign, slowing_nm):
        """It slows the wheel by more than is asked; the board refuses what would speed it up."""
        assert friction_nm(600.0, WHEEL) > slowing_nm
        assert asked(-sign * slowing_nm, sign * 600.0)[1].torque == 0.0


def test_every_number_of_the_view_counts_in_the_checksum(blind_places):
    assert blind_places(WheelView(3.0, 7, 0.25, -0.5, 2, has_speed=True)) == []
