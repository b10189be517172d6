"""C that compiles without a warning, and packs and unpacks every message to the bytes of the contract."""

import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from fsw.wire.frame import crc8
from fsw.wire.messages import CLASSES, NAMES, CoilFire, Sync, TickDone
from sim.export.c_source import CONSTANTS, CRC, HEADER, LIMITS, SOURCE, board_limits, c_files
from sim.export.dictionary import messages
from sim.scenario.schema import load, parse_settings

ROOT = Path(__file__).resolve().parents[3]
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror")
UNSEALED = (Sync.ID, TickDone.ID)

MAIN = """
#include <stdio.h>
#include <string.h>
#include "torquer.h"
#include "torquer_crc.h"
#include "torquer_scenario.h"

int main(void)
{
    unsigned id, length, byte;
    while (scanf("%x %u", &id, &length) == 2) {
        uint8_t data[8] = {0}, again[8] = {0};
        for (unsigned place = 0; place < length; place++) {
            if (scanf("%2x", &byte) != 1) return 1;
            data[place] = (uint8_t)byte;
        }
        int size = -1;
        switch (id) {
CASES
        }
        if (SEALED) {
            if (!torquer_intact((uint16_t)id, data, length)) return 2;
            torquer_seal((uint16_t)id, again, length);
        }
        printf("%d ", size);
        for (unsigned place = 0; place < length; place++) printf("%02x", again[place]);
        printf("\\n");
    }
    const double levels[3] = TORQUER_LEVELS_AM2, axes[3][3] = TORQUER_COIL_AXES;
    printf("%u %u %d ", TORQUER_PULSE_MS, TORQUER_BACKOFF_MS, TORQUER_BACKOFF_SHARED);
    printf("%g %g\\n", levels[2], axes[0][1]);
    return 0;
}
"""
CASE = """
            case 0x{id:x}: {{
                struct torquer_{name}_t message;
                if (torquer_{name}_unpack(&message, data, length)) return 3;
                size = torquer_{name}_pack(again, &message, sizeof again);
                break;
            }}"""


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """A program that unpacks each line of its input and packs it again."""
    folder = tmp_path_factory.mktemp("c")
    turned = "flight.calibration.coils.matrix=[[0.0,1.0,0.0],[1.0,0.0,0.0],[0.0,0.0,1.0]]"
    for name, text in c_files(load("microsat", parse_settings((turned,)))).items():
        (folder / name).write_text(text)
    cases = "".join(CASE.format(id=one.can_id, name=one.name.lower()) for one in messages())
    sealed = " && ".join(f"id != 0x{can_id:x}" for can_id in UNSEALED)
    (folder / "main.c").write_text(MAIN.replace("CASES", cases).replace("SEALED", sealed))
    words = ["gcc", *FLAGS, SOURCE, "main.c", "-o", "main", "-lm"]
    built = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    return folder / "main"


def random_frame(one, rng):
    """Data of a message with random bits in its signals, spare ones 0."""
    word = 0
    for signal in one.signals:
        word |= rng.getrandbits(signal.length) << signal.start
    data = word.to_bytes(one.length, "little")
    if one.can_id in UNSEALED:
        return data
    return data[:-1] + bytes([crc8(one.can_id.to_bytes(2, "big") + data[:-1])])


@needs_gcc
@pytest.mark.long
def test_every_message_is_packed_as_it_was_unpacked(program):
    rng = random.Random(7)
    sent = [(one, random_frame(one, rng)) for one in messages() for _ in range(20)]
    lines = "\n".join(f"{one.can_id:x} {one.length} {data.hex()}" for one, data in sent)
    done = subprocess.run([program], input=lines, capture_output=True, text=True, check=True)
    *found, constants = done.stdout.splitlines()
    assert found == [f"{one.length} {data.hex()}" for one, data in sent]
    assert constants == "3000 100000 1 8 1"


@needs_gcc
@pytest.mark.long
def test_a_broken_crc_is_not_intact(program):
    whole = CoilFire(3, 1, 7, 100, 3000).encode().data
    broken = whole[:-1] + bytes([whole[-1] ^ 1])
    for data, code in ((whole, 0), (broken, 2)):
        done = subprocess.run(
            [program], input=f"80 7 {data.hex()}", capture_output=True, text=True, check=False
        )
        assert done.returncode == code


def test_every_message_is_there_and_the_files_do_not_change_with_the_time():
    first, second = (c_files(load("posat1")) for _ in range(2))
    assert first == second
    assert set(first) == {HEADER, SOURCE, CRC, CONSTANTS, LIMITS}
    ids = {int(text, 16) for text in re.findall(r"_FRAME_ID \((0x[0-9a-f]+)u\)", first[HEADER])}
    assert ids == set(NAMES) == set(CLASSES)


def test_a_circular_orbit_and_given_attitude_are_told():
    constants = c_files(load("posat1"))[CONSTANTS]
    assert "#define TORQUER_REFERENCE_GIVEN 1 " in constants
    assert "#define TORQUER_ALTITUDE_KM 800.0 " in constants
    assert "TLE" not in constants


class TestBoardLimits:
    def test_those_of_microsat_are_what_the_board_in_c_ships_with(self):
        shipped = ROOT / "examples" / "firmware" / "coil_board" / "limits" / LIMITS
        assert board_limits(load("microsat")) == shipped.read_text(encoding="utf-8")

    def test_others_are_those_of_the_scenario(self):
        settings = ("coils.pulse_s=2.5", "coils.backoff_s=90", "coils.backoff=per_coil", "time.tick_hz=10")
        text = board_limits(load("microsat", parse_settings(settings)))
        for line in ("TICK_HZ 10U", "PULSE_MS 2500U", "BACKOFF_MS 90000U", "SHARED 0", "LEVEL_2_MA 100"):
            assert f"#define LIMITS_{line}\n" in text

    def test_there_are_none_of_a_continuous_driver(self):
        driven = load("microsat", parse_settings(("coils.driver=continuous", "coils.max_dipole_am2=8")))
        assert LIMITS not in c_files(driven)


def test_the_axes_of_the_nominal_attitude_are_those_that_look_up_and_ahead():
    turned = load("microsat", parse_settings(("body.up=z", "body.ahead=-x")))
    rows = "{{0.0, 0.0, 1.0}, {(-1.0), 0.0, 0.0}, {0.0, (-1.0), 0.0}}"
    assert f"#define TORQUER_NOMINAL_AXES {rows}" in c_files(turned)[CONSTANTS]
