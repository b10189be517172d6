"""A second sender: what names it and what does not; fsw asks for nothing beside it, and goes on after it."""

from random import Random

import pytest
from gate_samples import measured

from fsw.core.events import Event
from fsw.core.gate.second_sender import SIGNS, SecondSenderConfig, SecondSenderWatch, watch_senders
from fsw.core.monitors import Monitor
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    CoilDipole,
    CoilFire,
    CoilRefused,
    CoilRefusedReason,
    FswEvent,
    MagField,
    Mode,
    NavRate,
    TickDone,
)

CONFIG = SecondSenderConfig(request_ticks=120, other_ticks=10)
SEQ = 41
FROM_FSW = sorted(can_id for can_id, sender in SENDERS.items() if sender == "FSW")
FIRE = CoilFire(3, 1, 77, 0, 3000, 5).encode()


def under(can_id):
    return measured(under_own_id=can_id)


def refusal(seq, reason=CoilRefusedReason.LOCKOUT):
    return measured(refused=(CoilRefused(1, seq & 0xFF, reason, 0),))


def watched(heard, pulsed=True, seq=SEQ):
    """What is known after ``heard``, readings by tick."""
    known = SecondSenderWatch()
    for tick, readings in heard.items():
        watch_senders(known, readings, seq, pulsed, tick, CONFIG)
    return known


@pytest.mark.requirement("REQ-BUS-01")
class TestNamed:
    @pytest.mark.parametrize("can_id", FROM_FSW, ids=[CLASSES[can_id].__name__ for can_id in FROM_FSW])
    def test_by_any_identifier_of_its_own(self, can_id):
        known = watched({tick: under(can_id) for tick in range(70, 70 + SIGNS)})
        assert known.detected
        assert known.can_id == can_id

    def test_by_requests_that_the_coil_driver_refuses(self):
        known = watched({tick: refusal(SEQ + 2 + tick) for tick in range(SIGNS)})
        assert known.detected
        assert known.can_id == CoilFire.ID

    @pytest.mark.parametrize("foreign_first", [True, False])
    def test_by_a_refusal_beside_one_of_its_own(self, foreign_first):
        own, foreign = CoilRefused(1, SEQ, 8, 0), CoilRefused(1, SEQ + 9, 8, 0)
        both = (foreign, own) if foreign_first else (own, foreign)
        assert watched({tick: measured(refused=both) for tick in range(SIGNS)}).detected

    @pytest.mark.parametrize(
        ("can_id", "apart", "named"),
        [
            (CoilFire.ID, 120, True),
            (CoilDipole.ID, 120, True),
            (CoilFire.ID, 121, False),
            (NavRate.ID, 10, True),
            (NavRate.ID, 11, False),
        ],
    )
    def test_signs_must_not_be_too_far_apart(self, can_id, apart, named):
        assert watched({7 + n * apart: under(can_id) for n in range(20)}).detected is named

    def test_not_by_less_than_three_ticks_with_a_sign(self):
        assert not watched({0: under(CoilFire.ID), 1: under(CoilFire.ID)}).detected

    def test_any_sign_keeps_it_named_until_it_has_been_away_for_long_enough(self):
        named = {tick: under(CoilFire.ID) for tick in range(3)} | {122: under(NavRate.ID)}
        assert watched(named | {242: measured()}).detected
        assert watched(named | {243: measured()}) == SecondSenderWatch()
        assert not watched(named | {243: under(CoilFire.ID)}).detected


@pytest.mark.requirement("REQ-BUS-02")
class TestNotNamed:
    @pytest.mark.parametrize("seq", [SEQ, SEQ + 1])
    def test_by_own_requests_refused(self, seq):
        """The one that was accepted last, come again, and the one after it."""
        assert watched({tick: refusal(seq) for tick in range(50)}) == SecondSenderWatch()

    def test_by_refusals_of_what_was_broken_on_its_way(self):
        broken = {tick: refusal(5 * tick, CoilRefusedReason.MALFORMED) for tick in range(50)}
        assert watched(broken) == SecondSenderWatch()

    def test_by_refusals_of_a_continuous_driver_which_counts_otherwise(self):
        assert watched({tick: refusal(5 * tick) for tick in range(50)}, pulsed=False) == SecondSenderWatch()

    def test_when_the_sequence_number_wraps(self):
        assert watched({9: refusal(0)}, seq=255) == SecondSenderWatch()
        assert watched({9: refusal(255)}, seq=0) != SecondSenderWatch()


class TestInFlight:
    @pytest.fixture
    def world(self, make_world):
        return make_world(flight={"fdir": {"second_sender_s": 15.0}})

    def events(self, replies, event):
        """(tick, argument) of each."""
        return [
            (tick, message.argument)
            for tick, messages in enumerate(replies)
            for message in messages
            if isinstance(message, FswEvent) and message.event == event
        ]

    def fired(self, replies):
        return [tick for tick, reply in enumerate(replies) if any(isinstance(m, CoilFire) for m in reply)]

    @pytest.mark.requirement("REQ-BUS-01", "REQ-TRIP-09")
    def test_is_named_inhibits_and_lets_control_go_on_when_it_has_gone(self, world):
        """It comes in time to forestall the first pulse, and goes 20 s after that would have been due."""
        first, end = 90, 120
        rng = Random(4)

        def joined(inbox):
            """With a request that answers no tick, so that the coil driver stays free."""
            if not first <= inbox.tick < end:
                return inbox
            fire = CoilFire(2, 1, rng.randrange(256), (inbox.tick + 9) & 0xFF, 3000, inbox.tick & 0xF)
            return inbox.replace(frames=(*inbox.frames, fire.encode()))

        replies = world.fly(180, joined)
        assert self.events(replies, Event.SECOND_SENDER) == [(first + SIGNS - 1, CoilFire.ID)]
        assert self.events(replies, Event.MONITOR_TRIPPED) == [(first + SIGNS - 1, Monitor.NO_SECOND_SENDER)]
        assert (first + SIGNS - 1, Mode.SAFE) in self.events(replies, Event.MODE_CHANGED)
        gone = end + 15
        assert self.fired(replies)
        assert gone <= self.fired(replies)[0] <= gone + 7

    @pytest.mark.requirement("REQ-BUS-02")
    def test_frames_that_are_broken_are_no_sign(self, world):
        broken = FIRE.replace(data=bytes((FIRE.data[0] ^ 1,)) + FIRE.data[1:])
        short = Frame(TickDone.ID, TickDone(5, 6).encode().data[:-1])
        strange = (broken, short, Frame(CoilFire.ID | 0x8000_0000, FIRE.data))
        replies = world.fly(130, lambda inbox: inbox.replace(frames=(*inbox.frames, *strange)))
        assert self.events(replies, Event.SECOND_SENDER) == []
        assert self.fired(replies)

    @pytest.mark.requirement("REQ-BUS-02")
    def test_what_was_still_on_its_way_when_fsw_booted_is_no_second_sender(self, world):
        replies = world.fly(
            120,
            lambda inbox: inbox.replace(frames=(FIRE, FIRE, *inbox.frames)) if inbox.tick < 2 else inbox,
        )
        assert self.events(replies, Event.SECOND_SENDER) == []
        assert self.fired(replies)

    def test_it_costs_no_sensor_reading(self, world):
        world.fly(5, lambda inbox: inbox.replace(frames=(FIRE, *inbox.frames)))
        assert world.state.gate.rejected == 0
        assert world.state.field_tick == 4
        assert any(frame.can_id == MagField.ID for frame in world.inbox().frames)
