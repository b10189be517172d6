"""Parameters of user code: a frozen dataclass of numbers, each within its range."""

from dataclasses import dataclass, field
from math import inf, nan

import pytest

from fsw.input.quantities import quantity, with_values
from fsw.input.schema import TableError


@dataclass(frozen=True, slots=True)
class Gains:
    damping_nms_per_t2: float = quantity(1e6, "N m s/T^2", least=0.0, most=1e9)
    share: float = 0.5

    def __post_init__(self):
        if self.share > 1.0:
            raise ValueError("share must not be above 1")


def sentence(given, kind=Gains):
    with pytest.raises(TableError) as caught:
        with_values(kind, given, "control.gains.mine", "mine.py:law")
    assert str(caught.value).startswith("mine.py:law: ")
    return str(caught.value)


def test_what_is_not_given_is_the_default():
    assert with_values(Gains, {}, "k", "s") == Gains(1e6, 0.5)
    found = with_values(Gains, {"damping_nms_per_t2": 7}, "k", "s")
    assert found == Gains(7.0, 0.5)
    assert isinstance(found.damping_nms_per_t2, float)


@pytest.mark.parametrize("value", [0.0, 1e9])
def test_the_ends_of_a_range_are_allowed(value):
    assert with_values(Gains, {"damping_nms_per_t2": value}, "k", "s").damping_nms_per_t2 == value


@pytest.mark.parametrize(
    ("given", "what"),
    [
        (
            {"dampin": 1.0},
            "control.gains.mine.dampin is not a known key (allowed: damping_nms_per_t2, share)",
        ),
        (
            {"damping_nms_per_t2": -1.0},
            "control.gains.mine.damping_nms_per_t2 = -1.0 is not allowed: "
            "allowed is a finite number at least 0 and at most 1e+09 N m s/T^2",
        ),
        ({"damping_nms_per_t2": 1.1e9}, "at most 1e+09"),
        ({"damping_nms_per_t2": nan}, "a finite number"),
        ({"share": inf}, "share = inf is not allowed: allowed is a finite number"),
        ({"share": True}, "share = True is not allowed"),
        ({"share": "1"}, "share = '1' is not allowed"),
        ({"share": 1.5}, "control.gains.mine: ValueError: share must not be above 1"),
    ],
)
def test_what_is_not_allowed_is_named_with_the_range(given, what):
    assert what in sentence(given)


@dataclass
class Thawed:
    k: float = 1.0


@dataclass(frozen=True)
class WithoutDefault:
    k: float


@dataclass(frozen=True)
class OfText:
    k: str = "much"


@dataclass(frozen=True)
class Beyond:
    k: float = quantity(2.0, most=1.0)


@dataclass(frozen=True)
class Made:
    k: list = field(default_factory=list)


@pytest.mark.parametrize(
    ("kind", "what"),
    [
        (Thawed, "Thawed is no frozen dataclass"),
        (int, "int is no frozen dataclass"),
        (Gains(), "is no frozen dataclass"),
        (WithoutDefault, "WithoutDefault.k has the default None"),
        (OfText, "OfText.k has the default 'much'"),
        (Beyond, "Beyond.k has the default 2.0: it must be a finite number at most 1"),
        (Made, "Made.k has the default None"),
    ],
)
def test_what_is_no_dataclass_of_numbers(kind, what):
    assert what in sentence({}, kind)
