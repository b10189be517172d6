"""The conformance suite passes a board that does as the specification says, and finds each planted fault."""

from dataclasses import replace

import pytest
from interlocks import become

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilFire,
    CoilRefusedReason,
    CoilStatus,
    Sync,
)
from hil_stub.bench import CellsBoard, CoilBoard, MagnetometerBoard, SunBoard
from hil_stub.coils import coil_driver, guard, interlock
from hil_stub.coils.coil_driver import CoilLimits
from hil_stub.coils.events import CoilEventCode
from hil_stub.sensors.stimulus import constant
from sim.conformance import checks
from sim.conformance.board_under_test import BoardLimits, BoardUnderTest
from sim.conformance.command import CHECKS, run_checks
from sim.errors import HarnessError

NAMES = [check.run.__name__ for check in CHECKS]


@pytest.mark.parametrize("has_clock", [True, False], ids=["clock", "ticks"])
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
@pytest.mark.parametrize("hz", [1, 3, 10])
def test_the_stub_conforms(link_to, hz, shared, has_clock, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(hz, shared=shared)), hz, has_clock=has_clock)
    verdicts = run_checks(link, BoardLimits(shared=shared), armed=True)
    assert [verdict.name for verdict in verdicts] == NAMES
    assert all(verdict.ran and verdict.what for verdict in verdicts)
    found = failures(verdicts)
    assert set(found) == (set() if has_clock else {"own_clock", "held_tick"})


def test_a_board_with_the_back_off_of_posat_1_is_judged_in_ten_minutes(link_to, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1)), 1)
    since_s = link.clock()
    assert failures(run_checks(link, BoardLimits(backoff_ms=100_000), armed=True)) == {}
    assert link.clock() - since_s < 600.0


@pytest.mark.long
def test_a_board_has_a_whole_tick_for_its_answer(link_to, slow_bus, failures):
    """Also when ticks come early: they come no sooner than it answers."""
    link = link_to(lambda: CoilBoard(CoilLimits(10)), 10, bus=slow_bus)
    assert failures(run_checks(link, BoardLimits(), armed=True)) == {}


@pytest.mark.parametrize("hz", [1, 2])
def test_a_computer_that_is_busy_for_a_tick_does_not_blame_the_board(link_to, busy_bus, failures, hz):
    """An answer that waits is one of its tick, and the next tick has its whole time again."""
    link = link_to(lambda: CoilBoard(CoilLimits(hz)), hz, bus=busy_bus)
    assert failures(run_checks(link, BoardLimits(), armed=True)) == {}


@pytest.mark.parametrize("deadman_s", [2.0, 2.5, 5.0, 60.0])
@pytest.mark.parametrize(
    ("pulse_ms", "backoff_ms"), [(2500, 7300), (1200, 3900), (700, 2000), (100, 1000), (1, 0)]
)
@pytest.mark.parametrize("hz", [1, 3])
def test_it_conforms_with_other_limits(link_to, hz, pulse_ms, backoff_ms, deadman_s, failures):
    """Pulses and back-offs shorter than a tick, a dead-man of two ticks."""
    limits = CoilLimits(hz, pulse_ms, backoff_ms)
    link = link_to(lambda: CoilBoard(limits), hz, deadman_ms=round(1000 * deadman_s))
    assert failures(run_checks(link, BoardLimits(pulse_ms, backoff_ms, True, deadman_s), armed=True)) == {}


def test_it_conforms_with_a_dead_man_of_half_a_second(link_to, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(10, 500, 1500)), 10, deadman_ms=500)
    assert failures(run_checks(link, BoardLimits(500, 1500, True, 0.5), armed=True)) == {}


@pytest.mark.parametrize(
    ("kind", "make"),
    [
        ("magnetometer", lambda: MagnetometerBoard(1, constant((1e-5, 2e-5, 3e-5)))),
        ("sun", lambda: SunBoard(1, constant((1.0, 0.0, 0.0)))),
        ("cells", lambda: CellsBoard(1, constant((0.8, 0.0, 0.6, 0.0, 0.1, 0.0)))),
    ],
)
def test_sensors_conform(link_to, kind, make, failures):
    verdicts = run_checks(link_to(make, kind=kind), BoardLimits(), armed=False)
    names = [verdict.name for verdict in verdicts]
    assert names == ["boot", "noise", "lost_count", "last_tick", "heartbeats", "all_along"]
    assert failures(verdicts) == {}


@pytest.mark.parametrize(("kind", "board", "shown"), [("sun", CellsBoard, 6), ("cells", SunBoard, 3)])
def test_the_board_of_one_is_not_taken_for_that_of_the_other(link_to, kind, board, shown, failures):
    """Both are the node SUN."""
    verdicts = run_checks(
        link_to(lambda: board(1, constant((0.5,) * shown)), kind=kind), BoardLimits(), False
    )
    assert "all_along" in failures(verdicts)


def test_without_arm_no_request_is_ever_sent(link_to, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    bus, sent = link._bus, []
    send = bus.send
    bus.send = lambda frames: (sent.extend(frames), send(frames))
    verdicts = run_checks(link, BoardLimits(), armed=False)
    assert failures(verdicts) == {}
    assert {v.name for v in verdicts if not v.ran} == {c.run.__name__ for c in CHECKS if c.power}
    assert len(sent) > 20
    assert not any(frame.can_id & 0x7FF == CoilFire.ID for frame in sent)


def test_a_bus_without_a_board_is_an_error(link_to):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    link._bus.queue.clear()
    link._bus.send = lambda frames: None
    with pytest.raises(HarnessError, match="no COIL board answers"):
        run_checks(link, BoardLimits(), armed=True)


@pytest.mark.parametrize("stranger", [Sync(5, 0)])
def test_somebody_else_who_paces_the_bus_is_an_error(link_to, stranger):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    link._bus.queue.append(stranger.encode())
    with pytest.raises(HarnessError, match="another node sends SYNC"):
        run_checks(link, BoardLimits(), armed=True)


def without(reason):
    """The interlock without one of its rules."""
    rules = tuple(rule for rule in interlock._REFUSED_IF if rule[0] is not reason)
    return lambda patch: patch.setattr(interlock, "_REFUSED_IF", rules)


def booting(factor):
    def boot(limits):
        state = interlock.boot(limits)
        state.lockout = tuple(round(factor * left) for left in state.lockout)
        return state

    return lambda patch: patch.setattr(guard, "boot", boot)


def accepting(change):
    """An interlock that sets other timers when it accepts."""

    def accept(state, asked, limits):
        interlock.accept(state, asked, limits)
        become(state, change(state, limits))

    return lambda patch: patch.setattr(guard, "accept", accept)


def lockouts(change):
    return lambda state, limits: replace(state, lockout=tuple(change(left, limits) for left in state.lockout))


def silencing(change):
    return lambda patch: patch.setattr(
        guard, "silence", lambda state, limits: become(state, change(state, limits))
    )


def silence_the_ticks_alone(state, limits):
    if limits.tick_hz == guard.CLOCK_HZ:
        return state
    silenced = replace(state)
    interlock.silence(silenced, limits)
    return silenced


def judge_by_clock_alone(patch):
    def judge(state, request, tick, limits):
        if limits.tick_hz != guard.CLOCK_HZ:
            state = replace(state, remaining=0, lockout=(0, 0, 0))
        return interlock.judge(state, request, tick, limits)

    patch.setattr(guard, "judge", judge)


def booting_with_a_seq(patch):
    patch.setattr(guard, "boot", lambda limits: replace(interlock.boot(limits), seq=0))


def take_broken(patch):
    taken = coil_driver.intact
    patch.setattr(coil_driver, "intact", lambda f: taken(f) or (f.can_id == CoilFire.ID and len(f.data) == 7))


def take_flagged(patch):
    receive = coil_driver.CoilDriver.receive

    def unflagged(self, frame, clock_ms):
        receive(self, Frame(frame.can_id & 0x7FF, frame.data), clock_ms)

    patch.setattr(coil_driver.CoilDriver, "receive", unflagged)


def take_any_coil(patch):
    modulo = {"BAD_COIL": lambda state, asked, tick, limits: False}
    rules = tuple((reason, modulo.get(reason.name, rule)) for reason, rule in interlock._REFUSED_IF)
    patch.setattr(interlock, "_REFUSED_IF", rules)
    ask = guard.Guard.ask
    patch.setattr(
        guard.Guard, "ask", lambda self, asked, tick: ask(self, asked.replace(coil=asked.coil % 3), tick)
    )


def faint_at_boot(patch):
    found = coil_driver.CoilDriver._found

    def and_one_more(self, tick, elapsed, current_a):
        frames = found(self, tick, elapsed, current_a)
        return [*frames, self._events.frame(CoilEventCode.SELF_TEST_FAILED, tick)] if elapsed else frames

    patch.setattr(coil_driver.CoilDriver, "_found", and_one_more)


def told_of_time_by_ticks_alone(patch):
    told = {}
    pass_time, elapse = guard.Guard.pass_time, guard.Guard.elapse

    def late(self, clock_ms):
        told[id(self)] = clock_ms
        if self._by_clock is None:
            pass_time(self, clock_ms)

    def tick(self, ticks):
        pass_time(self, told[id(self)])
        elapse(self, ticks)

    patch.setattr(guard.Guard, "pass_time", late)
    patch.setattr(guard.Guard, "elapse", tick)


def clock_ends_no_pulse(patch):
    patch.setattr(guard.Guard, "remaining_units", property(lambda self: self._by_ticks.remaining))


Reason = CoilRefusedReason

IN_THE_BOARD = {
    "no lockout at boot": (booting(0.0), "boot"),
    "a lockout at boot that is short": (booting(0.95), "boot"),
    "a lockout at boot that is long": (booting(1.2), "boot"),
    "a back-off that is short": (
        accepting(lockouts(lambda left, limits: left - limits.units(1000))),
        "back_off",
    ),
    "a back-off that is long": (
        accepting(lockouts(lambda left, limits: left + limits.units(9000))),
        "back_off",
    ),
    "no back-off": (accepting(lockouts(lambda left, limits: 0)), "back_off"),
    "a pulse that is long": (
        accepting(lambda state, limits: replace(state, remaining=state.remaining + limits.units(1000))),
        "back_off",
    ),
    "a pulse that is short": (
        accepting(lambda state, limits: replace(state, remaining=limits.units(1000))),
        "back_off",
    ),
    "another coil": (accepting(lambda state, limits: replace(state, coil=2)), "boot_lockout"),
    "a late request": (without(Reason.WRONG_TICK), "refusals"),
    "a repeated request": (without(Reason.REPEATED_SEQ), "refusals"),
    "any coil": (take_any_coil, "refusals"),
    "any level": (without(Reason.BAD_LEVEL), "refusals"),
    "any duration": (without(Reason.BAD_DURATION), "refusals"),
    "two coils on": (without(Reason.COIL_ON), "back_off"),
    "lockout not judged": (without(Reason.LOCKOUT), "boot_lockout"),
    "another order": (
        lambda patch: patch.setattr(interlock, "_REFUSED_IF", interlock._REFUSED_IF[::-1]),
        "refusals",
    ),
    "a broken request": (take_broken, "refusals"),
    "a frame with a flag": (take_flagged, "refusals"),
    "a dead-man that does nothing": (silencing(lambda state, limits: state), "dead_man_in_a_pulse"),
    "a dead-man that only switches off": (
        silencing(lambda state, limits: replace(state, level=0, remaining=0)),
        "dead_man",
    ),
    "a dead-man that forgets the last seq": (
        silencing(lambda state, limits: replace(state, level=0, remaining=0, seq=None)),
        "dead_man_in_a_pulse",
    ),
    "a dead-man that locks out by ticks alone": (silencing(silence_the_ticks_alone), "own_clock"),
    "a boot that takes seq 0 for a repeated one": (booting_with_a_seq, "restart_in_a_pulse"),
    "requests that are judged by the clock alone": (judge_by_clock_alone, "boot_lockout"),
    "a self-test that fails": (faint_at_boot, "boot"),
    "a clock that is told of time by ticks alone": (told_of_time_by_ticks_alone, "held_tick"),
    "a clock that ends no pulse": (clock_ends_no_pulse, "held_tick"),
}


@pytest.mark.interpreted
@pytest.mark.parametrize(("plant", "finds"), IN_THE_BOARD.values(), ids=IN_THE_BOARD)
def test_a_fault_in_the_board_is_found(link_to, monkeypatch, plant, finds, failures):
    plant(monkeypatch)
    found = failures(run_checks(link_to(lambda: CoilBoard(CoilLimits(1))), BoardLimits(), armed=True))
    assert finds in found, found


@pytest.mark.interpreted
@pytest.mark.parametrize(
    "fault",
    [
        "no lockout at boot",
        "no back-off",
        "lockout not judged",
        "a dead-man that only switches off",
        "a clock that is told of time by ticks alone",
    ],
)
def test_limits_of_few_ticks_hide_no_fault(link_to, monkeypatch, fault, failures):
    plant, finds = IN_THE_BOARD[fault]
    plant(monkeypatch)
    link = link_to(lambda: CoilBoard(CoilLimits(1, 1200, 3900)), deadman_ms=2000)
    found = failures(run_checks(link, BoardLimits(1200, 3900, True, 2.0), armed=True))
    assert finds in found, found


@pytest.mark.parametrize(("of_board", "of_bench"), [(True, False), (False, True)])
def test_the_wrong_kind_of_back_off_is_found(link_to, of_board, of_bench, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1, shared=of_board)))
    assert "back_off" in failures(run_checks(link, BoardLimits(shared=of_bench), armed=True))


def test_no_dead_man_is_found(link_to, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1)), deadman_ms=None)
    assert {"dead_man", "dead_man_in_a_pulse"} <= set(failures(run_checks(link, BoardLimits(), armed=True)))


def test_a_restart_that_costs_nothing_is_found(link_to, failures):
    """The board is the same one after PLANT_BOOT: its timers run on."""
    board = CoilBoard(CoilLimits(1))
    link = link_to(lambda: board)
    assert "restart_in_a_pulse" in failures(run_checks(link, BoardLimits(), armed=True))


def test_a_board_that_speaks_out_of_turn_is_found(link_to, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    bus, receive = link._bus, link._bus.receive
    said = CoilStatus(0, 0, 0, 0, 0, 0).encode()

    def babble(timeout_s):
        frame = receive(timeout_s)
        return said if frame is None and timeout_s > 4.0 else frame

    bus.receive = babble
    assert "dead_man" in failures(run_checks(link, BoardLimits(), armed=False))


def test_the_number_of_the_dead_man_is_that_of_the_board():
    assert checks.DEAD_MAN == CoilEventCode.DEAD_MAN


@pytest.mark.parametrize("hz", [1, 10])
@pytest.mark.parametrize(
    ("told_s", "is_s"),
    [
        (5.0, 2.0),
        (5.0, 4.0),
        (5.0, 4.7),
        (5.0, 5.3),
        (5.0, 9.0),
        (60.0, 40.0),
        (60.0, 58.0),
        (2.0, 1.2),
        (2.0, 2.3),
    ],
)
def test_a_dead_man_that_is_not_what_the_bench_says_is_found_without_power(
    link_to, told_s, is_s, hz, failures
):
    link = link_to(lambda: CoilBoard(CoilLimits(hz, 1200, 3900)), hz, deadman_ms=round(1000 * is_s))
    found = failures(run_checks(link, BoardLimits(1200, 3900, True, told_s), armed=False))
    assert "dead_man" in found, found


@pytest.mark.parametrize(("told_s", "is_s"), [(5.0, 4.95), (5.0, 5.05), (60.0, 59.0), (60.0, 61.0)])
def test_a_dead_man_within_the_tolerance_of_a_clock_conforms(link_to, told_s, is_s, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(1, 1200, 3900)), deadman_ms=round(1000 * is_s))
    assert failures(run_checks(link, BoardLimits(1200, 3900, True, told_s), armed=True)) == {}


def test_a_computer_that_is_held_up_in_every_silence_does_not_judge_the_dead_man(link_to):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    bus, receive = link._bus, link._bus.receive

    def held_up(timeout_s):
        frame = receive(timeout_s)
        if timeout_s > 3.0:
            bus.now_s += 0.4
        return frame

    bus.receive = held_up
    link.step()
    with pytest.raises(HarnessError, match="held up in each of 10 silences"):
        checks.dead_man(BoardUnderTest(link, BoardLimits()))


@pytest.mark.parametrize(("of_board", "of_bench"), [(1, 2), (1, 10), (2, 1), (10, 1)])
def test_a_board_with_another_tick_rate_is_found_without_power(link_to, of_board, of_bench, failures):
    link = link_to(lambda: CoilBoard(CoilLimits(of_board)), of_bench)
    assert "heartbeats" in failures(run_checks(link, BoardLimits(), armed=False))


class OnceLate:
    """A link's bus that loses what a board sends in one tick: this computer stood still, or the board did."""

    def __init__(self, bus, at_s, clock):
        self.bus, self.at_s, self.clock, self.lost = bus, at_s, clock, False

    def send(self, frames):
        self.bus.send(frames)

    def receive(self, timeout_s):
        frame = self.bus.receive(timeout_s)
        if frame is None or not self.at_s < self.clock() < self.at_s + 2.0:
            return frame
        self.lost = True
        return None


@pytest.mark.parametrize(("paused_s", "times"), [(0.0, 0), (0.2, 1)], ids=["board", "computer"])
def test_a_check_that_this_computer_has_disturbed_is_run_again(link_to, failures, paused_s, times):
    link = link_to(lambda: CoilBoard(CoilLimits(1)))
    late = link._bus = OnceLate(link._bus, link.clock() + 400.0, link.clock)
    pauses = [paused_s]
    results = run_checks(
        link, BoardLimits(), armed=True, paused_s=lambda: pauses.pop() if late.lost and pauses else 0.0
    )
    assert late.lost
    assert sum(result.repeated for result in results) == times
    assert bool(failures(results)) == (not times)
