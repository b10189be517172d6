"""Packing: whatever a state holds is in its bytes, and equal states have equal bytes."""

from copy import deepcopy
from dataclasses import dataclass
from enum import Enum, IntEnum
from math import inf, nan
from typing import NamedTuple
from zlib import crc32

import numpy as np
import pytest

from fsw.core.packing import copy_state, pack


class Colour(Enum):
    RED = "red"
    BLUE = "blue"


class Number(IntEnum):
    ONE = 1
    TWO = 2


class Point:
    """A class by its slots."""

    __slots__ = ("x", "y")

    def __init__(self, x: float, y: float) -> None:
        self.x = x
        self.y = y


class Named(NamedTuple):
    first: float = 0.0
    second: object = None


@dataclass(slots=True)
class Part:
    count: int = 0
    rates: tuple[float, ...] = ()


@dataclass(slots=True)
class Whole:
    part: Part
    place: Point
    other: Point | None = None
    anything: object = None


def whole(**changed):
    parts = {"part": Part(3, (1.0, 2.0)), "place": Point(1.0, 2.0), **changed}
    return Whole(**parts)


DIFFERENT = {
    "as it is": whole(),
    "an integer": whole(part=Part(4, (1.0, 2.0))),
    "an item": whole(part=Part(3, (1.0, 2.5))),
    "one item less": whole(part=Part(3, (1.0,))),
    "one item more": whole(part=Part(3, (1.0, 2.0, 0.0))),
    "items by another order": whole(part=Part(3, (2.0, 1.0))),
    "a slot": whole(place=Point(1.0, 2.5)),
    "slots the other way": whole(place=Point(2.0, 1.0)),
    "an object that was none": whole(other=Point(1.0, 2.0)),
    "none": whole(other=None, anything=(None,)),
    "an empty tuple": whole(anything=()),
    "nothing in nothing": whole(anything=((),)),
    "true": whole(anything=True),
    "one": whole(anything=1),
    "one as a float": whole(anything=1.0),
    "the next float": whole(anything=1.0 + 2.0**-52),
    "zero": whole(anything=0.0),
    "minus zero": whole(anything=-0.0),
    "the smallest float": whole(anything=5e-324),
    "infinity": whole(anything=inf),
    "no number": whole(anything=nan),
    "a large integer": whole(anything=2**63),
    "a larger integer": whole(anything=2**63 + 1),
    "a negative integer": whole(anything=-1),
    "a text": whole(anything="ä"),
    "another text": whole(anything="äb"),
    "a colour": whole(anything=Colour.RED),
    "another colour": whole(anything=Colour.BLUE),
    "a member with a number": whole(anything=Number.TWO),
    "a named tuple": whole(anything=Named(1.0, 2)),
    "another named tuple": whole(anything=Named(1.0, 3)),
    "objects in a list": whole(anything=[Point(1.0, 2.0), Point(3.0, 4.0)]),
    "other objects in a list": whole(anything=[Point(1.0, 2.0), Point(3.0, 5.0)]),
    "an array": whole(anything=np.array([[1.0, 2.0, 3.0, 4.0]])),
    "its number": whole(anything=np.array([[1.0, 2.0, 3.0, 4.5]])),
    "its shape": whole(anything=np.array([[1.0, 2.0], [3.0, 4.0]])),
    "the order of its numbers": whole(anything=np.array([[1.0, 3.0], [2.0, 4.0]])),
    "its type": whole(anything=np.array([[1.0, 2.0, 3.0, 4.0]], dtype=np.float32)),
}


def test_what_differs_is_packed_differently():
    names = {}
    for name, value in DIFFERENT.items():
        names.setdefault(pack(value), []).append(name)
    assert [same for same in names.values() if len(same) > 1] == []


@pytest.mark.parametrize("name", DIFFERENT)
def test_a_copy_is_packed_as_the_original(name):
    assert pack(deepcopy(DIFFERENT[name])) == pack(DIFFERENT[name])


@pytest.mark.parametrize("name", sorted(DIFFERENT.keys() - {"no number", "its type"}))
def test_every_leaf_counts(name, blind_places):
    assert blind_places(DIFFERENT[name]) == []


def test_what_is_shared_is_packed_as_what_is_equal():
    shared, text = (1.0, 2.0), "law"
    again = tuple([1.0, 2.0])
    assert pack((shared, shared, text, text)) == pack((shared, again, text, "".join(["l", "aw"])))


def test_the_layout_of_an_array_in_memory_does_not_count():
    array = np.arange(6.0).reshape(2, 3)
    every_other = np.arange(12.0).reshape(2, 6)[:, ::2] / 2.0
    assert pack(np.asfortranarray(array)) == pack(array) == pack(every_other)


def test_a_field_that_holds_a_member_of_an_enumeration_for_an_integer_is_packed_as_the_integer():
    assert pack(whole(part=Part(Number.TWO, ()))) == pack(whole(part=Part(2, ())))


def test_a_declared_number_of_another_kind_is_packed_all_the_same():
    assert pack(whole(part=Part(3, (np.float64(1.0),)))) != pack(whole(part=Part(3, (np.float64(2.0),))))


@pytest.mark.parametrize("strange", [{1: 2}, {1}, object(), 1j, len])
def test_what_is_unknown_is_named_by_the_fields_that_lead_to_it(strange):
    with pytest.raises(TypeError, match=r"Whole\.anything: Named\.second: "):
        pack(whole(anything=(Named(0.0, strange),)))


def test_an_unknown_in_a_field_declared_otherwise_is_named_too():
    with pytest.raises(TypeError, match=r"Whole\.part: Part\.rates: "):
        pack(whole(part=Part(3, (object(),))))


def test_the_bytes_are_the_same_on_every_machine():
    assert crc32(pack(whole(anything=("law", 7, -0.5, True, Number.ONE)))) == 551747733


class TestCopies:
    @pytest.mark.parametrize("name", DIFFERENT)
    def test_are_packed_as_the_original(self, name):
        assert pack(copy_state(DIFFERENT[name])) == pack(DIFFERENT[name])

    def test_share_nothing_that_is_changed_in_place(self):
        array = np.zeros(3)
        one = whole(other=Part(1), anything=[Part(2), (Named(0.0, Part(3)),), array])
        before, other = pack(one), copy_state(one)
        other.part.count = other.other.count = other.anything[0].count = other.anything[1][0].second.count = 9
        other.anything.append(7)
        other.place = None
        assert pack(one) == before
        assert other.anything[1] is not one.anything[1]

    def test_have_arrays_of_their_own_where_these_may_be_changed(self):
        one = whole(anything=np.zeros(3))
        other = copy_state(one)
        other.anything[1] = 5.0
        assert one.anything[1] == 0.0

    def test_share_what_never_changes(self):
        named = Named(1.0, (Point(1.0, 2.0), np.ones(2)))
        one = whole(anything=(named, named))
        other = copy_state(one)
        assert other.place is one.place
        assert other.anything is one.anything
