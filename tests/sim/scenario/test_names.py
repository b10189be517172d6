"""Names that become part of a path."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.input.schema import TableError
from sim.scenario.names import is_name
from sim.scenario.schema import load, shipped

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"
NO_NAMES = (
    "", ".", "..", "../../x", "/x", "x/y", "x\\y", "a b", "a\0", "\0", "x\n", "-x", ".x", "ü", "a:b", "~",
    "a" * 101,
)  # fmt: skip


@pytest.mark.parametrize("text", NO_NAMES)
def test_what_could_lead_elsewhere_is_none(text):
    assert not is_name(text)


@pytest.mark.parametrize("text", ["microsat", "posat1-ekf", "a.b", "_", "0", "A_1.toml", "a" * 100])
def test_letters_digits_and_three_marks_are(text):
    assert is_name(text)


def test_every_scenario_that_ships_has_one():
    assert all(is_name(scenario.name) for scenario in shipped())


@given(st.text(alphabet=st.one_of(st.sampled_from(LETTERS), st.characters()), max_size=110))
def test_a_name_is_one_part_of_a_path_and_of_plain_letters(text):
    if is_name(text):
        assert set(text) <= set(LETTERS)
        assert Path("runs", text).parts == ("runs", text)
        assert Path("runs", text).name == text


@pytest.mark.parametrize("text", NO_NAMES)
def test_a_scenario_with_another_is_refused_by_key(text):
    with pytest.raises(TableError, match=r"^scenario microsat: name: .* is not allowed: allowed are letters"):
        load("microsat", {"name": text})


@pytest.mark.parametrize("name", ["../scenarios/microsat", "./microsat", "x/../microsat", "microsat\0"])
def test_a_scenario_that_ships_is_found_by_its_name_alone(name):
    with pytest.raises(TableError, match="there is no scenario"):
        load(name)
