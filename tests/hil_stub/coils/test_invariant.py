"""The limits hold on what the coil driver really drives, whatever it is sent and whenever it restarts.

The judge is an onlooker with a stopwatch. It is given what ``drive`` returned in each tick, and nothing
else, except over skipped ticks: there it assumes that the board drove the pulse to the end that was asked.
"""

from collections import Counter
from fractions import Fraction

import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    precondition,
    rule,
    run_state_machine_as_test,
)

from fsw.wire.frame import Frame
from fsw.wire.messages import CLASSES, CoilFire, CoilRefused, CoilStatus
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits

PULSE_S, BACKOFF_S = 3, 100
RATES = (1, 2, 3, 7, 10, 50)
SETTINGS = settings(deadline=None, suppress_health_check=list(HealthCheck))


class Judge:
    """Invariant I on what is driven, in exact seconds."""

    def __init__(self, tick_hz, shared):
        self.tick_hz = tick_hz
        self.shared = shared
        self.on = None  # coil, level, start, end so far
        self.last_end = {}
        self.pulses = []

    def watch(self, tick, drive):
        """The drive over the tick that begins at ``tick``."""
        start = Fraction(tick, self.tick_hz)
        if drive.level == 0:
            self.finish()
            return
        assert drive.level in {-3, -2, -1, 1, 2, 3}
        assert drive.coil in {0, 1, 2}
        assert 0 < drive.fraction <= 1
        end = start + Fraction(round(drive.fraction * 1000), 1000 * self.tick_hz)
        if self.on is not None and self.on[:2] == (drive.coil, drive.level) and self.on[3] == start:
            self.on = (*self.on[:3], end)
        else:
            self.finish()
            others = range(3) if self.shared else (drive.coil,)
            gaps = [start - self.last_end[coil] for coil in others if coil in self.last_end]
            assert all(gap >= BACKOFF_S for gap in gaps), f"gaps of {gaps} s"
            self.on = (drive.coil, drive.level, start, end)
        assert self.on[3] - self.on[2] <= PULSE_S, "a pulse too long"

    def skip(self, tick, asked_end):
        """Ticks up to ``tick`` were not seen; a pulse that was on then went on to the end that was asked."""
        if self.on is not None:
            assert asked_end - self.on[2] <= PULSE_S
            self.on = (*self.on[:3], max(self.on[3], min(asked_end, Fraction(tick, self.tick_hz))))

    def finish(self):
        if self.on is not None:
            coil, _, start, end = self.on
            self.last_end[coil] = end
            self.pulses.append((coil, start, end))
            self.on = None


class Model:
    """What the board must answer, from the absolute times of boot and of the ends of accepted pulses."""

    def __init__(self, tick_hz, shared):
        self.tick_hz = tick_hz
        self.shared = shared

    def boot(self, now):
        self.free_at = [now + BACKOFF_S] * 3
        self.end = now
        self.coil = 0
        self.seq = None

    def answer(self, fire, tick):
        """The reason for which the request is refused; None when it must be accepted, and then it is."""
        now = Fraction(tick, self.tick_hz)
        rules = (
            (fire.tick == tick % 256, Reason.WRONG_TICK),
            (fire.seq != self.seq, Reason.REPEATED_SEQ),
            (fire.coil <= 2, Reason.BAD_COIL),
            (fire.level in {-3, -2, -1, 1, 2, 3}, Reason.BAD_LEVEL),
            (0 < fire.duration_ms <= 1000 * PULSE_S, Reason.BAD_DURATION),
            (now >= self.end, Reason.COIL_ON),
            (now >= self.free_at[fire.coil % 3], Reason.LOCKOUT),
        )
        for kept, reason in rules:
            if not kept:
                return reason
        self.seq = fire.seq
        self.coil = fire.coil
        self.end = now + Fraction(fire.duration_ms, 1000)
        for coil in range(3) if self.shared else (fire.coil,):
            self.free_at[coil] = self.end + BACKOFF_S
        return None


COILS = st.sampled_from((0, 0, 1, 1, 2, 2, 3))
LEVELS = st.sampled_from((-3, -2, -1, 1, 2, 3, -3, 3, 0, 4, -4, -8, 7))
DURATIONS = st.one_of(
    st.sampled_from((3000, 3000, 3000, 2999, 2500, 1000, 20, 1, 0, 3001, 3100, 65_535)), st.integers(0, 3100)
)
SEEN = Counter()


class CoilDriverMachine(RuleBasedStateMachine):
    """Random requests, noise, strange ticks and restarts, at any rate and with both kinds of back-off."""

    @initialize(tick_hz=st.sampled_from(RATES), shared=st.booleans(), first_tick=st.integers(0, 1000))
    def switch_on(self, tick_hz, shared, first_tick):
        self.limits = CoilLimits(tick_hz, shared=shared)
        self.judge = Judge(tick_hz, shared)
        self.model = Model(tick_hz, shared)
        self.tick = first_tick - 1
        self.seq = 0
        self.reboot()

    @rule()
    def reboot(self):
        SEEN["reboot in a pulse"] += self.judge_is_on()
        self.board = CoilDriver(self.limits)
        self.model.boot(Fraction(self.tick + 1, self.limits.tick_hz))
        self.reasons = []
        self.go(1)

    def judge_is_on(self):
        return self.judge.on is not None

    def go(self, ticks, *fires):
        """``ticks`` further on (what lies between is not seen), bring the requests, and watch."""
        hz = self.limits.tick_hz
        if ticks > 1:
            self.judge.skip(self.tick + ticks, self.model.end)
        self.tick += ticks
        frames = self.board.begin_tick(self.tick, 0.0)
        replies = [CLASSES[frame.can_id].decode(frame.data) for frame in frames]
        assert sum(isinstance(message, CoilStatus) for message in replies) == 1
        assert [m.reason for m in replies if isinstance(m, CoilRefused)] == self.reasons
        self.reasons = []
        for fire in fires:
            reason = self.model.answer(fire, self.tick)
            SEEN[reason] += 1
            if reason is not None:
                self.reasons.append(reason)
            self.board.receive(fire.encode())
        drive = self.board.drive()
        rest = self.model.end - Fraction(self.tick, hz)
        assert Fraction(round(drive.fraction * 1000), 1000 * hz) == max(0, min(rest, Fraction(1, hz)))
        assert drive.level == 0 or drive.coil == self.model.coil
        self.judge.watch(self.tick, drive)

    @rule(
        fires=st.lists(
            st.tuples(COILS, LEVELS, DURATIONS, st.sampled_from((0, 0, 0, -1, 1, 7)), st.booleans()),
            max_size=4,
        ),
        ticks=st.integers(1, 5),
    )
    def ask(self, fires, ticks):
        requests = []
        for coil, level, duration_ms, late, again in fires:
            self.seq = self.seq if again else self.seq + 1 & 0xFF
            answered = self.tick + ticks + late & 0xFF
            requests.append(CoilFire(level, coil, self.seq, answered, duration_ms))
        self.go(ticks, *requests)

    @rule(coil=st.integers(0, 2), before=st.integers(0, 3), duration_ms=st.integers(1, 3000))
    def ask_in_each_tick_around_the_end_of_the_lockout(self, coil, before, duration_ms):
        free = -(-self.model.free_at[coil] * self.limits.tick_hz // 1)
        if free - before > self.tick + 1:
            self.go(int(free) - before - self.tick - 1)
        for _ in range(before + 3):
            self.seq = self.seq + 1 & 0xFF
            request = CoilFire(-3, coil, self.seq, self.tick + 1 & 0xFF, duration_ms)
            self.go(1, request.replace(seq=self.model.seq or 0), request)

    @rule(ticks=st.one_of(st.integers(1, 12), st.integers(1, 6000)))
    def jump(self, ticks):
        self.go(ticks)

    @rule(ticks=st.integers(1, 40))
    def run(self, ticks):
        for _ in range(ticks):
            self.go(1)

    @rule(
        back=st.integers(0, 6000), data=st.binary(max_size=8), bit=st.integers(0, 55), coil=st.integers(0, 2)
    )
    def noise(self, back, data, bit, coil):
        """A tick that does not rise, frames of others, a request that is broken, and one that is late."""
        drive = self.board.drive()
        assert self.board.begin_tick(self.tick - back, 0.0) == []
        for can_id in (CoilFire.ID | 0x8000_0000, 0x7FF, CoilStatus.ID):
            self.board.receive(Frame(can_id, data))
        late = CoilFire(3, coil, self.seq + 1 & 0xFF, self.tick & 0xFF, 3000).encode()
        flipped = int.from_bytes(late.data, "big") ^ 1 << bit
        for frame, reason in (
            (Frame(late.can_id, flipped.to_bytes(7, "big")), Reason.MALFORMED),
            (late, Reason.WRONG_TICK),
        ):
            self.board.receive(frame)
            self.reasons.append(reason)
            SEEN[reason] += 1
        assert self.board.drive() == drive

    @precondition(lambda self: self.judge_is_on())
    @rule()
    def reboot_in_a_pulse(self):
        self.reboot()


@pytest.mark.long
def test_whatever_happens_the_limits_hold_and_what_may_be_fired_is():
    SEEN.clear()
    run_state_machine_as_test(
        CoilDriverMachine, settings=settings(SETTINGS, max_examples=120, stateful_step_count=40)
    )
    assert SEEN[None] > 100, f"it fired: {SEEN}"
    of_other_boards = {Reason.SECOND_DIPOLE, Reason.WRONG_BOARD}
    assert all(bool(SEEN[reason]) != (reason in of_other_boards) for reason in Reason), f"{SEEN}"
    assert SEEN["reboot in a pulse"]


@pytest.mark.long
@SETTINGS
@given(
    frames=st.lists(
        st.one_of(
            st.builds(Frame, st.integers(0, 2**32 - 1), st.binary(max_size=8)),
            st.builds(Frame, st.just(CoilFire.ID), st.binary(max_size=8)),
            st.builds(Frame, st.just(CoilFire.ID), st.binary(min_size=7, max_size=7)),
        ),
        max_size=50,
    )
)
def test_no_random_frame_raises(frames):
    board = CoilDriver(CoilLimits(1))
    board.begin_tick(0, 0.0)
    board.begin_tick(100, 0.0)
    for frame in frames:
        board.receive(frame)
    taken = board.drive().level != 0
    event("a random frame was proper" if taken else "none was")
    assert not taken or board.rejects < len(frames)
    assert len(board.begin_tick(101, 0.0)) <= 1 + len(frames)


@pytest.mark.parametrize("hz", RATES)
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
def test_asked_in_every_tick_it_fires_as_often_as_the_limits_let_it(hz, shared):
    """Requests in every tick for 500 s: no pulse too many, and none too few."""
    limits = CoilLimits(hz, shared=shared)
    board, judge = CoilDriver(limits), Judge(hz, shared)
    for tick in range(500 * hz):
        board.begin_tick(tick, 0.0)
        for coil in range(3):
            board.receive(CoilFire(3, coil, tick * 3 + coil & 0xFF, tick & 0xFF, 3000).encode())
        judge.watch(tick, board.drive())
    starts = [start for _, start, _ in judge.pulses]
    assert {end - start for _, start, end in judge.pulses} == {3}
    if shared:
        assert starts == [100 + 103 * n for n in range(4)]
    else:
        assert starts == [100 + 103 * n + 3 * coil for n in range(4) for coil in range(3)]
