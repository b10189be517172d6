"""The scheduler joined to the coil driver's word: when a pulse goes out, and what is owed after a refusal."""

from dataclasses import replace
from itertools import product
from math import inf

import pytest
from actuator_samples import (
    ALL_FREE,
    B_BODY_T,
    BOARD_IS_THERE,
    COILS,
    CONFIG,
    OWED_FOR,
    TICK,
    ZERO,
    answered,
    make_config,
    ready,
    refusal,
    run,
    run_safe,
    status,
    then,
)
from gate_samples import measured
from hypothesis import event, given, settings
from hypothesis import strategies as st

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import OF_ANY_FRAME, CoilView, update_view
from fsw.core.laws.interface import Demand
from fsw.core.laws.plan.pulse_model import NO_PULSE, Pulse
from fsw.wire.messages import CoilBoot, CoilFire, CoilRefused, CoilRefusedReason


def test_after_a_boot_of_the_board_nothing_goes_out_before_its_word_is_heard():
    view = then(update_view, ALL_FREE, measured(coil_boot=CoilBoot(1, 1, 7), coil=status(1)), TICK, COILS)
    state, view, request = run(view=view)
    assert request is None, "coil 0 is what is wanted"
    view = then(update_view, view, measured(coil=status(0)), TICK + 1, COILS)
    assert run(state, view, tick=TICK + 1)[2].coil == 0


# When a pulse goes out


WANTED = {
    "owed": (ready(), Demand(), OWED_FOR[0]),
    "missed": (ready(ZERO), Demand(impulse_body_nms=OWED_FOR[0]), ZERO),
}
"""What leads to the highest pulse of coil 0: state, demand, and what of it is owed and then paid."""


@pytest.mark.parametrize("kind", WANTED)
def test_the_request_names_pulse_answer_and_length_and_is_remembered(kind):
    state, demand, paid = WANTED[kind]
    state, view, request = run(state, replace(ALL_FREE, seq=41), demand, tick=0x1234)
    assert request == CoilFire(level=3, coil=0, seq=42, tick=0x1234, duration_ms=3000)
    assert CoilFire.decode(request.encode().data).tick == 0x34
    assert (view.fired_tick, view.fired) == (0x1234, Pulse(0, 3))
    assert view.paid_body_nms == pytest.approx(paid)
    assert state.ready_tick == (0x1234 + 103,) * 3
    assert state.busy_until == 0x1234 + 3


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_every_coil_is_fired_unless_it_has_a_fault(coil):
    b_body_t = (2e-5, 2e-5, 2e-5)
    owed = pulses.impulse(Pulse(coil, 3), b_body_t, CONFIG)
    asked = (ready(owed), ALL_FREE, Demand(), b_body_t, BOARD_IS_THERE, TICK, COILS)
    _, _, request = answered(*asked)
    assert request.coil == coil
    _, _, other = answered(*asked, tuple(int(number == coil) for number in range(3)))
    assert other is None or other.coil != coil


def test_the_length_is_that_of_the_table():
    config = replace(CONFIG, pulse_ticks=2, duration_ms=1900)
    state, _, request = run(config=config)
    assert request.duration_ms == 1900
    assert state.busy_until == TICK + 2


def test_a_pulse_is_paid_when_it_is_asked_for():
    state, _, request = run()
    assert request is not None
    keep = 1.0 - 1.0 / 300.0
    assert state.pending_impulse_body_nms == pytest.approx((0.0, (1.0 - keep) * 4.8e-4, 0.0))


def test_the_torque_of_the_demanded_dipole_is_owed():
    """T = m x b: 0.5 A m^2 along axis 1 in 20 uT along axis 3 turn about axis 2."""
    state, _, request = run(ready(ZERO), demand=Demand((0.5, 0.0, 5.0)), readings=measured())
    assert request is None
    assert state.pending_impulse_body_nms == pytest.approx((0.0, -1e-5, 0.0))


@pytest.mark.parametrize(("asked_am2", "fires"), [(0.0140, False), (0.0145, True), (-0.0145, True)])
def test_a_pulse_goes_out_when_more_than_half_of_the_lowest_is_due(asked_am2, fires):
    """Half of 3 s and 0.5 A m^2, of which 1 s of the demand is owed and 51.5 s are to come."""
    state, _, request = run(ready(ZERO), demand=Demand((asked_am2, 0.0, 0.0)))
    assert (request is not None) is fires
    if fires:
        assert (request.coil, abs(request.level)) == (0, 1)
        assert request.level * asked_am2 > 0.0
        paid = 3.0 * 0.5 if asked_am2 > 0.0 else -3.0 * 0.5
        assert state.pending_impulse_body_nms == pytest.approx((0.0, 2e-5 * (paid - asked_am2), 0.0))


@pytest.mark.parametrize(("coil", "lockout_ms"), list(product((0, 1), product((-1, 0, 163_830), repeat=3))))
def test_a_pulse_goes_out_only_if_the_word_on_exactly_its_coil_is_zero(coil, lockout_ms):
    """Whatever the word on the others; and no other coil is taken in its place."""
    owed = OWED_FOR[coil]
    state, view, request = run(ready(owed), replace(ALL_FREE, lockout_ms=lockout_ms))
    if lockout_ms[coil] == 0:
        assert request.coil == coil
    else:
        assert request is None
        assert state == then(pulses.owe, ready(owed), ZERO, B_BODY_T, CONFIG), (
            "it stays owed, and no timer is set"
        )
        assert view.fired_tick == -1


def test_a_pulse_waits_for_a_tick_with_a_status():
    state, view, request = run(readings=measured())
    assert request is None
    assert state == then(pulses.owe, ready(), ZERO, B_BODY_T, CONFIG)
    assert view == ALL_FREE


def test_a_board_that_is_free_does_not_shorten_the_own_timers():
    locked = replace(ready(), ready_tick=(TICK + 1,) * 3)
    assert run(locked)[2] is None
    assert run(locked, tick=TICK + 1)[2] is not None


# Impulses


def test_an_impulse_is_met_anew_in_each_tick_and_nothing_of_it_is_owed():
    """Neither what was owed before nor what no pulse could pay: the law will ask again."""
    beyond = Demand(impulse_body_nms=(0.0, -4.0 * 8.0 * 2e-5, 0.0))
    state, _, request = run(ready(OWED_FOR[1]), demand=beyond)
    assert (request.coil, request.level) == (0, 3)
    assert state.pending_impulse_body_nms == ZERO
    state, _, request = run(ready(OWED_FOR[1]), demand=Demand(impulse_body_nms=ZERO))
    assert request is None
    assert state.pending_impulse_body_nms == ZERO


def test_the_energy_chooses_where_an_impulse_is_missed_and_the_rate_where_it_is_owed():
    """By the energy a turn about axis 1 weighs nine times as much; by the rate of this body both alike."""
    impulse = (0.7 * 3.0 * 8.0 * 2e-5, -3.0 * 8.0 * 2e-5, 0.0)
    assert run(ready(impulse))[2].coil == 0
    assert run(ready(ZERO), demand=Demand(impulse_body_nms=impulse))[2].coil == 1


# Refusals


def refused_at(ticks_later, of_tick=TICK):
    """What is owed, and the view, after a request that was refused as one of ``of_tick``; nothing leaks."""
    config = replace(CONFIG, leak_s=inf)
    state, view, request = run(config=config)
    assert request is not None
    assert state.pending_impulse_body_nms == pytest.approx(ZERO, abs=1e-18)
    readings = measured(coil=status(0), refused=(refusal(of_tick),))
    state, view, again = run(state, view, readings=readings, tick=TICK + ticks_later, config=config)
    assert again is None, "the own timers run whatever the board did"
    return state, view, config


@pytest.mark.parametrize("ticks_later", [1, 2])
def test_what_a_refused_request_paid_is_owed_again_and_only_once(ticks_later):
    state, view, config = refused_at(ticks_later)
    assert state.pending_impulse_body_nms == pytest.approx(OWED_FOR[0])
    readings = measured(coil=status(0), refused=(refusal(TICK),))
    again, _, _ = run(state, view, readings=readings, tick=TICK + ticks_later + 1, config=config)
    assert again.pending_impulse_body_nms == state.pending_impulse_body_nms


def test_a_refusal_that_is_heard_twice_gives_back_once():
    """Of a pulse that pays less than may be owed."""
    config = replace(CONFIG, leak_s=inf)
    owed = (0.0, -3.0 * 0.5 * 2e-5, 0.0)
    state, view, request = run(ready(owed), config=config)
    assert abs(request.level) == 1
    readings = measured(coil=status(0), refused=(refusal(TICK),))
    for tick in (TICK + 1, TICK + 2):
        state, view, _ = run(state, view, readings=readings, tick=tick, config=config)
        assert state.pending_impulse_body_nms == pytest.approx(owed)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_refusal_counts_wherever_it_stands_among_others_of_its_tick(place):
    """A node that babbles, or a broken frame, must not hide that the own request was refused."""
    state, view, _ = run(config=replace(CONFIG, leak_s=inf))
    others = [refusal(TICK).replace(coil=1), refusal(TICK - 1)]
    others.insert(place, refusal(TICK))
    readings = measured(coil=status(0), refused=tuple(others))
    state, view, _ = run(state, view, readings=readings, tick=TICK + 1, config=replace(CONFIG, leak_s=inf))
    assert state.pending_impulse_body_nms == pytest.approx(OWED_FOR[0])
    assert view.fired == NO_PULSE


def test_a_request_that_was_refused_does_not_count_as_driven():
    _, view, _ = refused_at(1)
    after = then(update_view, view, measured(), TICK + 2, COILS)
    assert (after.driven_level, after.driven_am2) == (0, ZERO)


@pytest.mark.parametrize(
    ("ticks_later", "of_tick"), [(1, TICK - 1), (1, TICK + 1), (2, TICK + 2), (3, TICK), (256, TICK + 256)]
)
def test_a_refusal_of_another_request_or_one_that_comes_too_late_gives_nothing_back(ticks_later, of_tick):
    state, view, _ = refused_at(ticks_later, of_tick)
    assert state.pending_impulse_body_nms == pytest.approx(ZERO, abs=1e-18)
    assert view.paid_body_nms == pytest.approx(OWED_FOR[0])


def test_a_refusal_before_the_first_request_gives_nothing_back():
    state, _, _ = run(ready(ZERO), readings=measured(coil=status(0), refused=(refusal(255),)), tick=1)
    assert state.pending_impulse_body_nms == ZERO


@pytest.mark.parametrize("seq", [1, 9])
@pytest.mark.parametrize("reason", CoilRefusedReason)
def test_a_request_that_is_reported_as_driven_was_not_refused(seq, reason):
    """Another frame of that tick was: a broken one, a repeated one, or that of another sender."""
    state, view, request = run()
    driven = status(request.coil, level=request.level, seq=request.seq)
    readings = measured(coil=driven, refused=(CoilRefused(request.coil, seq, reason, TICK & 0xFF),))
    view = then(update_view, view, readings, TICK + 1, COILS)
    assert run(state, view, readings=readings, tick=TICK + 1)[1].fired == view.fired


@pytest.mark.parametrize("reason", OF_ANY_FRAME)
def test_a_broken_frame_without_a_status_may_be_any(reason):
    state, view, _ = run()
    lost = measured(refused=(refusal(TICK).replace(reason=reason),))
    assert run(state, view, readings=lost, tick=TICK + 1)[1].fired == view.fired
    off = measured(refused=(refusal(TICK).replace(reason=reason),), coil=status(0))
    assert run(state, view, readings=off, tick=TICK + 1)[1].fired == NO_PULSE


def test_a_refusal_of_another_coil_is_not_of_this_request():
    state, view, _ = run()
    readings = measured(coil=status(0), refused=(refusal(TICK).replace(coil=1),))
    assert run(state, view, readings=readings, tick=TICK + 1)[1].fired == view.fired


def test_a_refused_impulse_is_not_owed():
    """It was never: the law that missed it asks anew."""
    state, view, _ = run(ready(ZERO), demand=Demand(impulse_body_nms=OWED_FOR[0]))
    readings = measured(coil=status(0), refused=(refusal(TICK),))
    state, _, _ = run(state, view, readings=readings, tick=TICK + 1)
    assert state.pending_impulse_body_nms == ZERO


# Without a law


@pytest.mark.parametrize("fresh", [True, False])
@pytest.mark.parametrize("lockout_ms", [(0, 0, 0), (10, -1, 0)])
def test_without_a_law_nothing_is_fired_and_nothing_owed(fresh, lockout_ms):
    """Nor what was owed before; the timers run on."""
    timers = replace(ready(), ready_tick=(TICK - 5, TICK, TICK + 9), busy_until=TICK - 20)
    before = replace(timers, held_am2=(1.0, -2.0, 3.0))
    view = replace(ALL_FREE, lockout_ms=lockout_ms)
    after, found, request = run_safe(before, view, BOARD_IS_THERE if fresh else measured())
    assert request is None
    assert after == replace(timers, pending_impulse_body_nms=ZERO)
    assert found == view


def test_a_refusal_that_comes_while_no_law_flies_is_not_owed_either():
    state, view, _ = run()
    state, view, _ = run_safe(state, view, measured(coil=status(0), refused=(refusal(TICK),)), TICK + 1)
    assert state.pending_impulse_body_nms == ZERO


STRONG = Demand((8.0, 0.0, 0.0))


def test_a_pulse_asked_for_before_safe_still_locks_out_after_it():
    state, view, request = run()
    assert request is not None
    for tick in range(TICK + 1, TICK + 50):
        state, view, request = run_safe(state, view, tick=tick)
        assert request is None
    for tick in range(TICK + 50, TICK + 103):
        state, view, request = run(state, view, STRONG, tick=tick)
        assert request is None
    assert run(state, view, STRONG, tick=TICK + 103)[2] is not None


def test_seq_never_repeats_the_last_accepted_one():
    for accepted in range(256):
        view = then(update_view, ALL_FREE, measured(coil=status(0, seq=accepted)), TICK, COILS)
        _, _, request = run(view=view)
        assert request.seq == (accepted + 1) % 256
        assert CoilFire.decode(request.encode().data).seq != accepted


def test_seq_follows_what_the_board_accepted_not_what_was_asked():
    """A lost request leaves no gap: its number comes again, and the board has never seen it."""
    state, view, request = run(view=replace(ALL_FREE, seq=7))
    assert request.seq == 8
    view = then(update_view, view, measured(coil=status(0, seq=7)), TICK + 1, COILS)
    _, _, again = run(replace(state, pending_impulse_body_nms=OWED_FOR[0]), view, tick=TICK + 103)
    assert again.seq == 8


# Flown by itself over a board that always says that all is free


def starts(shared, tick_hz, coils, ticks):
    """(tick, coil) of each request when each of ``coils`` is demanded in turn, from boot at tick 0."""
    config = make_config(shared, tick_hz)
    state, view, asked = pulses.boot(0, config), ALL_FREE, []
    for tick in range(ticks):
        for coil in coils:
            state = replace(state, pending_impulse_body_nms=OWED_FOR[coil])
            state, view, request = run(state, view, tick=tick, config=config)
            if request is not None:
                asked.append((tick, request.coil))
    return asked


@pytest.mark.long
@pytest.mark.parametrize("tick_hz", [1, 2, 3, 7, 10, 50])
@pytest.mark.slow
def test_with_a_lasting_demand_it_fires_as_often_as_the_limits_let_it(tick_hz):
    """One coil in 103 s: after the boot lockout at 100 s, 203 s, 306 s."""
    for shared in (True, False):
        times = [tick / tick_hz for tick, _ in starts(shared, tick_hz, (0,), 310 * tick_hz)]
        assert times == [100.0, 203.0, 306.0]
    shared = [(tick / tick_hz, coil) for tick, coil in starts(True, tick_hz, (0, 1), 310 * tick_hz)]
    assert shared == [(100.0, 0), (203.0, 0), (306.0, 0)]
    per_coil = [(tick / tick_hz, coil) for tick, coil in starts(False, tick_hz, (0, 1), 310 * tick_hz)]
    assert per_coil == [(100.0, 0), (103.0, 1), (203.0, 0), (206.0, 1), (306.0, 0), (309.0, 1)]


@pytest.mark.long
@settings(max_examples=300)
@given(
    ready_in=st.tuples(*[st.sampled_from((-500, -1, 0, 0, 1, 200))] * 3),
    busy_in=st.sampled_from((-500, -1, 0, 0, 2)),
    lockout_ms=st.tuples(*[st.sampled_from((-1, 0, 0, 10, 100_000))] * 3),
    owed=st.tuples(*[st.floats(-1e-3, 1e-3)] * 3),
    shared=st.booleans(),
    shift=st.integers(1, 2**32 - 20_000),
)
def test_only_how_long_the_timers_still_run_matters(ready_in, busy_in, lockout_ms, owed, shared, shift):
    """Not the tick itself, not how long ago a timer ran out, not how long the board's lockout is."""
    config = make_config(shared)

    def answer(tick, ready_in, busy_in, lockout_ms):
        state = replace(
            ready(owed), ready_tick=tuple(tick + left for left in ready_in), busy_until=tick + busy_in
        )
        view = CoilView(lockout_ms=lockout_ms)
        after, _, request = run(state, view, tick=tick, config=config)
        timers = [max(0, t - tick) for t in (*after.ready_tick, after.busy_until)]
        return timers, after.pending_impulse_body_nms, request and request.replace(tick=0)

    once = answer(TICK, ready_in, busy_in, lockout_ms)
    event("fired" if once[2] else "waited")
    assert once == answer(
        TICK + shift,
        tuple(max(0, left) for left in ready_in),
        max(0, busy_in),
        tuple(min(left, 1) for left in lockout_ms),
    )
