"""Values: equal by what they hold, shown by name, copied with changes."""

import copy
import pickle

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import MagBoot, MagField, SunBoot, SunVector
from fsw.wire.value import Value

FIELD = MagField(1, 100.0, -200.0, 300.0, counter=7)


class TestAValue:
    def test_is_equal_to_one_of_its_type_with_the_same_attributes(self):
        assert MagField(1, 100.0, -200.0, 300.0, counter=7) == FIELD
        assert hash(FIELD) == hash(MagField(1, 100.0, -200.0, 300.0, counter=7))

    @pytest.mark.parametrize(
        "other",
        [
            *[FIELD.replace(**{name: 0}) for name in FIELD.FIELDS],
            SunVector(1, 100.0, -200.0, 300.0, counter=7),
            FIELD.values(),
            None,
        ],
        ids=repr,
    )
    def test_is_not_equal_to_another(self, other):
        assert other != FIELD

    def test_of_another_sender_differs(self):
        assert MagBoot(0, 1, 2) != SunBoot(0, 1, 2)

    def test_shows_its_attributes_in_order(self):
        assert repr(FIELD) == "MagField(valid=1, b_x=100.0, b_y=-200.0, b_z=300.0, counter=7)"
        assert FIELD.values() == (1, 100.0, -200.0, 300.0, 7)
        assert list(FIELD.by_name().items()) == list(zip(FIELD.FIELDS, FIELD.values(), strict=True))

    def test_is_copied_with_other_attributes(self):
        assert FIELD.replace(b_y=5.0) == MagField(1, 100.0, 5.0, 300.0, counter=7)
        assert FIELD.b_y == -200.0
        with pytest.raises(TypeError):
            FIELD.replace(b_w=5.0)

    @pytest.mark.parametrize("value", [FIELD, MagBoot(0, 1, 2), Frame(0x110, b"\x01")], ids=repr)
    def test_survives_copying_and_pickling(self, value: Value):
        for other in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
            assert other == value

    @pytest.mark.parametrize("value", [FIELD, MagBoot(0, 1, 2), Frame(0x110, b"\x01")], ids=repr)
    def test_has_no_other_attributes(self, value):
        with pytest.raises(AttributeError):
            value.other = 1


def test_frames_are_equal_by_identifier_and_data():
    frame = Frame(0x110, b"\x01")
    assert frame == Frame(0x110, b"\x01")
    assert hash(frame) == hash(Frame(0x110, b"\x01"))
    assert frame != Frame(0x111, b"\x01")
    assert frame != Frame(0x110, b"\x02")
    assert frame != (0x110, b"\x01")
