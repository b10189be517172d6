"""Proof of the scheduler by exhaustion: every state that it and the coil driver can reach together.

Both together keep the limits whatever is lost and whoever restarts, and so does each one alone: the interlock
under a scheduler that holds nothing back, the scheduler over a board that refuses nothing. As long as nothing
is lost nothing is refused, and a coil that may fire does, as soon as the scheduler is told so.

That the search has teeth is shown by planting bugs in copies of both: each must be found.
"""

import inspect
import sys
from types import ModuleType

import pytest

from fsw.core.actuation import actuator, pulses
from hil_stub.coils import interlock

SHARED, PER_COIL = True, False
BOTH = (SHARED, PER_COIL)


def planted(module: ModuleType, swaps: list[tuple[str, str]]) -> ModuleType:
    """A copy of the module with pieces of its source replaced; a piece that is not in it is left."""
    source = inspect.getsource(module)
    for old, new in swaps:
        assert source.count(old) <= 1, f"{old!r} stands {source.count(old)} times in {module.__name__}"
        source = source.replace(old, new)
    copy = ModuleType("planted")
    sys.modules[copy.__name__] = copy  # dataclasses look their module up
    try:
        exec(compile(source, "planted", "exec"), copy.__dict__)
    finally:
        del sys.modules[copy.__name__]
    return copy


def scheduler(*swaps: tuple[str, str]) -> ModuleType:
    """The scheduler with bugs planted in either of its modules."""
    for old, _ in swaps:
        assert sum(inspect.getsource(module).count(old) for module in (actuator, pulses)) == 1, old
    if not swaps:
        return actuator
    copy = planted(actuator, swaps)
    copy.pulses = planted(pulses, swaps)
    return copy


def board(*swaps: tuple[str, str]) -> ModuleType:
    """The interlock with bugs planted."""
    for old, _ in swaps:
        assert inspect.getsource(interlock).count(old) == 1, old
    return planted(interlock, swaps)


NO_TIMERS = (
    ("first = tick + config.backoff_ticks", "first = tick"),
    ("end = tick + config.pulse_ticks", "end = tick"),
    ("again = end + config.backoff_ticks", "again = tick"),
)
WORD_IGNORED = ("view.lockout_ms[pulse.coil] != 0", "False")
WORD_FORGOTTEN = ("= status.lockout_ms", "= 0")
UNBRIDLED = (*NO_TIMERS, WORD_IGNORED, WORD_FORGOTTEN)
"""A scheduler that asks for whatever is demanded, whenever it is."""

LOCKOUT_NOT_JUDGED = ("state.lockout[asked.coil] > 0", "False")
TOOTHLESS = (
    LOCKOUT_NOT_JUDGED,
    ("state.remaining > 0)", "False)"),
    ("<= asked.duration_ms <= limits.pulse_ms", "<= asked.duration_ms"),
)
"""A board that does what it is asked, and still tells for how long it should not."""

NO_LOCKOUT = (
    ("until_next = duration + limits.units(limits.backoff_ms)", "until_next = 0"),
    ("lockout=(full, full, full)", "lockout=(0, 0, 0)"),
)


def both_together(setup, *bugs):
    return setup._replace(scheduler=scheduler(*bugs))


def without_faults(setup, *bugs):
    return setup._replace(scheduler=scheduler(*bugs), faults=False, board_restarts=False)


def with_restarts_of_the_board(setup, *bugs):
    """It restarts at any time, and all that it says is heard."""
    return setup._replace(scheduler=scheduler(*bugs), faults=False)


def scheduler_alone(setup, *bugs):
    """The board refuses nothing, but what it says of its lockout, if it is heard, is true."""
    return setup._replace(scheduler=scheduler(*bugs), rules=board(*TOOTHLESS))


def own_timers_alone(setup, *bugs):
    """No timer outlives a restart, so that one inside a pulse is left to the board's word."""
    act, rules = scheduler(WORD_IGNORED, WORD_FORGOTTEN, *bugs), board(*TOOTHLESS, *NO_LOCKOUT)
    return setup._replace(scheduler=act, rules=rules, restart_in_pulse=False)


def interlock_alone(setup, *bugs):
    return setup._replace(scheduler=scheduler(*UNBRIDLED), rules=board(*bugs))


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


@pytest.mark.parametrize(("claim", "shared"), cases(CLAIMS))
def test_no_reachable_state_breaks_a_limit(search, small, claim, shared, record_testsuite_property):
    setup = claim(small[shared])
    proof = search(setup)
    record_testsuite_property(f"worlds, {claim.__name__}, shared={shared}", len(proof.worlds))
    assert len(proof.worlds) > 2000
    assert set(proof.accepted) == {0, 1, 2}, "every coil was fired"
    assert (proof.restarts_in_pulse > 0) is setup.restart_in_pulse


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
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


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
def test_a_scheduler_that_does_not_hear_of_the_restart_is_refused(search, small, shared):
    setup = with_restarts_of_the_board(small[shared], ("if readings.coil_boot is None else UNHEARD", ""))
    assert search(setup).refused


AGAIN, FIRST = "again = end + config.backoff_ticks", "first = tick + config.backoff_ticks"
READY = "if tick < state.ready_tick[coil] or"
WHICH = "config.shared or coil == pulse.coil"
PULSE_A_TICK_LONG = ("config.duration_ms)", "config.duration_ms + 1000)")

UNSAFE = {
    "back-off a tick short": (own_timers_alone, (AGAIN, AGAIN + " - 1"), BOTH),
    "back-off from the start of the pulse": (own_timers_alone, (AGAIN, AGAIN.replace("end", "tick")), BOTH),
    "back-off a tick short at boot": (own_timers_alone, (FIRST, FIRST + " - 1"), BOTH),
    "a coil forgotten at boot": (own_timers_alone, ("(first, first, first)", "(first, first, tick)"), BOTH),
    "shared taken for per coil": (own_timers_alone, (WHICH, "coil == pulse.coil"), (SHARED,)),
    "another coil backs off": (own_timers_alone, (WHICH, "coil != pulse.coil"), (PER_COIL,)),
    "own timers not asked": (own_timers_alone, (READY, "if"), BOTH),
    "own timers asked a tick early": (own_timers_alone, (READY, READY.replace("tick <", "tick + 1 <")), BOTH),
    "a pulse into another": (own_timers_alone, ("if tick < state.busy_until:", "if False:"), (PER_COIL,)),
    "a pulse a tick long": (own_timers_alone, PULSE_A_TICK_LONG, BOTH),
    "word not asked": (scheduler_alone, WORD_IGNORED, BOTH),
    "no word taken for a good one": (scheduler_alone, ("pulse.coil] != 0", "pulse.coil] > 0"), BOTH),
    "word on another coil": (scheduler_alone, ("ms[pulse.coil] !=", "ms[pulse.coil - 1] !="), (PER_COIL,)),
}


@pytest.mark.parametrize(("claim", "bug", "shared"), cases(UNSAFE))
def test_a_planted_danger_is_seen_in_what_is_driven(search, small, claim, bug, shared):
    setup = claim(small[shared], bug)
    with pytest.raises(AssertionError, match=r"ticks|two coils"):
        search(setup)


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per coil"])
@pytest.mark.parametrize("own_timers", [True, False], ids=["with own timers", "without"])
def test_a_lockout_that_neither_side_checks_is_seen(search, small, own_timers, shared):
    bugs = (WORD_IGNORED,) if own_timers else (WORD_IGNORED, *NO_TIMERS)
    setup = both_together(small[shared], *bugs)._replace(rules=board(LOCKOUT_NOT_JUDGED))
    with pytest.raises(AssertionError, match="ticks between two pulses"):
        search(setup)


INEXACT = {
    "a pulse a tick long": (PULSE_A_TICK_LONG, BOTH),
    "back-off a tick short": ((AGAIN, AGAIN + " - 1"), BOTH),
    "back-off a tick long": ((AGAIN, AGAIN + " + 1"), BOTH),
    "back-off a tick long at boot": ((FIRST, FIRST + " + 1"), BOTH),
    "per coil taken for shared": ((WHICH, "True"), (PER_COIL,)),
    "busy for a tick too long": (("busy_until=end", "busy_until=end + 1"), BOTH),
    "seq repeated": (("(view.seq + 1) & 0xFF", "view.seq"), BOTH),
    "another tick answered": (("0xFF, tick, config", "0xFF, tick - 1, config"), BOTH),
    "a coil left out": (("for coil in range(3)", "for coil in range(2)"), BOTH),
    "word never good": (("ms[pulse.coil] != 0", "ms[pulse.coil] != -2"), BOTH),
    "word on one coil kept for another": (("lockout[status.coil] =", "lockout[0] ="), BOTH),
}


@pytest.mark.parametrize(("bug", "shared"), cases(INEXACT))
def test_a_planted_bug_is_seen(search, small, bug, shared):
    setup = without_faults(small[shared], bug)
    with pytest.raises(AssertionError):
        demand_exactness(setup, search(setup))


def test_a_copy_without_a_bug_passes(search, small):
    """What is found in the copies is the bug, not the planting."""
    setup = without_faults(small[SHARED], (AGAIN, "again = config.backoff_ticks + end"))
    demand_exactness(setup, search(setup))
