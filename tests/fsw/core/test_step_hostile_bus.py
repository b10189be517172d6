"""Three hundred ticks of the flight loop on a bus that lies: nothing is raised, nothing absurd is sent.

Four adversaries: noise; liars, whose frames are intact and whose values are anything; a saboteur, who drops,
repeats, breaks, delays and reorders the frames of a real satellite; and a clock that jumps.
"""

from math import isfinite
from random import Random

import pytest
from flight_states import stepped

from fsw.core.estimation import mekf
from fsw.core.gate.readings import INBOX_LIMIT
from fsw.core.gate.sync_watch import near
from fsw.core.state import Inbox
from fsw.core.state_bytes import checksum
from fsw.core.step import boot
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    CoilFire,
    CoilRefused,
    CoilStatus,
    FswEvent,
    FswHeartbeat,
    MagField,
    Mode,
    NavAttitude,
    NavParameter,
    NavQuality,
    NavRate,
    RefAttitude,
    RefRate,
    SunVector,
    TickDone,
    intact,
)

TICKS = 300
FROM_FSW = (CoilFire, NavAttitude, NavRate, NavQuality, NavParameter, FswEvent, FswHeartbeat, TickDone)
LISTENED = (MagField, SunVector, CoilStatus, CoilRefused, RefAttitude, RefRate)


def noise(random, count):
    """Any identifier, flag, length and content."""
    frames = []
    for _ in range(count):
        can_id = random.choice([random.choice(LISTENED).ID, random.getrandbits(11), random.getrandbits(32)])
        if random.random() < 0.1:
            can_id |= random.choice([EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG])
        frames.append(Frame(can_id & 0xFFFF_FFFF, random.randbytes(random.randrange(9))))
    return frames


def lie(random, message, counter):
    """An intact frame whose payload is random bits, and whose counter moves."""
    payload = message.decode(random.randbytes(message.LENGTH))
    if message is CoilStatus and random.random() < 0.7:
        payload = payload.replace(level=0, current_ma=0, lockout_ms=random.choice([0, 10, 100000]))
    return payload.replace(counter=counter).encode()


def sabotage(random, frames):
    """What becomes of the frames of a tick on a bad bus."""
    out = []
    for frame in frames:
        fate = random.random()
        if fate < 0.05:
            continue
        if fate < 0.10:
            broken = bytearray(frame.data)
            broken[random.randrange(len(broken))] ^= 1 << random.randrange(8)
            out.append(frame.replace(data=bytes(broken)))
            continue
        out.append(frame)
        if fate < 0.15:
            out.append(frame)
    if random.random() < 0.1:
        random.shuffle(out)
    return out + noise(random, random.randrange(3))


class Watch:
    """Keeps what the boards were heard to say, and judges every answer by it."""

    def __init__(self, config):
        self.config = config
        self.lockout_ms = {}
        self.last_fire = None
        self.fires = 0

    def judge(self, inbox, state, outbox):
        if not outbox:
            return
        assert all(intact(frame) for frame in outbox)
        messages = [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]
        assert all(isinstance(message, FROM_FSW) for message in messages)
        assert messages[-1] == TickDone(inbox.tick & 0xFFFF_FFFF, checksum(state))
        fresh = self.hear(inbox)
        for message in messages:
            if isinstance(message, CoilFire):
                self.judge_fire(message, inbox.tick, state, fresh)
            if isinstance(message, NavAttitude):
                assert message.q_x**2 + message.q_y**2 + message.q_z**2 < 1.0001
                assert bool(message.valid) is state.attitude.valid
        self.judge_state(state)

    def hear(self, inbox):
        """The coils of which an intact COIL_STATUS of this tick speaks."""
        coils = set()
        for frame in inbox.frames[:INBOX_LIMIT]:
            if frame.can_id == CoilStatus.ID and intact(frame):
                status = CoilStatus.decode(frame.data)
                self.lockout_ms.setdefault(status.coil, set()).add(status.lockout_ms)
                coils.add(status.coil)
        return coils

    def judge_fire(self, fire, tick, state, fresh):
        self.fires += 1
        assert state.modes.mode is not Mode.SAFE
        assert fresh, "fired without a word of the coil driver in this tick"
        assert 0 in self.lockout_ms.get(fire.coil, ()), "fired though no COIL_STATUS ever said lockout 0"
        assert state.coil.lockout_ms[fire.coil] == 0
        assert 1 <= abs(fire.level) <= 3
        assert fire.coil in (0, 1, 2)
        assert fire.duration_ms == 3000
        assert fire.tick == tick & 0xFF
        assert self.last_fire is None or tick - self.last_fire >= 103 * self.config.tick_hz
        assert tick >= 100 * self.config.tick_hz
        self.last_fire = tick

    def judge_state(self, state):
        numbers = (*state.attitude.q_body_from_orbit, *state.attitude.omega_body_orbit_radps)
        assert all(isfinite(number) for number in numbers)
        assert all(isfinite(owed) for owed in state.pulses.pending_impulse_body_nms)
        assert state.estimator.estimate is None or mekf.healthy(state.estimator.estimate)
        assert abs(sum(c * c for c in state.attitude.q_body_from_orbit) - 1.0) < 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_noise(make_world, seed):
    config, random = make_world().config, Random(seed)
    state, watch = boot(config), Watch(config)
    for tick in range(TICKS):
        inbox = Inbox(tick, random.getrandbits(32), tuple(noise(random, random.randrange(80))))
        state, outbox = stepped(state, inbox, config)
        watch.judge(inbox, state, outbox)
    assert watch.fires == 0
    assert state.modes.mode is Mode.SAFE


@pytest.mark.parametrize("knowledge", ["filter", "perfect"])
@pytest.mark.parametrize("seed", range(6))
def test_false_samples_from_every_board(make_world, seed, knowledge):
    """Random values in well-formed frames, from every board."""
    config, random = make_world(knowledge=knowledge).config, Random(seed)
    state, watch = boot(config), Watch(config)
    for tick in range(TICKS):
        frames = [
            lie(random, m, tick & 0xF) for m in LISTENED if m is not CoilRefused or random.random() < 0.05
        ]
        inbox = Inbox(tick, config.epoch_unix_s + tick, tuple(frames))
        state, outbox = stepped(state, inbox, config)
        watch.judge(inbox, state, outbox)


@pytest.mark.parametrize("seed", range(8))
def test_false_samples_from_one_sensor(make_world, seed):
    """The filter runs; then the Sun sensor or the magnetometer sends random values, at times for long."""
    world, random = make_world(seed=seed), Random(seed)
    watch, liar = Watch(world.config), random.choice([SunVector, MagField])
    for tick in range(TICKS):
        honest = world.inbox()
        frames = honest.frames
        if tick > 120 and random.random() < 0.8:
            replies = [lie(random, liar, tick & 0xF) if f.can_id == liar.ID else f for f in frames]
            frames = tuple(replies)
        inbox = honest.replace(frames=frames)
        world.state, outbox = stepped(world.state, inbox, world.config)
        watch.judge(inbox, world.state, outbox)
        for frame in outbox:
            world.plant.receive(frame)
        world.plant.end_tick()
    assert watch.fires > 0


@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
def test_saboteur(make_world, seed):
    """From boot on, and again once the attitude is proven, which it is late where samples are lost."""
    world, random = make_world(seed=seed), Random(seed)
    watch, refusals, late = Watch(world.config), 0, []

    def fly_sabotaged():
        nonlocal refusals, late
        for _ in range(TICKS):
            honest = world.inbox()
            frames = late + sabotage(random, honest.frames)
            late = [frames.pop()] if frames and random.random() < 0.05 else []
            inbox = honest.replace(frames=tuple(frames))
            world.state, outbox = stepped(world.state, inbox, world.config)
            watch.judge(inbox, world.state, outbox)
            refusals += any(frame.can_id == CoilRefused.ID for frame in honest.frames)
            for frame in outbox:
                world.plant.receive(frame)
            world.plant.end_tick()

    fly_sabotaged()
    assert watch.fires > 0
    assert world.state.estimator.estimate is not None
    world.fly_until_valid()
    fly_sabotaged()
    assert refusals == 0
    assert world.state.gate.rejected > 0
    assert world.state.attitude.valid


@pytest.mark.parametrize("seed", range(6))
def test_a_clock_that_jumps(make_world, seed):
    """Ticks repeat, go back, leap by seconds and by years; boards go on as if nothing were."""
    world, random = make_world(seed=seed), Random(seed)
    watch, clock, unanswered = Watch(world.config), 0, 0
    for _ in range(TICKS):
        honest = world.inbox()
        world.plant.end_tick()
        clock += random.choices([1, 0, -3, 17, 90, 400 * 86400, 2**29], weights=[90, 3, 3, 3, 2, 0.3, 0.1])[0]
        clock = max(0, min(clock, 2**32 - 1))
        inbox = Inbox(clock, random.getrandbits(32), honest.frames)
        before = world.state
        world.state, outbox = stepped(before, inbox, world.config)
        assert outbox or not near(before.tick, clock, world.config.leap_ticks)
        unanswered = 0 if outbox else unanswered + 1
        assert unanswered < 5
        watch.judge(inbox, world.state, outbox)
