"""Random frames into codec, boards and flight loop: no exception comes out, no NaN stays in, no pulse begins.

Ten thousand frames each, as a rule; ``make fuzz`` gives a million. Noise is any identifier, flag, length and
content, and what a few flipped bits make of a good frame; lies are whole frames with any content.
"""

import os
from collections import Counter
from dataclasses import fields, is_dataclass
from fractions import Fraction
from math import inf, isfinite, nan
from random import Random

import numpy as np
import pytest
from flight_states import altered

from fsw.core.state_bytes import checksum
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import CLASSES, SENDERS, CoilDipole, CoilFire, Mode, Sync, TickDone, intact
from hil_stub.coils.coil_driver import OFF, CoilDriver, CoilLimits
from hil_stub.coils.dipole_driver import DipoleDriver
from hil_stub.sensors.magnetometer import Magnetometer
from hil_stub.sensors.sun_sensor import SunSensor
from sim.scenario.schema import flight_table, load

FRAMES = int(os.environ.get("TORQUER_FUZZ_FRAMES", "10000"))
SEED = int(os.environ.get("TORQUER_FUZZ_SEED", "20150327"))
A_TICK = 25
"""Frames between two ticks."""

FLAGS = (EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG)
REQUESTS = (CoilFire, CoilDipole)
NOT_NUMBERS = (nan, inf, -inf, 1e308, -1e308, 5e-324, -0.0)


def any_frame(random):
    """Any identifier, flag, length and content."""
    can_id = random.choice((random.choice(list(CLASSES)), random.getrandbits(11), random.getrandbits(29)))
    if random.random() < 0.2:
        can_id |= random.choice(FLAGS)
    return Frame(can_id, random.randbytes(random.randrange(9)))


def lie(random, message):
    """A whole frame with any content: an identifier's own length, and a CRC that is right."""
    return message.decode(random.randbytes(message.LENGTH)).encode()


def spoiled(random, frame):
    """The frame with one or two bits flipped, or a burst of up to eight: what the CRC finds for sure."""
    word, size = int.from_bytes(frame.data, "big"), 8 * len(frame.data)
    if random.random() < 0.5:
        for bit in random.sample(range(size), random.randint(1, 2)):
            word ^= 1 << bit
    else:
        word ^= random.randrange(1, 256) << random.randrange(size - 7)
    return Frame(frame.can_id, word.to_bytes(len(frame.data), "big"))


def noise(random, tick):
    """No frame of it is whole, but for one in half a million."""
    if random.random() < 0.5:
        return any_frame(random)
    message = random.choice(REQUESTS) if random.random() < 0.5 else random.choice(list(CLASSES.values()))
    good = lie(random, message)
    if message is CoilFire:
        good = fire(random, tick).encode()
    return spoiled(random, good)


def fire(random, tick):
    """A request that answers the tick."""
    return CoilFire(
        level=random.choice((-3, -2, -1, 1, 2, 3)),
        coil=random.randrange(3),
        seq=random.getrandbits(8),
        tick=tick & 0xFF,
        duration_ms=random.choice((1, 1000, 3000, random.randrange(65536))),
    )


def numbers(value):
    """Every float in a nest of values."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, np.ndarray):
        yield from map(float, value.ravel())
    elif isinstance(value, tuple | list):
        for part in value:
            yield from numbers(part)
    elif is_dataclass(value):
        for field in fields(value):
            yield from numbers(getattr(value, field.name))


def in_ticks(random, make):
    """(tick, frames) until all frames are used up."""
    for tick in range(FRAMES // A_TICK):
        yield tick, [make(random, tick) for _ in range(A_TICK)]


# --- codec


def test_the_codec_takes_any_frame_and_gives_numbers():
    random, whole = Random(SEED), 0
    for _ in range(FRAMES):
        frame = any_frame(random) if random.random() < 0.5 else noise(random, 0)
        good = intact(frame)
        whole += good
        assert good is False or (frame.can_id in CLASSES and len(frame.data) == CLASSES[frame.can_id].LENGTH)
        message = CLASSES.get(frame.can_id)
        if message is not None and len(frame.data) == message.LENGTH:
            assert all(isfinite(value) for value in message.decode(frame.data).values())
    assert whole < FRAMES / 10


def test_what_the_codec_decodes_it_encodes_again():
    random = Random(SEED + 1)
    for _ in range(FRAMES):
        message = random.choice(list(CLASSES.values()))
        decoded = message.decode(random.randbytes(message.LENGTH))
        frame = decoded.encode()
        assert intact(frame) or message in (Sync, TickDone)
        assert message.decode(frame.data) == decoded, message


def test_the_codec_sends_no_number_that_is_none():
    """Whatever the values: a frame comes out, and it is whole."""
    random, sent = Random(SEED + 2), Counter()
    for _ in range(FRAMES):
        message = random.choice(list(CLASSES.values()))
        values = list(message.decode(random.randbytes(message.LENGTH)).values())
        for index, value in enumerate(values):
            if isinstance(value, float) and random.random() < 0.5:
                values[index] = random.choice((*NOT_NUMBERS, random.gauss(0.0, 1e6)))
                sent[values[index]] += 1
        frame = message(*values).encode()
        assert all(isfinite(value) for value in message.decode(frame.data).values())
    assert all(sent[value] for value in (inf, -inf, 1e308))


def test_two_flipped_bits_and_a_burst_of_eight_are_always_found():
    random = Random(SEED + 3)
    sealed = [message for message in CLASSES.values() if message not in (Sync, TickDone)]
    for _ in range(FRAMES):
        frame = lie(random, random.choice(sealed))
        assert intact(frame)
        assert not intact(spoiled(random, frame))


# --- boards


def test_noise_moves_no_coil():
    random = Random(SEED + 10)
    board = CoilDriver(CoilLimits(1, backoff_ms=0))
    for tick, frames in in_ticks(random, noise):
        assert all(intact(said) for said in board.begin_tick(tick, random.choice((0.0, *NOT_NUMBERS))))
        for frame in frames:
            if not intact(frame):
                board.receive(frame)
        assert board.drive() == OFF
    assert board.rejects > FRAMES // 2


def test_nor_the_continuous_driver_s():
    random = Random(SEED + 11)
    board = DipoleDriver(1)
    for tick, frames in in_ticks(random, noise):
        assert all(intact(said) for said in board.begin_tick(tick, random.choice((0.0, *NOT_NUMBERS))))
        for frame in frames:
            if not intact(frame):
                board.receive(frame)
        assert board.drive().dipole == (0.0, 0.0, 0.0)
    assert board.rejects > FRAMES // 2


@pytest.mark.parametrize("tick_hz", [1, 7, 10])
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
def test_whatever_is_asked_in_whole_frames_the_board_keeps_the_limits(tick_hz, shared):
    """By stopwatch, on what is driven: pulse, gap, level, one coil; and it does fire."""
    random, backoff_ms = Random(SEED + tick_hz), 5000
    board = CoilDriver(CoilLimits(tick_hz, 3000, backoff_ms, shared))
    free = dict.fromkeys(range(3), Fraction(backoff_ms, 1000))
    on, fired = None, 0
    ticks = max(300, FRAMES // A_TICK)
    for tick in range(ticks):
        now = Fraction(tick, tick_hz)
        board.begin_tick(tick, 0.0)
        for _ in range(A_TICK):
            choice = random.random()
            frame = fire(random, tick).encode() if choice < 0.4 else lie(random, CoilFire)
            board.receive(frame if choice < 0.8 else noise(random, tick))
        drive = board.drive()
        if drive.level == 0:
            on = None
            continue
        assert drive.level in (-3, -2, -1, 1, 2, 3)
        if on is None or on[1] != now or on[0] != drive.coil:
            assert now >= (max(free.values()) if shared else free[drive.coil])
            began, fired = now, fired + 1
        end = now + Fraction(drive.fraction) / tick_hz
        on = (drive.coil, end)
        free[drive.coil] = end + Fraction(backoff_ms, 1000) - Fraction(1, 10**9)
        assert end - began <= 3 + Fraction(1, 10**9)
    assert fired >= ticks // tick_hz // 12


def test_sensors_send_no_number_that_is_none():
    random = Random(SEED + 12)
    magnetometer, sun = Magnetometer(1), SunSensor(1)
    for tick in range(FRAMES):
        vector = tuple(random.choice((*NOT_NUMBERS, random.gauss(0.0, 1e-5))) for _ in range(3))
        for frame in (
            *magnetometer.begin_tick(tick, vector, True),
            *sun.begin_tick(tick, vector, True),
        ):
            assert intact(frame)
            assert all(isfinite(value) for value in CLASSES[frame.can_id].decode(frame.data).values())


# --- flight loop


@pytest.fixture(scope="module", params=["microsat", "cubesat3u"])
def config(request):
    """The flight configuration of a scenario that ships."""
    return flight_config(flight_table(load(request.param)))


def answer(node, tick, frames):
    """The answer to a tick, judged: whole frames, numbers alone, TICK_DONE that names tick and state."""
    for frame in frames:
        assert node.receive(frame) == ()
    said = node.receive(Sync(tick, node.config.epoch_unix_s + tick).encode())
    assert all(intact(frame) or frame.can_id == TickDone.ID for frame in said)
    assert TickDone.decode(said[-1].data) == TickDone(tick, checksum(node.state))
    assert all(isfinite(number) for number in numbers(altered(node.state, ephemeris=None)))
    return said


def no_sync(frame):
    return frame.can_id != Sync.ID


@pytest.mark.long
def test_noise_brings_the_flight_loop_to_nothing_but_safe(config):
    random, node = Random(SEED + 20), FlightNode(config)
    for tick, frames in in_ticks(random, noise):
        bad = [frame for frame in frames if no_sync(frame) and not intact(frame)]
        said = answer(node, tick, bad)
        assert not any(frame.can_id in (CoilFire.ID, CoilDipole.ID) for frame in said)
    assert node.state.modes.mode is Mode.SAFE
    assert node.state.gate.rejected > FRAMES // 3


@pytest.mark.long
def test_false_messages_of_every_node_break_no_limit_of_the_scheduler(config):
    """Each message there is, telecommands among them, with any content."""
    random, node = Random(SEED + 21), FlightNode(config)
    foreign = [m for m in CLASSES.values() if SENDERS[m.ID] != "FSW" and m is not Sync]
    last, backoff = None, config.coils.pulses.backoff_ticks
    for tick, frames in in_ticks(random, lambda random, tick: lie(random, random.choice(foreign))):
        fired = [CoilFire.decode(f.data) for f in answer(node, tick, frames) if f.can_id == CoilFire.ID]
        assert len(fired) <= 1
        for request in fired:
            assert (request.tick, abs(request.level) in (1, 2, 3)) == (tick & 0xFF, True)
            assert tick >= backoff
            assert last is None or tick - last >= config.coils.pulses.pulse_ticks + backoff
            last = tick
