"""Current read-back: what is measured against what is driven, and the self-test at boot."""

from math import inf, nan
from pathlib import Path

import cantools
import pytest

import fsw.wire
from fsw.wire.messages import CoilEvent, CoilHeartbeat, Severity
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.coil_driver import BoardState, CoilDriver, CoilLimits, Drive
from hil_stub.coils.events import SEVERITY, CoilEventCode
from hil_stub.coils.read_back import ReadBack

NOMINAL_A = (0.05, 0.2, 0.3)
OFF, OPEN, REVERSED, WRONG = (
    CoilEventCode.CURRENT_WHILE_OFF,
    CoilEventCode.NO_CURRENT,
    CoilEventCode.CURRENT_REVERSED,
    CoilEventCode.CURRENT_WRONG,
)


@pytest.mark.parametrize(
    ("level", "current_a", "found"),
    [
        (0, 0.0, None),
        (0, 0.005, None),
        (0, -0.005, None),
        (0, 0.0051, OFF),
        (0, -0.2, OFF),
        (0, nan, OFF),
        (0, inf, OFF),
        (2, 0.2, None),
        (-2, -0.2, None),
        (2, 0.161, None),
        (2, 0.239, None),
        (2, 0.159, WRONG),
        (2, 0.241, WRONG),
        (2, 0.021, WRONG),
        (2, 0.019, OPEN),
        (2, 0.0, OPEN),
        (-2, -0.019, OPEN),
        (2, -0.2, REVERSED),
        (-2, 0.021, REVERSED),
        (1, 0.05, None),
        (3, 0.2, WRONG),
        (-3, -0.3, None),
        (3, nan, WRONG),
    ],
)
def test_what_is_found(level, current_a, found):
    assert ReadBack(NOMINAL_A).judge(level, current_a) is found


@pytest.mark.parametrize(
    "wrong",
    [
        {"nominal_a": (0.0, 0.1, 0.2)},
        {"nominal_a": (0.2, 0.1, 0.3)},
        {"nominal_a": (0.1, 0.1, 0.3)},
        {"nominal_a": (0.1, 0.3, 0.3)},
        {"nominal_a": (0.1, nan, 0.3)},
        {"settle_ms": -1},
        {"tolerance": 0.0},
        {"tolerance": 1.0},
    ],
)
def test_what_cannot_be_judged_by_is_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        ReadBack(**{"nominal_a": NOMINAL_A, **wrong})


def test_what_is_judged_by_unless_it_is_told():
    assert (ReadBack(NOMINAL_A).settle_ms, ReadBack(NOMINAL_A).tolerance) == (100, 0.2)


def test_small_currents_and_tolerances_are_judged_by_too():
    fine = ReadBack((0.0005, 0.001, 0.002), tolerance=0.0005)
    assert fine.judge(1, 0.0005) is None
    assert fine.judge(1, 0.000501) is WRONG


@pytest.mark.parametrize(
    ("level", "current_a", "found"),
    [
        (0, 0.1, None),
        (0, -0.1, None),
        (2, 2.5, None),
        (2, 1.5, None),
        (1, 0.1, OPEN),
        (1, -0.1, OPEN),
        (-1, 0.1, OPEN),
    ],
)
def test_the_edges_belong_to_what_is_better(level, current_a, found):
    assert ReadBack((1.0, 2.0, 4.0), tolerance=0.25).judge(level, current_a) is found


def test_events_have_the_names_of_the_dbc():
    dbc = cantools.database.load_file(Path(fsw.wire.__file__).with_name("torquer.dbc"))
    choices = dbc.get_message_by_name("COIL_EVENT").get_signal_by_name("event").choices
    assert {code.value: code.name for code in CoilEventCode} == {
        number: str(name).upper() for number, name in choices.items()
    }
    assert set(SEVERITY) == set(CoilEventCode)


class Rig:
    """A board whose coils do what the test says of them, from what is driven at the end of a tick."""

    def __init__(self, read, hz=1, settle_ms=100):
        self.read, self.hz = read, hz
        self.board = CoilDriver(CoilLimits(hz), ReadBack(NOMINAL_A, settle_ms))
        self.tick = -1
        self.drive = Drive(0, 0, 0.0)
        self.events = []

    def step(self, *frames, physics=lambda nominal_a: nominal_a):
        self.tick += 1
        on = self.drive.level if self.drive.fraction == 1.0 else 0
        nominal_a = NOMINAL_A[abs(on) - 1] * (1 if on > 0 else -1) if on else 0.0
        said = self.read(self.board.begin_tick(self.tick, physics(nominal_a)))
        self.events += [(self.tick, m.event, m.argument) for m in said if isinstance(m, CoilEvent)]
        for frame in frames:
            self.board.receive(frame)
        self.drive = self.board.drive()
        return said

    def run_to(self, tick, **how):
        while self.tick < tick - 1:
            self.step(**how)


@pytest.fixture
def rig(read):
    return Rig(read)


@pytest.fixture
def fire(rig_with):
    """The frame of a request that answers a tick."""
    return lambda tick, level=2, seq=1: rig_with(CoilLimits(1), tick).fire(level=level, seq=seq).encode()


def test_what_is_in_order_is_not_told(rig, fire):
    for number in range(4):
        rig.run_to(100 + 110 * number)
        rig.step(fire(rig.tick + 1, level=(-1, 3, 2, -3)[number], seq=number))
    rig.run_to(500)
    assert rig.events == []


@pytest.mark.parametrize("settle_ms", [0, 100, 2500])
def test_self_test_a_current_at_boot_is_told_once_and_all_is_refused(read, fire, settle_ms):
    rig = Rig(read, settle_ms=settle_ms)
    first = -(-settle_ms // 1000)
    rig.run_to(200, physics=lambda nominal_a: 0.2)
    assert rig.events == [(first, CoilEventCode.SELF_TEST_FAILED, 200)]
    rig.step(fire(200), physics=lambda nominal_a: 0.2)
    assert rig.drive.level == 0
    (_, refused) = rig.step(physics=lambda nominal_a: 0.2)
    assert refused.reason == Reason.COIL_ON


def test_a_board_that_restarts_in_a_pulse_lets_the_current_die_away_first(read):
    """At the instant of the restart the current of the pulse still flows: that is no fault."""
    rig = Rig(read)
    rig.step(physics=lambda nominal_a: 0.3)
    rig.run_to(20)
    assert rig.events == []


def test_a_driver_that_is_stuck_on_is_named_and_nothing_more_is_accepted(rig, fire):
    rig.run_to(100)
    rig.step(fire(100))
    rig.run_to(250, physics=lambda nominal_a: 0.2)
    assert rig.events == [(104, OFF, 200)], "a tick after the pulse has ended"
    rig.step(fire(250, seq=2), physics=lambda nominal_a: 0.2)
    assert rig.drive.level == 0
    said = rig.step(physics=lambda nominal_a: 0.2)
    assert [m.reason for m in said if hasattr(m, "reason")] == [Reason.COIL_ON]
    rig.step()
    rig.step(fire(253, seq=3))
    assert rig.drive.level == 2, "once the current is gone it is obeyed again"


@pytest.mark.parametrize("duration_ms", [1000, 400], ids=["a tick", "less"])
def test_the_current_of_a_pulse_that_ends_with_its_first_tick_is_no_short(read, rig_with, duration_ms):
    """It is read before the switch-off, and until it has settled nothing is said of it."""
    rig = Rig(read)
    rig.board = CoilDriver(CoilLimits(1, backoff_ms=0), ReadBack(NOMINAL_A))
    rig.run_to(20)
    for seq in range(3):
        pulse = rig_with(CoilLimits(1), rig.tick + 1).fire(level=3, duration_ms=duration_ms, seq=seq)
        rig.step(pulse.encode())
        assert rig.drive.level == 3, "the request before it has left no fault"
        rig.step(physics=lambda nominal_a: 0.3)
        rig.step()
    assert rig.events == []
    rig.step(physics=lambda nominal_a: 0.3)
    assert rig.events == [(29, OFF, 300)], "a current that stays is one"


def test_a_pulse_that_the_dead_man_ends_in_its_first_tick_is_no_short(rig, fire):
    rig.run_to(100)
    rig.step(fire(100))
    rig.board.silence()
    rig.step(physics=lambda nominal_a: 0.2)
    assert rig.events == [(101, CoilEventCode.DEAD_MAN, 0)]


def test_of_a_board_that_is_shorted_no_request_is_told_another_reason(rig, fire):
    """Neither that it answers another tick, nor that it comes when none can be answered."""
    rig.run_to(200, physics=lambda nominal_a: 0.2)
    rig.step(fire(150), physics=lambda nominal_a: 0.2)
    rig.board.receive(fire(200))
    said = rig.step(physics=lambda nominal_a: 0.2)
    assert [m.reason for m in said if hasattr(m, "reason")] == [Reason.COIL_ON] * 2


def test_a_fault_is_in_the_heartbeat(rig):
    rig.run_to(60, physics=lambda nominal_a: 0.2)
    (beat,) = [m for m in rig.step(physics=lambda nominal_a: 0.2) if isinstance(m, CoilHeartbeat)]
    assert beat.state == BoardState.FAULT


@pytest.mark.parametrize(
    ("physics", "code", "argument"),
    [
        (lambda nominal_a: 0.0, OPEN, 0),
        (lambda nominal_a: -nominal_a, REVERSED, 200),
        (lambda nominal_a: 0.5 * nominal_a, WRONG, -100),
        (lambda nominal_a: 1.5 * nominal_a, WRONG, -300),
    ],
    ids=["open", "reversed", "weak", "strong"],
)
def test_a_coil_fault_is_told_once_in_each_pulse(rig, fire, physics, code, argument):
    for number in range(2):
        rig.run_to(100 + 110 * number, physics=physics)
        rig.step(fire(rig.tick + 1, level=-2, seq=number), physics=physics)
    rig.run_to(400, physics=physics)
    assert rig.events == [(101, code, argument), (211, code, argument)]


def test_the_first_tick_of_a_pulse_is_judged_as_soon_as_the_current_has_settled(read, rig_with):
    rig = Rig(read, hz=50)
    rig.run_to(5000)
    fire = rig_with(CoilLimits(50), 5000).fire(level=2, duration_ms=3000)
    rig.step(fire.encode(), physics=lambda nominal_a: 0.0)
    rig.run_to(5200, physics=lambda nominal_a: 0.0)
    assert rig.events == [(5005, OPEN, 0)], "100 ms are five ticks"


def test_a_coil_without_current_is_no_fault_of_the_board(read, rig_with):
    """It is obeyed as before: its heartbeat says that it drives."""
    rig = Rig(read)
    rig.board = CoilDriver(CoilLimits(1, backoff_ms=0), ReadBack(NOMINAL_A))
    rig.run_to(58)
    rig.step(rig_with(CoilLimits(1), 58).fire().encode())
    rig.step(physics=lambda nominal_a: 0.0)
    said = rig.step(physics=lambda nominal_a: 0.0)
    assert rig.events == [(59, OPEN, 0)]
    assert [m.state for m in said if isinstance(m, CoilHeartbeat)] == [BoardState.ON]


@pytest.mark.parametrize(
    ("current_a", "argument"),
    [(1e9, 2**31 - 1), (inf, 2**31 - 1), (-1e9, -(2**31)), (-inf, -(2**31)), (nan, -(2**31)), (1e6, 10**9)],
)
def test_a_current_beyond_the_argument_of_an_event_is_told_as_its_end(rig, current_a, argument):
    rig.run_to(2)
    rig.step(physics=lambda nominal_a: current_a)
    assert rig.events == [(2, OFF, argument)]


def test_severity_and_counter(rig, fire):
    rig.run_to(100)
    rig.step(fire(100))
    said = [m for _ in range(6) for m in rig.step(physics=lambda nominal_a: -0.2)]
    events = [(m.event, m.severity, m.counter) for m in said if isinstance(m, CoilEvent)]
    assert events == [(REVERSED, Severity.ERROR, 0), (OFF, Severity.FATAL, 1)]


def test_without_a_read_back_nothing_is_judged(read, rig_with):
    rig = rig_with(CoilLimits(1))
    assert not any(isinstance(m, CoilEvent) for _ in range(200) for m in rig.step(current_a=0.3).said)
