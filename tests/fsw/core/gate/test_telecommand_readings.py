"""Telecommands at the decode gate: none is lost, and a repeated one is told from a new one."""

from zlib import crc32

import pytest
from gate_samples import COIL, FIELD, admitted

from fsw.core.gate.readings import TELECOMMANDS, GateState, Readings
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
)

TELECOMMAND_OF = {
    TcMode.ID: TcMode(2, counter=3),
    TcClear.ID: TcClear(counter=3),
    TcLaw.ID: TcLaw(10, counter=3),
    TcSpin.ID: TcSpin(-(2.0**-9), counter=3),
    TcGain.ID: TcGain(1, -1, 16149, counter=3),
    TcOrbitElement.ID: TcOrbitElement(4, -7, 8932, counter=3),
    TcOrbitLoad.ID: TcOrbitLoad(counter=3),
    TcParameter.ID: TcParameter(17, -9, -45678, counter=3),
    TcFreeze.ID: TcFreeze(1, counter=3),
}


@pytest.mark.parametrize("message", TELECOMMAND_OF.values(), ids=lambda m: type(m).__name__)
class TestTelecommands:
    """None is lost: all of one tick count, in their order, and a repeated one is told from a new one."""

    def test_is_the_only_one_heard(self, message):
        readings, state = admitted(message)
        assert readings == Readings(telecommands=(message,))
        assert (state.input_crc, state.command_crc) == (0, crc32(message.encode().data))
        assert (state.rejected, state.missed) == (0, 0)

    def test_all_of_one_kind_count(self, message):
        sent = tuple(message.replace(counter=n & 0xF) for n in range(14, 20))
        readings, state = admitted(*sent)
        assert readings.telecommands == sent
        assert (state.rejected, state.missed) == (0, 0)

    def test_one_with_the_counter_of_the_one_before_is_told_apart(self, message):
        readings, state = admitted(message, message)
        assert (readings.telecommands, readings.repeated) == ((message,), (message,))
        assert state.rejected == 1
        readings, later = admitted(message, state=state)
        assert (readings.telecommands, readings.repeated) == ((), (message,))
        assert (later.rejected, later.command_crc) == (2, state.command_crc)

    def test_gaps_are_counted(self, message):
        readings, state = admitted(message, message.replace(counter=9))
        assert len(readings.telecommands) == 2
        assert state.missed == 5

    @pytest.mark.parametrize(
        "change", [lambda d: bytes((d[0] ^ 0x20,)) + d[1:], lambda d: d[:-1], lambda d: b""]
    )
    def test_a_broken_one_is_counted_and_nothing_else(self, message, change):
        frame = message.encode()
        assert admitted(frame.replace(data=change(frame.data))) == (Readings(), GateState(rejected=1))


def test_telecommands_of_all_kinds_stay_in_their_order():
    sent = tuple(TELECOMMAND_OF[can_id] for can_id in reversed(TELECOMMANDS))
    readings, _ = admitted(FIELD, *sent[:3], COIL, *sent[3:])
    assert readings == Readings(field=FIELD, coil=COIL, telecommands=sent)


def test_each_of_several_that_are_repeated_is_told():
    sent = (TELECOMMAND_OF[TcSpin.ID], TELECOMMAND_OF[TcLaw.ID])
    _, known = admitted(*sent)
    readings, state = admitted(sent[1], FIELD, sent[0], sent[1], state=known)
    assert (readings.telecommands, readings.repeated) == ((), (sent[1], sent[0], sent[1]))
    assert state.rejected == 3


def test_where_a_telecommand_stands_among_the_boards_messages_does_not_count():
    one = (TELECOMMAND_OF[TcSpin.ID], TELECOMMAND_OF[TcLaw.ID])
    orders = [(*one, FIELD, COIL), (one[0], FIELD, one[1], COIL), (FIELD, COIL, *one)]
    assert admitted(*orders[0]) == admitted(*orders[1]) == admitted(*orders[2])
    assert admitted(*reversed(one), FIELD, COIL) != admitted(*orders[0])


def test_every_telecommand_is_listened_to():
    assert set(TELECOMMANDS) == {can_id for can_id, sender in SENDERS.items() if sender == "GROUND"}
    assert {can_id: CLASSES[can_id] for can_id in TELECOMMANDS} == TELECOMMANDS
