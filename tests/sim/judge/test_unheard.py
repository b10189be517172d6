"""What came in place of a boot or an answer is told, with what is wrong of it and the right bytes."""

import pytest

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG
from sim.judge.unheard import tell_unheard

BOOT = "00010000000004"


def told(*frames, tick=None):
    return tell_unheard({"tick": tick, "frames": [{"id": can_id, "data": data} for can_id, data in frames]})


def test_where_nothing_was_noted_nothing_is_told():
    assert tell_unheard(None) == ""
    assert told() == "nothing came"


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        (
            (0x510, "00010000000005"),
            "FSW_BOOT came as 510#00010000000005, with a wrong CRC, expected 510#00010000000004",
        ),
        (
            (0x510, "000100000000FB"),
            "expected 510#00010000000004: its CRC is made without the final XOR",
        ),
        (
            (0x510, "000100000000"),
            "FSW_BOOT came as 510#000100000000, of 6 bytes and not of 7, as in 510#00010000000004",
        ),
        ((0x510 | EXTENDED_FLAG, BOOT), "bit 31 of its identifier makes it an extended frame"),
        ((0x510 | REMOTE_FLAG, ""), "bit 30 of its identifier makes it a remote frame"),
        ((0x510 | ERROR_FLAG, BOOT), "bit 29 of its identifier makes it an error frame"),
        (
            (0x1005, BOOT),
            "FSW_BOOT came as 1005#00010000000004: its identifier has its bytes the other way round",
        ),
        (
            (0x1005_0000, BOOT),
            "FSW_BOOT came as 10050000#00010000000004: its identifier has its bytes the other way round",
        ),
        ((0x511, BOOT), "no FSW_BOOT came, but a frame of no message came as 511#00010000000004"),
        (
            (0x280, "0000000000000000"),
            "no FSW_BOOT came, but TICK_DONE came as 280#0000000000000000",
        ),
    ],
)
def test_what_is_wrong_of_a_boot_is_told(frame, words):
    assert words in told(frame)


def test_of_many_frames_those_like_the_awaited_one_count_and_few_are_told():
    noise = [(0x700 + place, "") for place in range(5)]
    assert told(*noise, (0x510, BOOT[:-2])) == (
        "FSW_BOOT came as 510#000100000000, of 6 bytes and not of 7, as in 510#00010000000004"
    )
    assert told(*noise[1:]).endswith(", and 1 other frame")


def test_in_place_of_an_answer_another_tick_is_named():
    text = told((0x280, "0100000000000000"), tick=0)
    assert text == "TICK_DONE names tick 1 in the answer to tick 0: the one after it"
    assert "of 4 bytes and not of 8" in told((0x280, "00000000"), tick=0)
