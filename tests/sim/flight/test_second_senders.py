"""Second senders are detected in the frames that the plant receives, by identifier and tick."""

import pytest

from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilFire,
    CoilStatus,
    FswBoot,
    FswEvent,
    MagField,
    NavAttitude,
    NavParameter,
    NavRate,
    PlantBoot,
    PlantEnd,
    SunVector,
    Sync,
    TcMode,
    TickDone,
)
from sim.flight.second_senders import ALONE, SecondSenderFrames, SenderWatch, describe_senders

EPOCH = 1_427_424_417
NAV = [NavAttitude(1, 0.1, 0.2, 0.3).encode(), NavRate(1, 0.0, 0.0, 0.0).encode()]
EVENT = FswEvent(1, 0, 0, 0).encode()
FIELD = MagField(1, 20000.0, 0.0, -30000.0).encode()


def done(tick):
    return TickDone(tick, 7).encode()


def answer(tick):
    return [EVENT, EVENT, *NAV, done(tick)]


def heard(*ticks, lockstep=True, **options):
    """What is found in ticks of (before, answers)."""
    watch = SenderWatch(lockstep, **options)
    for tick, (before, answers) in enumerate(ticks):
        watch.take(tick, list(before), list(answers))
    return watch.found


def quiet(count):
    return [([], answer(tick)) for tick in range(count)]


@pytest.mark.parametrize("lockstep", [True, False])
class TestInBothPaces:
    def test_the_flight_software_alone_is_no_second_sender(self, lockstep):
        assert heard(*quiet(5), lockstep=lockstep) == []

    @pytest.mark.parametrize(
        "frame",
        [
            Sync(2, EPOCH + 2).encode(),
            FIELD,
            SunVector(1, 1.0, 0.0, 0.0).encode(),
            CoilStatus(0, 0, 0, 0, 0, 0).encode(),
            CoilBoot(0, 1, 0).encode(),
            PlantBoot(0, 1, 0).encode(),
            PlantEnd(2).encode(),
        ],
        ids=lambda frame: f"{frame.can_id:03X}",
    )
    @pytest.mark.parametrize("early", [True, False])
    def test_no_one_else_sends_as_plant_or_board(self, lockstep, frame, early):
        second = ([frame], answer(2)) if early else ([], [*answer(2)[:2], frame, *answer(2)[2:]])
        found = heard(*quiet(2), second, ([], answer(3)), lockstep=lockstep)
        assert found == [SecondSenderFrames(frame.can_id, 2, 1)]

    def test_boards_may_be_nodes_of_the_bus(self, lockstep):
        ticks = [([FIELD], answer(tick)) for tick in range(3)]
        assert heard(*ticks, lockstep=lockstep, own=ALONE) == []
        assert heard(*ticks, lockstep=lockstep) == [SecondSenderFrames(MagField.ID, 0, 3)]

    def test_a_boot_in_flight_is_another(self, lockstep):
        boot = FswBoot(0, 1, 2).encode()
        found = heard(*quiet(2), ([boot], answer(2)), lockstep=lockstep)
        assert found == [SecondSenderFrames(FswBoot.ID, 2, 1)]

    def test_a_boot_that_was_asked_for_twice_may_come_into_the_first_tick(self, lockstep):
        boot = FswBoot(0, 1, 2).encode()
        assert heard(([], [boot, *answer(0)]), lockstep=lockstep) == []
        assert heard(([boot], answer(0)), lockstep=lockstep) == []

    def test_a_tick_ends_once(self, lockstep):
        """A forged TICK_DONE came first and was believed; the true answer follows."""
        found = heard(*quiet(2), ([], [done(2)]), ([*answer(2)], answer(3)), lockstep=lockstep)
        assert found == [SecondSenderFrames(TickDone.ID, 2, 1)]

    def test_nor_before_it_has_begun(self, lockstep):
        assert heard(*quiet(2), ([], [done(900), *answer(2)]), lockstep=lockstep) == [
            SecondSenderFrames(TickDone.ID, 2, 1)
        ]

    def test_nor_long_after(self, lockstep):
        assert heard(*quiet(5), ([done(1)], answer(5)), lockstep=lockstep) == [
            SecondSenderFrames(TickDone.ID, 5, 1)
        ]

    def test_a_second_flight_software_says_everything_twice(self, lockstep):
        twice = [(answer(tick - 1) if tick else [], answer(tick)) for tick in range(10)]
        assert heard(*twice, lockstep=lockstep) == [SecondSenderFrames(TickDone.ID, 0, 9)]

    def test_frames_are_counted_from_the_first_on(self, lockstep):
        ticks = [([FIELD] if tick > 1 else [], answer(tick)) for tick in range(6)]
        assert heard(*ticks, lockstep=lockstep) == [SecondSenderFrames(MagField.ID, 2, 4)]

    @pytest.mark.parametrize(
        "frame",
        [
            TcMode(3).encode(),
            Frame(0x7FF, b"\xde\xad"),
            Frame(MagField.ID, b""),
            FIELD.replace(data=FIELD.data[:-1] + b"\0"),
            Frame(CoilStatus.ID | REMOTE_FLAG, b""),
            Frame(0x12345678 | EXTENDED_FLAG, b"\1\2"),
            Frame(CoilFire.ID, bytes(8)),
        ],
    )
    def test_ground_and_noise_are_no_senders(self, lockstep, frame):
        assert heard(([frame], [frame, *answer(0)]), ([frame], answer(1)), lockstep=lockstep) == []

    def test_who_answers_a_forged_sync_is_not_judged(self, lockstep):
        """The flight software may have believed it: what it then says is its own."""
        forged = ([Sync(2, EPOCH + 2).encode(), *answer(2)], answer(2))
        assert heard(*quiet(2), forged, ([*answer(3)], answer(3)), lockstep=lockstep) == [
            SecondSenderFrames(Sync.ID, 2, 1)
        ]


class TestInLockstep:
    def test_between_two_answers_the_flight_software_is_silent(self):
        assert heard(*quiet(2), ([NAV[0]], answer(2))) == [SecondSenderFrames(NavAttitude.ID, 2, 1)]

    @pytest.mark.parametrize("message", [CoilFire(1, 0, 3, 2, 3000), NavParameter(4, -12, 30000, 10000)])
    def test_no_answer_holds_a_message_twice(self, message):
        frame = message.encode()
        assert heard(([], [frame, frame, *answer(0)])) == [SecondSenderFrames(message.ID, 0, 1)]


def test_a_sync_that_was_sent_again_may_be_answered_again():
    watch = SenderWatch(lockstep=True)
    watch.take(0, [], answer(0), again=True)
    watch.take(1, answer(0), answer(1))
    assert watch.found == []
    watch.take(2, answer(1), answer(2))
    assert watch.found == [SecondSenderFrames(TickDone.ID, 1, 1)]


def test_in_real_time_a_late_answer_is_no_second_sender():
    ticks = [([], answer(0)), ([], []), (answer(1)[:3], answer(1)[3:]), ([], answer(2) + answer(3))]
    assert heard(*ticks, lockstep=False) == []


def test_a_new_one_is_reported_at_once_and_only_once():
    watch = SenderWatch(lockstep=True)
    assert [watch.take(tick, [FIELD] * (tick == 1), answer(tick)) for tick in range(3)] == [
        False,
        True,
        False,
    ]


def test_it_is_described_by_message_identifier_and_tick():
    found = [SecondSenderFrames(TickDone.ID, 57, 1).as_json(), SecondSenderFrames(Sync.ID, 60, 3).as_json()]
    assert describe_senders(found) == (
        "a second sender is on the bus: TICK_DONE (280) at tick 57, SYNC (180) from tick 60 on"
    )


@pytest.mark.parametrize("lockstep", [True, False])
def test_a_boot_in_flight_may_be_a_restart_where_that_is_judged_elsewhere(lockstep):
    boot = FswBoot(0, 1, 0).encode()
    ticks = [*quiet(3), ([], [boot, *answer(3)])]
    assert [one.can_id for one in heard(*ticks, lockstep=lockstep)] == [FswBoot.ID]
    assert heard(*ticks, lockstep=lockstep, may_boot=True) == []
