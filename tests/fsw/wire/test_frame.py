"""The CRC that seals a frame, and the rounding of quantities, against definitions written out bit by bit."""

from math import inf, nan, nextafter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.wire.frame import (
    ERROR_FLAG,
    EXTENDED_FLAG,
    REMAINDER,
    REMOTE_FLAG,
    Frame,
    crc8,
    id_register,
    raw,
    seal,
    word_of,
)


def crc8_by_bits(data: bytes) -> int:
    """SAE J1850: polynomial x^8 + x^4 + x^3 + x^2 + 1, register preset and inverted at the end."""
    register = 0xFF
    for byte in data:
        for bit in (byte >> shift & 1 for shift in range(7, -1, -1)):
            out = register >> 7 & 1
            register = register << 1 & 0xFF
            if out ^ bit:
                register ^= 0x1D
    return register ^ 0xFF


def test_flags_are_those_of_linux_can_h():
    assert (EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG) == (1 << 31, 1 << 30, 1 << 29)


class TestCrc:
    def test_check_value_of_sae_j1850(self):
        assert crc8(b"123456789") == crc8_by_bits(b"123456789") == 0x4B

    def test_no_bytes(self):
        assert crc8(b"") == 0x00

    @given(st.binary(max_size=12))
    def test_table_and_definition_agree(self, data):
        assert crc8(data) == crc8_by_bits(data)

    @given(st.integers(0, 0x7FF), st.binary(max_size=7))
    def test_the_identifier_counts_as_two_bytes_before_the_data(self, can_id, data):
        assert crc8(data, id_register(can_id)) == crc8_by_bits(can_id.to_bytes(2, "big") + data)

    @pytest.mark.long
    @given(st.integers(0, 0x7FF), st.binary(min_size=1, max_size=7), st.data())
    @settings(max_examples=300)
    def test_one_or_two_flipped_bits_never_pass(self, can_id, data, draw):
        """Nine data-and-identifier bytes are shorter than the polynomial's period: distance at least 3."""
        sealed = can_id.to_bytes(2, "big") + data + bytes((crc8(data, id_register(can_id)),))
        bits = draw.draw(st.sets(st.integers(0, 8 * len(sealed) - 1), min_size=1, max_size=2))
        word = int.from_bytes(sealed, "big")
        for bit in bits:
            word ^= 1 << bit
        broken = word.to_bytes(len(sealed), "big")
        assert crc8_by_bits(broken[:-1]) != broken[-1]


@given(st.binary(max_size=7), st.integers(0, 255))
def test_bytes_with_their_own_crc_leave_the_same_whatever_they_are(data, register):
    right = crc8(data, register)
    assert [last for last in range(256) if crc8(data + bytes((last,)), register) == REMAINDER] == [right]


@given(st.binary(max_size=8))
def test_the_word_is_of_the_first_seven_bytes(data):
    assert word_of(data) == int.from_bytes(data[:7], "little")


def test_seal_puts_the_word_little_endian_before_the_crc():
    frame = seal(0x123, 0x0A0B0C, 4, id_register(0x123))
    assert frame == Frame(0x123, bytes((0x0C, 0x0B, 0x0A, crc8_by_bits(bytes.fromhex("01230C0B0A")))))


def test_seal_refuses_a_word_that_would_overwrite_the_crc():
    with pytest.raises(OverflowError):
        seal(0x123, 1 << 24, 4, id_register(0x123))


class TestRaw:
    @pytest.mark.parametrize(
        ("value", "expected"),
        [
            (0.0, 0),
            (2.9, 1),  # 1.45 units
            (3.1, 2),
            (-2.9, -1),
            (-3.1, -2),
            (198.0, 99),
            (199.0, 99),  # 99.5 units would round beyond the range
            (1e300, 99),
            (-200.0, -100),
            (-1e300, -100),
            (inf, 99),
            (-inf, -100),
            (nan, -100),
        ],
    )
    def test_nearest_in_range(self, value, expected):
        assert raw(value, 2.0, -100, 99) == expected

    @given(st.floats(allow_nan=True, allow_infinity=True), st.sampled_from([1, 2, 10, 2.0**-16, 2.0**-22]))
    def test_never_leaves_the_range(self, value, scale):
        assert -0x8000 <= raw(value, scale, -0x8000, 0x7FFF) <= 0x7FFF

    @given(st.integers(-(2**31), 2**31 - 1))
    def test_a_half_goes_to_the_even_neighbour(self, units):
        for value in (units + 0.5, nextafter(units + 0.5, inf), nextafter(units + 0.5, -inf)):
            assert raw(value, 1.0, -(2**32), 2**32) == round(value)

    @given(st.floats(-(2.0**31), 2.0**31))
    def test_rounds_as_python_does(self, value):
        assert raw(value, 1.0, -(2**32), 2**32) == round(value)

    @given(st.integers(-0x8000, 0x7FFF), st.floats(-0.499, 0.499))
    def test_is_the_nearest(self, units, off):
        assert raw((units + off) * 2.0**-14, 2.0**-14, -0x8000, 0x7FFF) == units
