"""Telecommands in the flight loop: acknowledged in the answer to their tick, and never beyond the limits."""

from collections import Counter
from random import Random

import pytest

from fsw.core.commands import LAW_NAMES
from fsw.core.gate.readings import TELECOMMANDS
from fsw.core.modes import ModeState
from fsw.core.orbit.ephemeris import advance, with_orbit
from fsw.core.state import checksum
from fsw.wire.messages import (
    CoilFire,
    CoilRefused,
    Element,
    FswEvent,
    Mode,
    NavQuality,
    TcAck,
    TcAckResult,
    TcClear,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcSpin,
    TickDone,
)


def with_telecommands(*messages):
    frames = tuple(message.encode() for message in messages)
    return lambda inbox: inbox._replace(frames=(*frames, *inbox.frames))


def of(kind, messages):
    return [message for message in messages if type(message) is kind]


class TestInTheLoop:
    def test_the_answer_to_the_tick_tells_before_it_is_done(self, make_world):
        world = make_world()
        world.fly(5)
        replies = world.step(with_telecommands(TcSpin(2**-7, 3), TcMode(7, 4)))
        assert of(TcAck, replies) == [
            TcAck(TcAckResult.ACCEPTED, TcSpin.ID, 3, 5, counter=0),
            TcAck(TcAckResult.UNKNOWN, TcMode.ID, 4, 5, counter=1),
        ]
        assert type(replies[-1]) is TickDone
        assert world.state.setpoint.spin_radps == 2**-7
        assert of(TcAck, world.step()) == []

    def test_a_broken_one_has_no_answer_and_no_effect(self, make_world):
        world, other = make_world(), make_world()
        frame = TcMode(Mode.SAFE).encode()
        broken = frame._replace(data=bytes((frame.data[0] ^ 0x20,)) + frame.data[1:])
        replies = world.step(lambda inbox: inbox._replace(frames=(broken, *inbox.frames)))
        assert of(TcAck, replies) == []
        other.step()
        expected = other.state._replace(gate=other.state.gate._replace(rejected=1))
        assert checksum(world.state) == checksum(expected)

    def test_a_safe_that_the_ground_asked_for_lasts_until_it_asks_for_more(self, make_world):
        world = make_world()
        world.fly(60)
        assert world.state.modes.mode is not Mode.SAFE
        replies = world.step(with_telecommands(TcMode(Mode.SAFE)))
        assert [(e.event, e.argument) for e in of(FswEvent, replies)] == [(1, Mode.SAFE)]
        quiet = [message for replies in world.fly(150) for message in replies]
        assert of(CoilFire, quiet) == []
        assert {quality.mode for quality in of(NavQuality, quiet)} == {Mode.SAFE}
        replies = world.step(with_telecommands(TcMode(Mode.DETUMBLE, 1)))
        assert of(CoilFire, replies)  # the coils have long been ready, and the same tick obeys
        assert world.state.modes.mode is Mode.DETUMBLE

    def test_trips_that_keep_it_safe_are_forgotten_by_the_ground(self, make_world, without):
        world = make_world()
        world.fly(10)
        stuck = ModeState(Mode.SAFE, trips=world.config.modes.trips_to_stay_safe)
        world.state = world.state._replace(modes=stuck)
        world.fly(30)
        assert world.state.modes.mode is Mode.SAFE
        replies = world.step(with_telecommands(TcClear()))
        assert of(FswEvent, replies) == []
        world.fly(30)
        assert world.state.modes.mode is not Mode.SAFE

    def test_an_orbit_is_flown_from_the_next_tick_on(self, make_world, elements):
        world, other = make_world(), make_world()
        for one in (world, other):
            one.fly(25)
        turned = elements(raan_deg=(374208, -4))
        replies = world.step(with_telecommands(*turned, TcOrbitLoad()))
        other.step()
        assert [ack.result for ack in of(TcAck, replies)] == [TcAckResult.ACCEPTED] * 10
        assert world.state.attitude == other.state.attitude
        model = with_orbit(world.config.ephemeris, world.state.orbit)
        for _ in range(60):
            world.step()
            other.step()
            assert world.state.ephemeris == advance(None, world.state.tick, model)
        assert world.state.attitude != other.state.attitude

    def test_telecommands_beyond_what_the_gate_looks_at_are_counted_as_unread(self, make_world):
        world = make_world()
        replies = world.step(with_telecommands(*(TcClear(n & 0xF) for n in range(80))))
        assert len(of(TcAck, replies)) == 64
        assert world.state.gate.overrun > 0


def random_telecommand(random, counter, digits):
    """Intact, its values anything; now and then the sensible ones."""
    kind = random.choice([*TELECOMMANDS.values()])
    message = kind.decode(random.randbytes(kind.LENGTH))._replace(counter=counter)
    if kind is TcOrbitElement and random.random() < 0.7:
        element = random.choice([*Element])
        mantissa, exponent = digits[element]
        message = TcOrbitElement(element, exponent, mantissa + random.randrange(-3, 4), counter)
    if kind is TcLaw and random.random() < 0.9:
        message = TcLaw(random.choice([*LAW_NAMES]), counter)
    if kind is TcGain and random.random() < 0.5:
        message = TcGain(random.randrange(3), random.randrange(-3, 5), random.randrange(2**20), counter)
    return message


@pytest.mark.parametrize(
    ("seed", "settings"),
    [
        (1, {}),
        (2, {}),
        (3, {"knowledge": "perfect"}),
        (4, {"knowledge": "perfect", "coils": {"backoff": "per_coil"}}),
        (5, {"coils": {"driver": "continuous", "max_dipole_am2": 0.2}}),
    ],
)
def test_whatever_the_ground_sends_the_limits_are_kept(make_world, digits, seed, settings):
    """Five hundred ticks of random telecommands against the boards' own interlock."""
    world, random = make_world(seed=seed, **settings), Random(seed)
    counters, answers, refusals, fires = Counter(), Counter(), 0, 0
    for _ in range(500):
        sent = []
        for _ in range(random.choice([0, 0, 1, 2, 12])):
            message = random_telecommand(random, 0, digits)
            counters[message.ID] += 1
            sent.append(message._replace(counter=counters[message.ID] & 0xF))

        def reports(inbox, sent=sent):
            nonlocal refusals
            refusals += any(frame.can_id == CoilRefused.ID for frame in inbox.frames)
            return with_telecommands(*sent)(inbox)

        replies = world.step(reports)
        acks = of(TcAck, replies)
        assert [(ack.command, ack.command_counter) for ack in acks] == [(m.ID, m.counter) for m in sent]
        answers.update(TcAckResult(ack.result) for ack in acks)
        fires += len(of(CoilFire, replies))
        assert world.state.modes.mode is not Mode.SAFE or not of(CoilFire, replies)
        for fire in of(CoilFire, replies):
            assert fire.duration_ms == 3000
            assert 1 <= abs(fire.level) <= 3
    assert refusals == 0
    assert fires > 0 or "driver" in settings.get("coils", {})
    assert set(answers) | {TcAckResult.NOT_ALLOWED} == {*TcAckResult} - {TcAckResult.REPEATED}
