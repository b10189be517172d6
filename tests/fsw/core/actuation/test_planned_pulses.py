"""Pulses that a law has planned, and how long it has to wait for each coil."""

from dataclasses import replace
from itertools import product

import pytest
from actuator_samples import (
    ALL_FREE,
    B_BODY_T,
    BOARD_IS_THERE,
    COILS,
    CONFIG,
    TICK,
    ZERO,
    make_config,
    ready,
    refusal,
    run,
    status,
)
from gate_samples import measured

from fsw.core.actuation.actuator import actuate, wait_ticks
from fsw.core.laws.interface import Demand
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE, Pulse


class TestPlannedPulses:
    """A law that plans pulses says itself which one is fired."""

    @pytest.mark.parametrize(("coil", "level"), list(product(range(3), (-3, -1, 2))))
    def test_are_fired_as_they_are_and_nothing_is_owed(self, coil, level):
        state, view, request = run(ready(), demand=Demand(pulse=Pulse(coil, level)))
        assert (request.coil, request.level, request.tick) == (coil, level, TICK)
        assert state.pending_impulse_body_nms == ZERO
        assert view.fired == Pulse(coil, level)
        assert view.paid_body_nms == ZERO

    def test_none_is_none_whatever_was_owed(self):
        state, _, request = run(ready(), demand=Demand(pulse=NO_PULSE))
        assert request is None
        assert state.pending_impulse_body_nms == ZERO

    @pytest.mark.parametrize("hindrance", ["own timer", "busy", "lockout", "no status", "fault"])
    def test_are_not_fired_before_timer_and_board_agree(self, hindrance):
        state, view, readings, faults = ready(), ALL_FREE, BOARD_IS_THERE, (0, 0, 0)
        if hindrance == "own timer":
            state = replace(state, ready_tick=(0, TICK + 1, 0))
        elif hindrance == "busy":
            state = replace(state, busy_until=TICK + 1)
        elif hindrance == "lockout":
            view = replace(view, lockout_ms=(0, 20, 0))
        elif hindrance == "no status":
            readings = measured()
        else:
            faults = (0, 1, 0)
        demand = Demand(pulse=Pulse(1, 2))
        request = actuate(state, view, demand, B_BODY_T, readings, TICK, COILS, faults)
        assert request is None

    def test_that_are_refused_are_not_owed(self):
        _, view, _ = run(ready(ZERO), demand=Demand(pulse=Pulse(1, 2)))
        readings = measured(coil=status(0), refused=(refusal(TICK).replace(coil=1),))
        after, view, _ = run(ready(ZERO), view, Demand(pulse=NO_PULSE), readings, TICK + 1)
        assert after.pending_impulse_body_nms == ZERO
        assert view.fired == NO_PULSE


class TestWaits:
    """How long each coil has still to be left alone, as far as is known."""

    def waits(self, state, view=ALL_FREE, readings=BOARD_IS_THERE, faults=(0, 0, 0)):
        return wait_ticks(state, view, readings, TICK, CONFIG, faults)

    def test_are_those_of_the_own_timers(self):
        state = replace(ready(), ready_tick=(TICK - 5, TICK + 7, TICK + 40))
        assert self.waits(state) == (0, 7, 40)
        assert self.waits(replace(state, busy_until=TICK + 9)) == (9, 9, 40)

    def test_or_of_the_board_if_longer(self):
        view = replace(ALL_FREE, lockout_ms=(0, 1, 2500))
        assert self.waits(ready(), view) == (0, 1, 3)

    @pytest.mark.parametrize(("tick_hz", "ticks"), [(2, (0, 1, 5)), (10, (0, 1, 25)), (3, (0, 1, 8))])
    def test_of_the_board_are_in_ticks_of_any_length(self, tick_hz, ticks):
        """Rounded up: a coil that is asked too soon refuses."""
        view = replace(ALL_FREE, lockout_ms=(0, 1, 2500))
        config = make_config(tick_hz=tick_hz)
        assert wait_ticks(ready(), view, BOARD_IS_THERE, TICK, config, (0, 0, 0)) == ticks

    def test_are_a_back_off_for_a_coil_of_which_the_board_has_not_spoken(self):
        view = replace(ALL_FREE, lockout_ms=(0, 0, -1))
        assert self.waits(ready(), view) == (0, 0, CONFIG.backoff_ticks)

    def test_are_at_least_a_tick_without_a_status(self):
        assert self.waits(ready(), readings=measured()) == (1, 1, 1)

    def test_have_no_end_with_a_fault(self):
        assert self.waits(ready(), faults=(0, 3, 0)) == (0, NEVER, 0)
