"""A plant that has started anew, or somebody who makes believe so: timers in full, no estimate, and on."""

from itertools import pairwise
from random import Random

import pytest
from flight_states import altered, stepped

from fsw.core.events import Event
from fsw.core.fdir.faults import CoilFault, SensorFault
from fsw.core.fdir.sensors.health import Watch
from fsw.core.gate.second_sender import SIGNS, SecondSenderWatch
from fsw.core.gate.sync_watch import LEAP_S
from fsw.core.modes import ModeState, request_mode
from fsw.core.packing import copy_state, pack
from fsw.core.restart import begin_count
from fsw.core.state import Inbox
from fsw.core.step import takes_inbox
from fsw.wire.messages import CLASSES, CoilFire, FswEvent, Mode, PlantEnd, TickDone

FAR = 10**9
LAST = 2**32 - 1
BACKOFF = 100
FLOWN = 200
LATEST = FLOWN - 1
"""The tick that the flight has reached."""


def decoded(outbox):
    return [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]


def of(kind, messages):
    return [message for message in messages if isinstance(message, kind)]


def reports(messages):
    return [(Event(m.event), m.argument) for m in of(FswEvent, messages)]


def forge(world, tick, frames=()):
    """A SYNC of nobody's: what is answered."""
    inbox = Inbox(tick, world.config.epoch_unix_s + tick, tuple(frames))
    world.state, outbox = stepped(world.state, inbox, world.config)
    return decoded(outbox)


@pytest.fixture
def world(make_world):
    """So many ticks into a flight: the first pulse has been fired, and the attitude is known."""
    world = make_world()
    world.fly(FLOWN)
    assert world.state.attitude.valid
    assert world.state.coil.fired_tick >= BACKOFF
    return world


class TestOneStrange:
    @pytest.mark.requirement("REQ-BUS-03")
    @pytest.mark.parametrize("strange", [0, LATEST - 60, FAR, LAST])
    def test_is_told_with_the_next_answer_and_moves_nothing(self, world, strange):
        before = world.state
        assert forge(world, strange) == []
        assert world.state.ignored_syncs == 1
        assert pack(world.state.estimator) == pack(before.estimator)
        assert pack(world.state.pulses) == pack(before.pulses)
        replies = world.step()
        assert of(TickDone, replies)[0].tick == FLOWN
        signed = strange if strange < 2**31 else strange - 2**32
        assert reports(replies) == [(Event.STRANGE_SYNC, signed)]
        assert reports(world.step()) == []
        assert world.state.estimator.restarts == 0

    def test_in_each_tick_is_told_once_in_a_time(self, world):
        replies = []
        for i in range(30):
            forge(world, FAR + i)
            replies += world.step()
        assert len([one for one in reports(replies) if one[0] is Event.STRANGE_SYNC]) == 3
        assert world.state.estimator.restarts == 0

    @pytest.mark.long
    @pytest.mark.parametrize("first", [FAR, 3])
    def test_in_each_tick_changes_no_request(self, make_world, first):
        """From boot on, though they go on tick by tick."""
        quiet, world = make_world(), make_world()
        honest = [of(CoilFire, replies) for replies in quiet.fly(260)]
        run = []
        for i in range(260):
            run.append(of(CoilFire, world.step()))
            forge(world, first + 1000 + i)
        assert run == honest
        assert any(honest)


@pytest.mark.requirement("REQ-BUS-04")
class TestTwoStrange:
    @pytest.mark.parametrize(
        ("first", "second"), [(FAR, FAR + 1), (FAR, FAR), (0, 1), (20, 20), (LAST, LAST)]
    )
    def test_are_answered_and_told(self, world, first, second):
        forge(world, first)
        replies = forge(world, second)
        assert of(TickDone, replies)[0].tick == second
        assert (Event.PLANT_RESTARTED, LATEST) in reports(replies)
        assert (Event.FILTER_RESTARTED, 1) in reports(replies)
        assert (Event.MODE_CHANGED, Mode.SAFE) in reports(replies)
        assert not world.state.attitude.valid
        assert world.state.estimator.estimate is None
        assert world.state.pulses.ready_tick == (second + BACKOFF,) * 3

    def test_the_first_request_comes_a_full_back_off_later(self, make_world):
        world = make_world()
        world.fly(240)
        world.plant = make_world().plant
        fires = [tick for tick, replies in enumerate(world.fly(270)) if of(CoilFire, replies)]
        assert fires
        assert fires[0] >= 1 + BACKOFF
        assert world.state.attitude.valid
        assert world.state.tick == 269

    def test_the_true_plant_is_followed_at_its_next_sync(self, world):
        forge(world, FAR)
        forge(world, FAR + 1)
        replies = world.step()
        assert of(TickDone, replies)[0].tick == FLOWN
        assert world.state.pulses.ready_tick == (FLOWN + BACKOFF,) * 3

    def test_a_restart_in_mid_pulse_is_no_trip(self, make_world):
        world = make_world()
        while not of(CoilFire, world.step()):
            pass
        forge(world, FAR)
        forge(world, FAR)
        world.fly(20)
        assert world.state.modes.trips == 0
        assert world.state.modes.mode is not Mode.SAFE

    def test_a_first_sync_that_was_wrong_costs_a_tick(self, make_world):
        world = make_world()
        assert of(TickDone, forge(world, FAR))[0].tick == FAR
        answered = [of(TickDone, replies) for replies in world.fly(60)]
        assert [done[0].tick for done in answered[1:]] == list(range(1, 60))
        assert answered[0] == []
        world.fly_until_valid()

    def test_a_skip_that_was_forged_costs_a_tick(self, world):
        assert of(TickDone, forge(world, LATEST + 50))[0].tick == LATEST + 50
        answered = [[done.tick for done in of(TickDone, replies)] for replies in world.fly(30)]
        assert answered == [[], *([tick] for tick in range(FLOWN + 1, FLOWN + 30))]
        assert world.state.pulses.ready_tick == (FLOWN + 1 + BACKOFF,) * 3

    def test_takes_nothing_of_what_came(self, world):
        """It may be of the plant before or of the new one, in part: it is kept for the next SYNC."""
        inbox = world.inbox()
        forge(world, 0)
        before = world.state
        with_frames, answer = stepped(before, inbox.replace(tick=1), world.config)
        assert with_frames.gate == before.gate
        assert stepped(before, Inbox(1, inbox.unix_time_s, ()), world.config)[1] == answer
        assert not takes_inbox(before.tick, with_frames.tick, LEAP_S)
        after, _ = stepped(with_frames, inbox.replace(tick=2), world.config)
        assert takes_inbox(with_frames.tick, after.tick, LEAP_S)


class TestRepeated:
    def test_once_is_a_duplicate_and_nothing_is_told(self, world):
        assert forge(world, LATEST) == []
        assert reports(world.step()) == []

    def test_again_gives_tick_done_alone_and_nothing_starts_anew(self, world):
        """To a plant in lockstep that lost it, and to one that starts anew in this very tick."""
        assert forge(world, LATEST) == []
        before = world.state
        (done,) = forge(world, LATEST)
        assert done.tick == LATEST
        assert pack(world.state.pulses) == pack(before.pulses)
        assert pack(world.state.estimator) == pack(before.estimator)
        assert of(TickDone, world.step())[0].tick == FLOWN


class TestWhatStays:
    def test_what_the_ground_has_set_and_what_was_found(self, world, snapshot):
        health = copy_state(world.state.health)
        health.sensors.sun = Watch(SensorFault.FROZEN)
        health.coils.faults = (0, CoilFault.OPEN, 0)
        coils = copy_state(health.coils)
        modes = ModeState(Mode.POINT, trips=2)
        request_mode(modes, Mode.SAFE, LATEST)
        state = altered(
            world.state,
            health=health,
            modes=modes,
            second_sender=SecondSenderWatch(SIGNS, LATEST - 9, CoilFire.ID),
            orbit=world.state.upload.values,
            ignored_syncs=7,
        )
        after = copy_state(state)
        begin_count(after, 3, world.config)
        for kept in ("gate", "orbit", "upload", "setpoint", "sent", "ignored_syncs", "time_error_s"):
            assert snapshot(getattr(after, kept)) == snapshot(getattr(state, kept))
        assert after.health.coils == coils
        assert after.health.sensors.sun == Watch(SensorFault.FROZEN)
        assert after.health.sensors.pair.proof <= 0
        assert (after.modes.mode, after.modes.trips, after.modes.held) == (Mode.SAFE, 2, True)
        assert after.second_sender == SecondSenderWatch(SIGNS, 3, CoilFire.ID)

    def test_a_second_sender_is_not_forgotten_for_a_forged_pair(self, world):
        world.state = altered(world.state, second_sender=SecondSenderWatch(SIGNS, LATEST, CoilFire.ID))
        forge(world, FAR)
        forge(world, FAR + 1)
        fired = [of(CoilFire, replies) for replies in world.fly(115)]
        assert not any(fired)
        assert world.state.second_sender.detected

    @pytest.mark.requirement("REQ-EVENT-01")
    def test_events_are_held_back_under_the_new_count_too(self, world):
        replies = []
        for i in range(40):
            replies += forge(world, FAR + 10 * i)
            replies += forge(world, FAR + 10 * i + 1)
            replies += world.step()
        kinds = [event for event, _ in reports(replies)]
        assert kinds.count(Event.PLANT_RESTARTED) <= 5
        assert world.state.events.held_back > 60


@pytest.mark.parametrize("tick_hz", [1, 10])
def test_some_seconds_without_a_sync_are_no_restart(make_world, tick_hz):
    """At any tick rate."""
    world = make_world(time={"tick_hz": tick_hz})
    world.fly(5)
    for _ in range(7 * tick_hz):
        world.inbox()
        world.plant.end_tick()
    replies = world.step()
    assert [done.tick for done in of(TickDone, replies)] == [5 + 7 * tick_hz]
    assert Event.PLANT_RESTARTED not in [event for event, _ in reports(replies)]
    assert world.state.ignored_syncs == 0
    assert world.state.estimator.restarts == 0


class TestAttack:
    @pytest.mark.parametrize("seed", range(4))
    def test_by_pairs_again_and_again_no_pulse_comes_early_and_every_tick_is_answered(self, make_world, seed):
        random, world, began = Random(seed), make_world(seed=seed), 0
        for tick in range(400):
            if random.random() < 0.02:
                first = random.choice([random.randrange(LAST), max(0, tick - random.randrange(1, 200))])
                forge(world, first)
                forge(world, first + random.randrange(2))
            before = world.state.tick
            replies = world.step()
            if not before < tick <= before + LEAP_S:
                began = tick
            assert [done.tick for done in of(TickDone, replies)] == [tick]
            assert not of(CoilFire, replies) or tick >= began + BACKOFF

    @pytest.mark.parametrize("seed", range(3))
    def test_by_any_tick_raises_nothing(self, make_world, seed):
        random, world = Random(seed), make_world(seed=seed)
        for _ in range(150):
            tick = random.choice([random.randrange(2**32), LAST, 0, world.state.tick + 1])
            forge(world, max(0, tick))
            forge(world, min(LAST, max(0, tick) + random.randrange(3)))
        world.fly(60)
        assert world.state.tick == 59


class TestEnd:
    @pytest.mark.requirement("REQ-BUS-05")
    def test_after_which_the_flight_goes_on_is_told(self, world):
        end = PlantEnd(7, counter=3).encode()
        replies = world.step(lambda inbox: inbox.replace(frames=(end, *inbox.frames)))
        assert reports(replies) == [(Event.FALSE_END, 7)]
        assert reports(world.step()) == []

    def test_of_the_run_before_is_not(self, make_world):
        world, end = make_world(), PlantEnd(7, counter=3).encode()
        replies = world.step(lambda inbox: inbox.replace(frames=(end, *inbox.frames)))
        assert Event.FALSE_END not in dict(reports(replies))


@pytest.mark.parametrize("ahead", [2, 30])
def test_skips_do_not_shorten_a_back_off(make_world, ahead):
    """Whether ticks were lost or never were nothing tells: those that are answered count."""
    world, fires = make_world(knowledge="perfect"), []
    for count in range(330):
        tick = count * ahead
        inbox = world.inbox().replace(tick=tick, unix_time_s=world.config.epoch_unix_s + tick)
        world.state, outbox = stepped(world.state, inbox, world.config)
        world.plant.end_tick()
        fires += [count for _ in of(CoilFire, decoded(outbox))]
    assert fires
    assert fires[0] >= BACKOFF
    assert all(later - sooner >= BACKOFF for sooner, later in pairwise(fires))
