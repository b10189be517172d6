"""The flight codec against cantools, both ways, over every message and signal; and golden bytes."""

from math import inf, nan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.wire.frame import EXTENDED_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    CoilFire,
    CoilStatus,
    MagField,
    NavAttitude,
    SunVector,
    Sync,
    TickDone,
    intact,
)
from fsw.wire.value import Value

EVERY_MESSAGE = pytest.mark.parametrize("name", NAMES.values())
SEALED = [name for name in NAMES.values() if name not in ("SYNC", "TICK_DONE")]
BY_NAME = {NAMES[can_id]: message for can_id, message in CLASSES.items()}


def crc8_by_bits(data: bytes) -> int:
    """SAE J1850, written out."""
    register = 0xFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ 0x1D if register & 0x80 else register << 1) & 0xFF
    return register ^ 0xFF


def raw_values(message, word):
    """The number that ``word`` holds for each signal but the CRC: what a random payload means."""
    values = {}
    for signal in message.signals:
        if signal.name != "crc":
            bits = word >> signal.start & (1 << signal.length) - 1
            negative = signal.is_signed and bits >> signal.length - 1
            values[signal.name] = bits - (1 << signal.length) if negative else bits
    return values


def number(signal):
    """The type of a quantity."""
    return int if signal.unit in ("ms", "mA", "s") else float


def physical(message, values):
    return {name: value * message.get_signal_by_name(name).scale for name, value in values.items()}


WORDS = st.integers(0, 2**64 - 1)
EXTREMES = (0, 2**64 - 1, 0x5555_5555_5555_5555, 0xAAAA_AAAA_AAAA_AAAA)


class TestAgainstCantools:
    """Two implementations of one contract; each random word is tried on every message."""

    @pytest.mark.long
    @given(word=WORDS | st.sampled_from(EXTREMES))
    @settings(max_examples=150, deadline=None)
    def test_what_we_encode_cantools_decodes(self, dbc, word):
        for message in dbc.messages:
            values = raw_values(message, word)
            frame = BY_NAME[message.name](**physical(message, values)).encode()
            assert frame.can_id == message.frame_id
            assert intact(frame), message.name
            decoded = message.decode(frame.data, decode_choices=False, scaling=False)
            decoded.pop("crc", None)
            assert decoded == values, message.name

    @pytest.mark.long
    @given(word=WORDS | st.sampled_from(EXTREMES))
    @settings(max_examples=150, deadline=None)
    def test_what_cantools_encodes_we_decode(self, dbc, word):
        for message in dbc.messages:
            values = raw_values(message, word)
            if message.name in SEALED:
                unsealed = message.encode({**values, "crc": 0}, scaling=False)[:-1]
                packed = unsealed + bytes((crc8_by_bits(message.frame_id.to_bytes(2, "big") + unsealed),))
            else:
                packed = message.encode(values, scaling=False)
            assert intact(Frame(message.frame_id, packed)), message.name
            decoded = BY_NAME[message.name].decode(packed)
            assert decoded.by_name() == physical(message, values), message.name
            assert decoded.encode().data == packed, message.name

    @given(word=WORDS, off=st.floats(-0.499, 0.499))
    @settings(max_examples=100, deadline=None)
    def test_quantities_between_units_go_to_the_nearest(self, dbc, word, off):
        for message in dbc.messages:
            values = raw_values(message, word)
            between = {
                signal.name: values[signal.name] * signal.scale + number(signal)(off * signal.scale)
                for signal in message.signals
                if signal.unit and (message.name, signal.name) != ("SYNC", "unix_time_s")
            }
            frame = BY_NAME[message.name](**{**physical(message, values), **between}).encode()
            decoded = message.decode(frame.data, decode_choices=False, scaling=False)
            decoded.pop("crc", None)
            assert decoded == values, message.name

    @EVERY_MESSAGE
    def test_quantities_beyond_the_range_saturate_there(self, dbc, name):
        message = dbc.get_message_by_name(name)
        quantities = [signal for signal in message.signals if signal.unit]
        rest = {s.name: 1 for s in message.signals if not s.unit and s.name != "crc"}
        for signal in quantities:
            others = {other.name: number(other)(0) for other in quantities}
            no_integers = [(inf, signal.maximum), (-inf, signal.minimum), (nan, signal.minimum)]
            for value, limit in (
                (1e30, signal.maximum),
                (-1e30, signal.minimum),
                (signal.maximum + 0.4 * signal.scale, signal.maximum),
                *(no_integers if number(signal) is float else ()),
            ):
                frame = BY_NAME[name](**{**rest, **others, signal.name: number(signal)(value)}).encode()
                decoded = message.decode(frame.data, decode_choices=False)
                assert decoded.pop(signal.name) == pytest.approx(limit, rel=1e-12)
                assert {key: decoded[key] for key in rest} == rest
                assert all(decoded[other.name] == 0 for other in quantities if other is not signal)

    @EVERY_MESSAGE
    def test_codes_wrap_at_their_width_and_change_no_other(self, dbc, name):
        message = dbc.get_message_by_name(name)
        codes = [signal for signal in message.signals if not signal.unit and signal.name != "crc"]
        zero = {s.name: 0 for s in message.signals if s.name != "crc"}
        for signal in codes:
            frame = BY_NAME[name](
                **{**zero, signal.name: (1 << signal.length) + 5 % (1 << signal.length)}
            ).encode()
            decoded = message.decode(frame.data, decode_choices=False)
            decoded.pop("crc", None)
            assert decoded.pop(signal.name) == 5 % (1 << signal.length)
            assert set(decoded.values()) <= {0}


class TestGoldenBytes:
    """Worked out by hand from the DBC; the CRC bit by bit."""

    @pytest.mark.parametrize(
        ("message", "can_id", "data"),
        [
            # counter 3, valid: 0x13; 20000 / 2 = 0x2710; -7000 / 2 = 0xF254; 31000 / 2 = 0x3C8C
            (MagField(1, 20000.0, -7000.0, 31000.0, counter=3), 0x110, "13 1027 54F2 8C3C 1C"),
            # counter 7, level -2 = 0xE; coil 1; seq, tick; 3000 ms = 0x0BB8
            (
                CoilFire(level=-2, coil=1, seq=0x5A, tick=0xC3, duration_ms=3000, counter=7),
                0x080,
                "E7 01 5A C3 B80B 8E",
            ),
            # counter 15, level 3: 0x3F; coil 2; 2000 ms from bit 10, -150 mA = 0xF6A from 22, 10234 from 34
            (CoilStatus(3, 2, 2000, -150, 102340, 9, counter=15), 0x100, "3F 42 9F DA EB 9F 09 FA"),
            # 0.6, -0.48, 0.64 in units of 2^-14: 9830 = 0x2666, -7864 = 0xE148, 10486 = 0x28F6
            (SunVector(1, 0.6, -0.48, 0.64, counter=11), 0x118, "1B 6626 48E1 F628 B0"),
            # units of 2^-16 from bits 5, 22 and 39: 0x8000 << 5 | (-0x4000 & 0x1FFFF) << 22 | 0x2000 << 39
            (NavAttitude(1, 0.5, -0.25, 0.125, counter=9), 0x200, "19 00 10 00 70 00 10 EB"),
            (Sync(0x12345678, 1427513417), 0x180, "78563412 49201655"),
            (TickDone(20000, 0xCAFEF00D), 0x280, "204E0000 0DF0FECA"),
        ],
        ids=lambda value: type(value).__name__ if isinstance(value, Value) else "",
    )
    def test_bytes(self, message, can_id, data):
        golden = bytes.fromhex(data)
        if not isinstance(message, Sync | TickDone):
            assert golden[-1] == crc8_by_bits(can_id.to_bytes(2, "big") + golden[:-1])
        assert message.encode() == Frame(can_id, golden)
        assert intact(Frame(can_id, golden))

    def test_the_counter_turns_over_after_sixteen_frames(self):
        field = MagField(1, 2.0, 4.0, 6.0)
        counters = [MagField.decode(field.replace(counter=n).encode().data).counter for n in range(33)]
        assert counters == [n % 16 for n in range(33)]

    @pytest.mark.parametrize("name", SEALED)
    def test_a_message_without_a_count_bears_zero(self, dbc, name):
        fields = [field for field in BY_NAME[name].FIELDS if field != "counter"]
        frame = BY_NAME[name](**dict.fromkeys(fields, 1)).encode()
        assert dbc.get_message_by_name(name).decode(frame.data)["counter"] == 0

    def test_negative_levels_come_back_negative(self):
        for level in range(-8, 8):
            assert CoilStatus.decode(CoilStatus(level, 0, 0, 0, 0, 0).encode().data).level == level


class TestIntact:
    """A frame is taken whole or not at all."""

    @pytest.fixture(params=SEALED)
    def frame(self, request):
        message = BY_NAME[request.param]
        return message(**dict.fromkeys(message.FIELDS, 1)).encode()

    def test_as_encoded(self, frame):
        assert intact(frame)

    def test_not_with_any_single_bit_flipped(self, frame):
        word = int.from_bytes(frame.data, "big")
        for bit in range(8 * len(frame.data)):
            assert not intact(frame.replace(data=(word ^ 1 << bit).to_bytes(len(frame.data), "big")))

    def test_not_under_another_identifier(self, frame):
        """The identifier is sealed too: a frame that is heard under another name is not believed."""
        others = [can_id for can_id in CLASSES if can_id not in (frame.can_id, Sync.ID, TickDone.ID)]
        assert not any(intact(frame.replace(can_id=can_id)) for can_id in others)

    def test_not_with_another_length(self, frame):
        assert not intact(frame.replace(data=b""))
        assert not intact(frame.replace(data=frame.data[:-1]))
        assert not intact(frame.replace(data=frame.data + b"\x00"))

    def test_not_as_extended_frame(self, frame):
        assert not intact(frame.replace(can_id=frame.can_id | EXTENDED_FLAG))

    def test_not_of_an_unknown_identifier(self):
        assert not intact(Frame(0x7FF, bytes(8)))

    @pytest.mark.parametrize("message", [Sync(1, 2), TickDone(3, 4)])
    def test_unsealed_messages_need_their_length(self, message):
        frame = message.encode()
        assert intact(frame)
        assert not intact(frame.replace(data=frame.data[:-1]))
        assert not intact(frame.replace(data=frame.data + b"\x00"))
