"""Proof of the scheduler by exhaustion: every state that it and the coil driver can reach together.

Both together keep the limits whatever is lost and whoever restarts, and so does each one alone: the interlock
under a scheduler that holds nothing back, the scheduler over a board that refuses nothing. As long as nothing
is lost nothing is refused, and a coil that may fire does, as soon as the scheduler is told so.

That the search has teeth is shown by planting bugs in both: each must be found.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import partial
from types import ModuleType

import pytest

from fsw.core.actuation import actuator, pulses
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils import interlock

SHARED, PER_COIL = True, False
BOTH = (SHARED, PER_COIL)
Planting = Callable[[pytest.MonkeyPatch], None]


def around(module: ModuleType, name: str, change: Callable) -> Planting:
    """A bug in a function: ``change`` is called in its place, with it and its arguments."""
    return lambda patch: patch.setattr(module, name, partial(change, getattr(module, name)))


# --- the scheduler: its own timers


def booting(first_of: Callable) -> Planting:
    """When the own timers run out after boot: ``first_of(tick, config)``, by coil."""

    def wrong(boot, tick, config):
        state = boot(tick, config)
        state.ready_tick = first_of(tick, config)
        return state

    return around(pulses, "boot", wrong)


def end_of_pulse(tick, config):
    return tick + config.pulse_ticks


def end_of_backoff(tick, config):
    return tick + config.pulse_ticks + config.backoff_ticks


def that_fired(coil, pulse, config):
    return config.shared or coil == pulse.coil


def firing(
    again_at: Callable = end_of_backoff, backs_off: Callable = that_fired, busy_until: Callable = end_of_pulse
) -> Planting:
    """What a pulse does to the own timers: when coils may fire again, which ones wait, when it is over."""

    def wrong(fire, state, pulse, paid_body_nms, tick, config):
        ready_tick = tuple(
            again_at(tick, config) if backs_off(coil, pulse, config) else before
            for coil, before in enumerate(state.ready_tick)
        )
        fire(state, pulse, paid_body_nms, tick, config)
        state.ready_tick, state.busy_until = ready_tick, busy_until(tick, config)

    return around(pulses, "fire", wrong)


def choosing(seen: Callable) -> Planting:
    """What the choice of a pulse sees of the own timers: ``seen(state)``."""
    return around(pulses, "choose", lambda choose, state, *rest: choose(seen(state), *rest))


# --- the scheduler: the board's word, and the request


def hearing(lockout_of: Callable) -> Planting:
    """What is taken for the board's lockouts after a status: ``lockout_of(after, before, status)``."""

    def wrong(update_view, view, readings, tick, config):
        before = view.lockout_ms if not readings.coil_booted else actuator.LOCKOUT_UNKNOWN
        update_view(view, readings, tick, config)
        if readings.coil is not None:
            view.lockout_ms = tuple(lockout_of(view.lockout_ms, before, readings.coil))

    return around(actuator, "update_view", wrong)


def with_coil(lockout_ms, coil, value):
    return (*lockout_ms[:coil], value, *lockout_ms[coil + 1 :])


def asking_the_word(seen: Callable) -> Planting:
    """What the decision to fire sees of the board's word: ``seen(lockouts)``."""

    def wrong(pulse, state, view, *rest):
        word, view.lockout_ms = view.lockout_ms, seen(view.lockout_ms)
        request = pulse(state, view, *rest)
        view.lockout_ms = word
        return request

    return around(actuator, "_pulse", wrong)


def requesting(change: Callable) -> Planting:
    """What is asked: ``change(request, view)``."""

    def wrong(pulse, state, view, *rest):
        before = copy(view)
        request = pulse(state, view, *rest)
        return request and change(request, before)

    return around(actuator, "_pulse", wrong)


NO_TIMERS = (
    booting(lambda tick, config: (tick,) * 3),
    firing(again_at=lambda tick, config: tick, busy_until=lambda tick, config: tick),
)
WORD_IGNORED = asking_the_word(lambda lockouts: (0, 0, 0))
WORD_FORGOTTEN = hearing(lambda after, before, status: with_coil(after, status.coil, 0))
UNBRIDLED = (*NO_TIMERS, WORD_IGNORED, WORD_FORGOTTEN)
"""A scheduler that asks for whatever is demanded, whenever it is."""


# --- the board


def without(*reasons: Reason) -> Planting:
    """An interlock that does not refuse for these reasons."""
    rules = tuple(rule for rule in interlock._REFUSED_IF if rule[0] not in reasons)
    return lambda patch: patch.setattr(interlock, "_REFUSED_IF", rules)


def unlocked(accept, state, asked, limits):
    """An accepted request locks out no coil that it would."""
    accept(state, asked, limits)
    state.lockout = (0, 0, 0) if limits.shared else with_coil(state.lockout, asked.coil, 0)


TOOTHLESS = (without(Reason.LOCKOUT, Reason.COIL_ON, Reason.BAD_DURATION),)
"""A board that does what it is asked, and still tells for how long it should not."""

NO_LOCKOUT = (
    around(interlock, "accept", unlocked),
    around(interlock, "boot", lambda boot, limits: replace(boot(limits), lockout=(0, 0, 0))),
)


def both_together(setup, *bugs):
    return setup._replace(bugs=bugs)


def without_faults(setup, *bugs):
    return setup._replace(bugs=bugs, faults=False, board_restarts=False)


def with_restarts_of_the_board(setup, *bugs):
    """It restarts at any time, and all that it says is heard."""
    return setup._replace(bugs=bugs, faults=False)


def scheduler_alone(setup, *bugs):
    """The board refuses nothing, but what it says of its lockout, if it is heard, is true."""
    return setup._replace(bugs=(*bugs, *TOOTHLESS))


def own_timers_alone(setup, *bugs):
    """No timer outlives a restart, so that one inside a pulse is left to the board's word."""
    left_out = (WORD_IGNORED, WORD_FORGOTTEN, *TOOTHLESS, *NO_LOCKOUT)
    return setup._replace(bugs=(*bugs, *left_out), restart_in_pulse=False)


def interlock_alone(setup):
    return setup._replace(bugs=UNBRIDLED)


def cases(rows):
    """One test for each kind of back-off that a row is for; the row's last column says which."""
    return [
        pytest.param(*row[:-1], shared, id=f"{name}, {'shared' if shared else 'per coil'}")
        for name, row in rows.items()
        for shared in row[-1]
    ]


CLAIMS = {
    "scheduler alone": (scheduler_alone, BOTH),
    "own timers alone": (own_timers_alone, BOTH),
    "interlock alone": (interlock_alone, BOTH),
    "both together": (both_together, BOTH),
}


@pytest.mark.long
@pytest.mark.interpreted
@pytest.mark.parametrize(("claim", "shared"), cases(CLAIMS))
def test_no_reachable_state_breaks_a_limit(search, small, claim, shared, record_testsuite_property):
    setup = claim(small[shared])
    proof = search(setup)
    record_testsuite_property(f"worlds, {claim.__name__}, shared={shared}", len(proof.worlds))
    assert len(proof.worlds) > 2000
    assert set(proof.accepted) == {0, 1, 2}, "every coil was fired"
    assert (proof.restarts_in_pulse > 0) is setup.restart_in_pulse


@pytest.mark.long
@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
@pytest.mark.slow
def test_whatever_has_happened_a_demanded_coil_fires_once_messages_arrive_again(search, small, shared):
    """A back-off after the end of the last pulse, and at most two ticks until the board tells of the coil."""
    setup = both_together(small[shared])
    proof = search(setup)
    assert proof.refused, "also after a pulse that the scheduler counts and the board has refused"
    assert {world for world, _ in proof.clean} == proof.worlds
    assert [proof.wait(coil) for coil in range(3)] == [setup.pulse_ticks + setup.backoff_ticks + 1] * 3


def demand_exactness(setup, proof):
    """No refusal, two clocks that agree, and every coil as soon as the board has told of it."""
    assert not proof.refused
    for world in proof.worlds:
        assert tuple(1000 * ticks for ticks in world.own.ready) == world.board.lockout
        assert 1000 * world.own.busy == world.board.remaining
    assert [proof.wait(coil) for coil in range(3)] == [setup.pulse_ticks + setup.backoff_ticks + 1] * 3


@pytest.mark.parametrize(
    ("shared", "pulse_ticks", "backoff_ticks"),
    [(SHARED, 3, 7), (SHARED, 3, 100), (PER_COIL, 2, 4), (PER_COIL, 3, 9)],
)
def test_without_faults_nothing_is_refused_the_clocks_agree_and_every_coil_fires_in_time(
    search, small, shared, pulse_ticks, backoff_ticks
):
    """The second row is a pulse and a back-off as flown at 1 Hz."""
    limits = small[shared]._replace(pulse_ticks=pulse_ticks, backoff_ticks=backoff_ticks)
    setup = without_faults(limits)
    demand_exactness(setup, search(setup))


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
def test_a_board_that_restarts_and_is_heard_refuses_nothing_and_fires_again(search, small, shared):
    """Within a back-off after it, and at most two ticks until it tells of the coil."""
    setup = with_restarts_of_the_board(small[shared])
    proof = search(setup)
    assert not proof.refused
    assert len({world.board.lockout for world in proof.worlds if world.new}) == 1, "locked out in full"
    longest = setup.pulse_ticks + setup.backoff_ticks + 1
    assert all(proof.wait(coil) <= longest for coil in range(3))


@pytest.mark.interpreted
@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
def test_a_scheduler_that_does_not_hear_of_the_restart_is_refused(search, small, shared):
    def without_the_boot(update_view, view, measurements, *rest):
        heard = copy(measurements)
        heard.coil_booted = False
        return update_view(view, heard, *rest)

    deaf = around(actuator, "update_view", without_the_boot)
    assert search(with_restarts_of_the_board(small[shared], deaf)).refused


PULSE_A_TICK_LONG = requesting(lambda asked, view: asked.replace(duration_ms=asked.duration_ms + 1000))
BACKOFF_A_TICK_SHORT = firing(again_at=lambda tick, config: end_of_backoff(tick, config) - 1)


UNSAFE = {
    "back-off a tick short": (own_timers_alone, BACKOFF_A_TICK_SHORT, BOTH),
    "back-off from the start of the pulse": (
        own_timers_alone,
        firing(again_at=lambda tick, config: tick + config.backoff_ticks),
        BOTH,
    ),
    "back-off a tick short at boot": (
        own_timers_alone,
        booting(lambda tick, config: (tick + config.backoff_ticks - 1,) * 3),
        BOTH,
    ),
    "a coil forgotten at boot": (
        own_timers_alone,
        booting(lambda tick, config: (*(tick + config.backoff_ticks,) * 2, tick)),
        BOTH,
    ),
    "shared taken for per coil": (
        own_timers_alone,
        firing(backs_off=lambda coil, pulse, config: coil == pulse.coil),
        (SHARED,),
    ),
    "another coil backs off": (
        own_timers_alone,
        firing(backs_off=lambda coil, pulse, config: coil != pulse.coil),
        (PER_COIL,),
    ),
    "own timers not asked": (
        own_timers_alone,
        choosing(lambda state: replace(state, ready_tick=(0, 0, 0))),
        BOTH,
    ),
    "own timers asked a tick early": (
        own_timers_alone,
        choosing(lambda state: replace(state, ready_tick=tuple(ready - 1 for ready in state.ready_tick))),
        BOTH,
    ),
    "a pulse into another": (
        own_timers_alone,
        choosing(lambda state: replace(state, busy_until=0)),
        (PER_COIL,),
    ),
    "a pulse a tick long": (own_timers_alone, PULSE_A_TICK_LONG, BOTH),
    "word not asked": (scheduler_alone, WORD_IGNORED, BOTH),
    "no word taken for a good one": (
        scheduler_alone,
        asking_the_word(lambda lockouts: tuple(max(0, lockout_ms) for lockout_ms in lockouts)),
        BOTH,
    ),
    "word on another coil": (
        scheduler_alone,
        asking_the_word(lambda lockouts: (lockouts[2], lockouts[0], lockouts[1])),
        (PER_COIL,),
    ),
}


@pytest.mark.long
@pytest.mark.interpreted
@pytest.mark.parametrize(("claim", "bug", "shared"), cases(UNSAFE))
def test_a_planted_danger_is_seen_in_what_is_driven(search, small, claim, bug, shared):
    setup = claim(small[shared], bug)
    with pytest.raises(AssertionError, match=r"ticks|two coils"):
        search(setup)


@pytest.mark.interpreted
@pytest.mark.long
@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
@pytest.mark.parametrize("own_timers", [True, False], ids=["with own timers", "without"])
def test_a_lockout_that_neither_side_checks_is_seen(search, small, own_timers, shared):
    bugs = (WORD_IGNORED,) if own_timers else (WORD_IGNORED, *NO_TIMERS)
    setup = both_together(small[shared], *bugs, without(Reason.LOCKOUT))
    with pytest.raises(AssertionError, match="ticks between two pulses"):
        search(setup)


INEXACT = {
    "a pulse a tick long": (PULSE_A_TICK_LONG, BOTH),
    "back-off a tick short": (BACKOFF_A_TICK_SHORT, BOTH),
    "back-off a tick long": (firing(again_at=lambda tick, config: end_of_backoff(tick, config) + 1), BOTH),
    "back-off a tick long at boot": (
        booting(lambda tick, config: (tick + config.backoff_ticks + 1,) * 3),
        BOTH,
    ),
    "per coil taken for shared": (firing(backs_off=lambda coil, pulse, config: True), (PER_COIL,)),
    "busy for a tick too long": (
        firing(busy_until=lambda tick, config: end_of_pulse(tick, config) + 1),
        BOTH,
    ),
    "seq repeated": (requesting(lambda asked, view: asked.replace(seq=view.seq)), BOTH),
    "another tick answered": (requesting(lambda asked, view: asked.replace(tick=asked.tick - 1)), BOTH),
    "a coil left out": (
        around(
            pulses,
            "choose",
            lambda choose, *asked: choose(*asked[:-1], faults=(0, 0, 1)),
        ),
        BOTH,
    ),
    "word never good": (asking_the_word(lambda lockouts: (1, 1, 1)), BOTH),
    "word on one coil kept for another": (
        hearing(lambda after, before, status: with_coil(before, 0, status.lockout_ms)),
        BOTH,
    ),
}


@pytest.mark.long
@pytest.mark.interpreted
@pytest.mark.parametrize(("bug", "shared"), cases(INEXACT))
def test_a_planted_bug_is_seen(search, small, bug, shared):
    setup = without_faults(small[shared], bug)
    with pytest.raises(AssertionError):
        demand_exactness(setup, search(setup))


@pytest.mark.interpreted
def test_a_planting_that_changes_nothing_passes(search, small):
    """What is found is the bug, not the planting."""
    nothing = (
        booting(lambda tick, config: (tick + config.backoff_ticks,) * 3),
        firing(),
        choosing(lambda state: state),
        hearing(lambda after, before, status: after),
        asking_the_word(lambda lockouts: lockouts),
        requesting(lambda asked, view: asked),
    )
    setup = without_faults(small[SHARED], *nothing)
    demand_exactness(setup, search(setup))
