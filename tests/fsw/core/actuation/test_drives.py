"""What the coils drove since the tick before, and how far it is in doubt."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from actuator_samples import then
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView, update_view
from fsw.core.actuation.dipoles import DipoleConfig, RequestedDipole
from fsw.core.actuation.drives import find_drives
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.wire.messages import CoilDipoleStatus, CoilStatus

ZERO = (0.0, 0.0, 0.0)
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TICK = 10_000
FIRED = CoilView((0, 0, 0), fired_tick=TICK, fired=Pulse(1, -3))
ASKED_AM2 = (0.0, -8.0, 0.0)
DOUBTED_AM2 = pytest.approx((0.0, -8.0 * sqrt(3.0), 0.0))
UNKNOWN = (ASKED_AM2, DOUBTED_AM2)


def pairs(drives):
    """Dipole and doubt of each tick."""
    return [(one.m_body_am2, one.doubted_am2) for one in drives]


@pytest.fixture(scope="module")
def coils(make_world):
    """At 1 Hz: pulses of 3 s, levels of 0.5, 2 and 8 A m^2."""
    return make_world().config.coils


@pytest.fixture(scope="module")
def drives(coils):
    """Those up to so many ticks after the request, with what the board says, if it does."""

    def over(ticks_after, status=None, skipped=0, view=FIRED):
        tick = TICK + ticks_after
        after = then(update_view, view, measured(coil=status), tick, coils)
        ticks = range(tick - skipped, tick + 1)
        return pairs(find_drives(after, after.driven_am2, status is not None, ticks, coils))

    return over


def says(coil, level):
    return CoilStatus(level, coil, 0, 0, 0, 0)


@pytest.mark.parametrize(("ticks_after", "level"), [(0, 0), (1, -3), (2, -3), (3, -3), (4, 0)])
def test_what_is_reported_as_it_was_asked_for_is_certain(drives, ticks_after, level):
    (now,) = drives(ticks_after, says(1, level))
    assert now == ((0.0, -8.0 if level else 0.0, 0.0), ZERO)


@pytest.mark.parametrize("ticks_after", [1, 2, 3])
def test_without_a_report_all_that_was_asked_for_is_in_doubt(drives, ticks_after):
    assert drives(ticks_after) == [UNKNOWN]


@pytest.mark.parametrize("ticks_after", [0, 4, 100])
def test_without_a_report_and_a_request_under_way_nothing_is(drives, ticks_after):
    assert drives(ticks_after) == [(ZERO, ZERO)]
    assert drives(ticks_after, view=CoilView()) == [(ZERO, ZERO)]


@pytest.mark.parametrize(
    ("ticks_after", "said", "driven_am2", "off_am2"),
    [
        (2, (1, 0), ZERO, (0.0, -8.0, 0.0)),
        (2, (1, -2), (0.0, -2.0, 0.0), (0.0, -6.0, 0.0)),
        (2, (0, 1), (0.5, 0.0, 0.0), (-0.5, -8.0, 0.0)),
        (4, (1, -3), ASKED_AM2, (0.0, 8.0, 0.0)),
        (50, (2, 2), (0.0, 0.0, 2.0), (0.0, 0.0, -2.0)),
    ],
    ids=["not driven", "lower", "another coil", "of a tick before", "not asked for"],
)
def test_a_report_of_something_else_is_in_doubt_by_the_difference(
    drives, ticks_after, said, driven_am2, off_am2
):
    ((m_body_am2, doubted_am2),) = drives(ticks_after, says(*said))
    assert m_body_am2 == driven_am2
    assert doubted_am2 == pytest.approx([sqrt(3.0) * number for number in off_am2])


def test_a_request_goes_on_in_ticks_that_were_skipped(drives):
    off = (ZERO, ZERO)
    assert drives(6, says(1, 0), skipped=6) == [off, UNKNOWN, UNKNOWN, UNKNOWN, off, off, off]
    assert drives(3, says(1, -3), skipped=1) == [UNKNOWN, (ASKED_AM2, ZERO)]
    assert drives(3, skipped=2) == [UNKNOWN, UNKNOWN, UNKNOWN]


@pytest.mark.parametrize("unknown_ticks", [(1,), (1, 2), (1, 2, 3)])
def test_whatever_ticks_of_a_pulse_are_unknown_their_sum_is_in_doubt_by_no_less(drives, unknown_ticks):
    """The filter adds up squares, as of ticks that have nothing to do with each other."""
    doubts = [drives(ticks_after)[0][1] for ticks_after in unknown_ticks]
    assert np.linalg.norm(doubts) >= 8.0 * len(unknown_ticks) * (1.0 - 1e-12)


def test_a_stray_current_that_the_filter_knows_of_is_no_doubt(coils):
    now = find_drives(FIRED, (0.3, 0.0, 0.0), True, range(TICK + 50, TICK + 51), coils)
    assert pairs(now) == [((0.3, 0.0, 0.0), ZERO)]


def test_it_flows_in_skipped_ticks_too(coils):
    """For minutes as a rule: without it the filter would find the rate changed by nothing."""
    stray_am2 = (0.3, 0.0, -0.1)
    skipped = find_drives(FIRED, stray_am2, True, range(TICK + 50, TICK + 53), coils)
    assert pairs(skipped) == [(stray_am2, ZERO)] * 3
    under_way, off, _ = pairs(find_drives(FIRED, stray_am2, True, range(TICK + 3, TICK + 6), coils))
    assert under_way == ((0.3, -8.0, -0.1), DOUBTED_AM2)
    assert off == (stray_am2, ZERO)


class TestContinuousDriver:
    """It reports dipoles and has no pulses; a request is for one tick."""

    WANTED_AM2 = (4.8, -2.4, 1.2)
    SAYS = CoilDipoleStatus(0.5, -0.25, 0.125)
    IN_DOUBT = (WANTED_AM2, WANTED_AM2)
    OFF = (ZERO, ZERO)

    @pytest.fixture
    def drives(self, coils):
        """As those of pulses, after a request for ``WANTED_AM2``."""
        continuous = replace(coils, dipoles=DipoleConfig(9.6, IDENTITY, genetic=False))

        def over(ticks_after, status=None, skipped=0, asked_am2=self.WANTED_AM2):
            tick, view = TICK + ticks_after, CoilView(requested=RequestedDipole(TICK, asked_am2))
            after = then(update_view, view, measured(dipole=status), tick, continuous)
            return pairs(
                find_drives(after, after.driven_am2, True, range(tick - skipped, tick + 1), continuous)
            )

        return over

    def test_what_is_reported_as_it_was_asked_for_is_certain(self, drives):
        assert drives(1, self.SAYS) == [(self.WANTED_AM2, ZERO)]
        assert drives(2, CoilDipoleStatus(0.0, 0.0, 0.0)) == [self.OFF]

    def test_without_a_report_all_that_was_asked_for_is_in_doubt(self, drives):
        assert drives(1) == [self.IN_DOUBT]
        assert drives(2) == [self.OFF]

    def test_a_report_of_something_else_is_in_doubt_by_the_difference(self, drives):
        ((m_body_am2, doubted_am2),) = drives(1, CoilDipoleStatus(0.25, -0.25, 0.125))
        assert m_body_am2 == pytest.approx((2.4, -2.4, 1.2))
        assert doubted_am2 == pytest.approx((2.4, 0.0, 0.0))

    def test_in_ticks_that_were_skipped_only_the_first_was_asked_for(self, drives):
        assert drives(3, CoilDipoleStatus(0.0, 0.0, 0.0), skipped=2) == [self.IN_DOUBT, self.OFF, self.OFF]
        assert drives(3, skipped=2) == [self.IN_DOUBT, self.OFF, self.OFF]
