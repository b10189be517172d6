"""The DBC for other tools: the contract itself, with the periods at which messages come."""

from itertools import pairwise

import cantools
import pytest

from sim.export.dictionary import DBC, dbc_text, messages


def cycles_ms(tick_hz):
    database = cantools.database.load_string(dbc_text(tick_hz), "dbc")
    return {message.name: message.cycle_time or 0 for message in database.messages}


def test_it_is_the_contract(tmp_path):
    assert dbc_text(1) == DBC.read_text()


@pytest.mark.long
def test_cycle_times_are_those_of_a_flight(flight):
    """Each message that comes more than twice and regularly has its period; no other has one."""
    stated = cycles_ms(1)
    measured = {}
    for message in messages():
        times = [entry.timestamp_us for entry in flight.entries if entry.frame.can_id == message.can_id]
        gaps = {(after - before) // 1000 for before, after in pairwise(times)}
        if len(times) > 2:
            measured[message.name] = gaps.pop() if len(gaps) == 1 else 0
    assert {name: stated[name] for name in measured} == measured
    assert set(measured.values()) == {0, 1000, 10_000, 60_000}
    assert all(stated[f"{node}_HEARTBEAT"] == 60_000 for node in ("PLANT", "FSW", "COIL", "MAG", "SUN"))


@pytest.mark.long
def test_messages_of_every_tick_follow_the_tick_rate():
    slow, fast = cycles_ms(1), cycles_ms(10)
    assert fast["SYNC"] == fast["MAG_FIELD"] == fast["NAV_ATTITUDE"] == 100
    assert {name for name in slow if slow[name] != fast[name]} == {
        name for name in slow if slow[name] == 1000
    }
    assert cycles_ms(3)["SYNC"] == 333


@pytest.mark.parametrize("message", messages(), ids=lambda message: message.name)
def test_the_dictionary_has_what_cantools_reads(message):
    found = cantools.database.load_file(DBC).get_message_by_name(message.name)
    assert (message.can_id, message.length, message.sender) == (
        found.frame_id,
        found.length,
        found.senders[0],
    )
    assert {signal.name for signal in message.signals} == {signal.name for signal in found.signals}
    assert sum(signal.length for signal in message.signals) <= 8 * message.length
