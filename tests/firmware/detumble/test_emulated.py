"""The flight software in C on an emulated Cortex-M3 answers as on this machine, bit for bit, and is small."""

from random import Random

import pytest
from detumble_bench import Firmware
from detumble_emulated import NO_EMULATOR, EmulatedStep, build_image, has_emulator, sizes

from fsw.wire.messages import CoilFire, CoilStatus, MagField, RefAttitude, RefRate, Sync
from sim.scenario.schema import load

pytestmark = [pytest.mark.long, pytest.mark.skipif(not has_emulator(), reason=NO_EMULATOR)]

TICKS = 3000


@pytest.fixture(scope="module")
def image(tmp_path_factory):
    return build_image(tmp_path_factory.mktemp("image"), load("microsat"))


@pytest.fixture
def emulated(image):
    step = EmulatedStep(image)
    yield step
    step.close()


def inbox(tick, random):
    """What boards may say that are always ready; attitude and rate come in every other 500 ticks."""
    count = tick & 0xF
    field = [random.uniform(-4e4, 4e4) for _ in range(3)]
    frames = [MagField(1, *field, count), CoilStatus(0, tick % 3, 0, 0, 0, tick & 0xFF, count)]
    if tick // 500 % 2:
        frames.append(RefAttitude(1, *[random.uniform(-0.5, 0.5) for _ in range(3)], count))
        frames.append(RefRate(1, *[random.uniform(-0.004, 0.004) for _ in range(3)], count))
    return [frame.encode() for frame in (*frames, Sync(tick, 0))]


def test_it_answers_as_on_this_machine(firmware_of, emulated, capsys):
    here, there, random = firmware_of("microsat"), Firmware(emulated), Random("emulated")
    assert there.boot() == here.boot()
    fired, most = 0, 0
    for tick in range(TICKS):
        frames = inbox(tick, random)
        answer = here.answer(frames)
        assert there.answer(frames) == answer, tick
        fired += answer[0].can_id == CoilFire.ID
        most = max(most, emulated.instructions)
    with capsys.disabled():
        print(f"\n{fired} requests in {TICKS} ticks, at most {most} instructions a tick")
    assert fired > 20
    assert 0 < most < 40_000


def test_it_fits_a_small_processor(image, capsys):
    text, data, bss = sizes(image)
    with capsys.disabled():
        print(f"\n{text} bytes of text, {data} of data, {bss} of bss")
    assert text < 16_384
    assert data + bss < 2_048
