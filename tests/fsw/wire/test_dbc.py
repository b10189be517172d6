"""Rules that every message of the DBC keeps, and the generated codec is what the DBC says."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fsw.core.events import Event
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    CoilRefusedReason,
    Component,
    CountedMessage,
    Element,
    Gain,
    Mode,
    Severity,
    TcAckResult,
    WheelStatusResult,
)
from hil_stub.wheel.wheel_driver import WheelEventCode

ROOT = Path(__file__).parents[3]
FULL = {"SYNC", "TICK_DONE"}
"""Messages without room for counter and CRC."""

CONTRACT = {
    "SYNC": ("PLANT", {"tick": 32, "unix_time_s": 32}),
    "MAG_FIELD": ("MAG", {"b_x": -16, "b_y": -16, "b_z": -16, "valid": 1}),
    "SUN_VECTOR": ("SUN", {"s_x": -16, "s_y": -16, "s_z": -16, "valid": 1}),
    "SUN_CELLS": ("SUN", {"valid": 1, **{f"cell_{number}": 8 for number in range(1, 7)}}),
    "COIL_FIRE": ("FSW", {"coil": 2, "level": -4, "duration_ms": 16, "seq": 8, "tick": 8}),
    "COIL_STATUS": (
        "COIL",
        {"coil": 2, "level": -4, "current_ma": -12, "remaining_ms": 12, "lockout_ms": 14, "seq": 8},
    ),
    "COIL_REFUSED": ("COIL", {"seq": 8, "reason": 8}),
    "COIL_DIPOLE": ("FSW", {}),
    "WHEEL_TORQUE": ("FSW", {"torque": -24, "tick": 8}),
    "WHEEL_STATUS": ("WHEEL", {"valid": 1, "result": 3, "speed": -24, "torque": -24}),
    "NAV_ATTITUDE": ("FSW", {}),
    "NAV_RATE": ("FSW", {}),
    "NAV_QUALITY": ("FSW", {"mode": 3}),
    "NAV_PARAMETER": ("FSW", {"component": 6, "exponent": -8, "value": -19, "sigma": 19}),
    "TICK_DONE": ("FSW", {"tick": 32, "state_crc": 32}),
    "FSW_BOOT": ("FSW", {"table_crc": 32}),
    "TC_MODE": ("GROUND", {"mode": 3}),
    "TC_CLEAR": ("GROUND", {}),
    "TC_LAW": ("GROUND", {"law": 8}),
    "TC_SPIN": ("GROUND", {"spin": -17}),
    "TC_GAIN": ("GROUND", {"gain": 4, "exponent": -8, "mantissa": -32}),
    "TC_ORBIT_ELEMENT": ("GROUND", {"element": 4, "exponent": -8, "mantissa": -32}),
    "TC_ORBIT_LOAD": ("GROUND", {}),
    "TC_PARAMETER": ("GROUND", {"component": 6, "exponent": -8, "mantissa": -32}),
    "TC_FREEZE": ("GROUND", {"frozen": 1}),
    "TC_ACK": ("FSW", {"result": 4, "command": 11, "command_counter": 4, "tick": 32}),
}
"""Sender, and the width of the signals that others rely on; negative: signed."""


def test_identifiers_are_11_bits_and_unique(dbc):
    ids = [message.frame_id for message in dbc.messages]
    assert len(ids) == len(set(ids))
    assert all(0 < can_id < 0x800 for can_id in ids)
    assert not any(message.is_extended_frame or message.is_fd for message in dbc.messages)


def test_names_are_unique(dbc):
    names = [message.name for message in dbc.messages]
    assert len(names) == len(set(names))


def test_no_message_is_longer_than_a_classic_frame(dbc):
    assert all(1 <= message.length <= 8 for message in dbc.messages)


def test_every_message_but_sync_and_tick_done_is_counted_and_sealed(dbc):
    for message in dbc.messages:
        names = {signal.name for signal in message.signals}
        assert ({"counter", "crc"} <= names) == (message.name not in FULL), message.name


def test_the_counter_has_four_bits_and_the_crc_is_the_last_byte(dbc):
    for message in dbc.messages:
        if message.name in FULL:
            continue
        counter, crc = message.get_signal_by_name("counter"), message.get_signal_by_name("crc")
        assert (counter.start, counter.length, counter.is_signed) == (0, 4, False), message.name
        assert (crc.start, crc.length, crc.is_signed) == (8 * (message.length - 1), 8, False), message.name


def test_signals_do_not_overlap_and_fit(dbc):
    for message in dbc.messages:
        taken = [
            bit for signal in message.signals for bit in range(signal.start, signal.start + signal.length)
        ]
        assert len(taken) == len(set(taken)), message.name
        assert max(taken) < 8 * message.length, message.name
        assert all(signal.byte_order == "little_endian" for signal in message.signals)


def test_the_stated_range_is_exactly_what_the_bits_hold(dbc):
    """Saturation is at the range of the bits; a narrower range in the DBC would be a promise not kept."""
    for message in dbc.messages:
        for signal in message.signals:
            low, high = (
                (-(1 << signal.length - 1), (1 << signal.length - 1) - 1)
                if signal.is_signed
                else (0, (1 << signal.length) - 1)
            )
            assert signal.offset == 0
            assert signal.minimum == pytest.approx(low * signal.scale, rel=1e-12), signal.name
            assert signal.maximum == pytest.approx(high * signal.scale, rel=1e-12), signal.name


@pytest.mark.parametrize("name", CONTRACT)
def test_what_others_rely_on_is_there(dbc, name):
    sender, widths = CONTRACT[name]
    message = dbc.get_message_by_name(name)
    assert message.senders == [sender]
    for signal_name, width in widths.items():
        signal = message.get_signal_by_name(signal_name)
        assert signal.length * (-1 if signal.is_signed else 1) == width, signal_name


def test_units_that_others_rely_on(dbc):
    def unit(message, signal):
        return dbc.get_message_by_name(message).get_signal_by_name(signal).unit

    assert {unit("MAG_FIELD", f"b_{axis}") for axis in "xyz"} == {"nT"}
    assert unit("SYNC", "unix_time_s") == "s"
    assert unit("WHEEL_TORQUE", "torque") == unit("WHEEL_STATUS", "torque") == "N m"
    assert unit("WHEEL_STATUS", "speed") == "rad/s"
    assert unit("COIL_FIRE", "duration_ms") == unit("COIL_STATUS", "lockout_ms") == "ms"
    assert dbc.get_message_by_name("COIL_STATUS").get_signal_by_name("lockout_ms").scale == 10


def test_every_node_boots_beats_and_tells_events_under_ids_of_its_own(dbc):
    nodes = {node.name for node in dbc.nodes} - {"GROUND"}  # it has no clock on board
    assert nodes == {"PLANT", "FSW", "COIL", "MAG", "SUN", "WHEEL"}
    for node in nodes:
        for kind in ("BOOT", "EVENT", "HEARTBEAT"):
            assert dbc.get_message_by_name(f"{node}_{kind}").senders == [node]


def test_requests_come_before_reports_in_arbitration(dbc):
    """The lower the identifier, the sooner it gets the bus."""
    order = [m.name for m in sorted(dbc.messages, key=lambda m: m.frame_id)]
    assert order.index("COIL_FIRE") == 0
    assert order.index("COIL_FIRE") < order.index("TC_MODE") < order.index("COIL_STATUS")
    assert order.index("COIL_STATUS") < order.index("SYNC") < order.index("NAV_ATTITUDE")
    assert order.index("TICK_DONE") < order.index("FSW_EVENT") < order.index("FSW_HEARTBEAT")


def test_the_codec_knows_the_dbc_s_messages_and_senders(dbc):
    assert {m.frame_id: m.name for m in dbc.messages} == NAMES
    assert {m.frame_id: m.senders[0] for m in dbc.messages} == SENDERS
    shapes = {m.frame_id: (m.frame_id, m.length) for m in dbc.messages}
    assert {can_id: (c.ID, c.LENGTH) for can_id, c in CLASSES.items()} == shapes
    assert {c.ID for c in CLASSES.values()} - {c.ID for c in CountedMessage.__args__} == {0x180, 0x280}


@pytest.mark.parametrize(
    ("enum", "message", "signal"),
    [
        (Mode, "NAV_QUALITY", "mode"),
        (Severity, "FSW_EVENT", "severity"),
        (Event, "FSW_EVENT", "event"),
        (CoilRefusedReason, "COIL_REFUSED", "reason"),
        (Mode, "TC_MODE", "mode"),
        (Gain, "TC_GAIN", "gain"),
        (Element, "TC_ORBIT_ELEMENT", "element"),
        (Component, "TC_PARAMETER", "component"),
        (Component, "NAV_PARAMETER", "component"),
        (TcAckResult, "TC_ACK", "result"),
        (WheelStatusResult, "WHEEL_STATUS", "result"),
        (WheelEventCode, "WHEEL_EVENT", "event"),
    ],
)
def test_enums_are_the_dbc_s_choices(dbc, enum, message, signal):
    choices = dbc.get_message_by_name(message).get_signal_by_name(signal).choices
    assert {member.value: member.name for member in enum} == {k: str(v).upper() for k, v in choices.items()}


def test_an_acknowledgement_names_telecommands_by_their_identifiers(dbc):
    choices = dbc.get_message_by_name("TC_ACK").get_signal_by_name("command").choices
    sent = {m.frame_id: m.name for m in dbc.messages if m.senders == ["GROUND"]}
    assert {number: str(name) for number, name in choices.items()} == sent
    assert all(name.startswith("TC_") for name in sent.values())


def generate(root, *arguments):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        [sys.executable, str(root / "tools" / "generate_messages.py"), *arguments],
        env={**os.environ, "PATH": path},
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.long
def test_the_generated_codec_is_fresh():
    shown = generate(ROOT, "--check")
    assert shown.returncode == 0, shown.stdout + shown.stderr


@pytest.mark.long
def test_a_stale_codec_is_noticed(tmp_path):
    for name in (
        "tools/generate_messages.py",
        "fsw/wire/torquer.dbc",
        "fsw/wire/messages.py",
        "pyproject.toml",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    assert generate(tmp_path, "--check").returncode == 0
    dbc = tmp_path / "fsw" / "wire" / "torquer.dbc"
    dbc.write_text(dbc.read_text().replace("lockout_ms : 34|14@1+ (10,0)", "lockout_ms : 34|14@1+ (5,0)"))
    shown = generate(tmp_path, "--check")
    assert shown.returncode == 1
    assert "stale" in shown.stdout
