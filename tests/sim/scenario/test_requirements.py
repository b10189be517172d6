"""Requirements as a person writes them: what is accepted, and the sentence where something is wrong."""

import pytest

from fsw.input.schema import TableError
from sim.scenario.requirements import INDICES, expectation
from sim.scenario.schema import expecting, load, shipped


def requirement(**values):
    return load(
        "microsat", {"requirement": [{"index": "ape", "at_most_deg": 1.0, "by_orbit": 2.0, **values}]}
    )


def test_each_shipped_scenario_has_requirements_that_its_own_length_lets_judge():
    for scenario in shipped():
        assert scenario.requirement, scenario.name
        assert all(one.by_orbit <= scenario.time.orbits for one in scenario.requirement), scenario.name


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"by_orbit": 0.0}, "by_orbit"),
        ({"index": "apex"}, "requirement.0.index"),
        ({"what": "tail"}, "what"),
        ({"at_most_deg": -1.0}, "at_most_deg"),
        ({"at_most_orbits": 1.0}, "ape is limited by at_most_deg, not by at_most_deg, at_most_orbits"),
        ({"what": "spin"}, "ape is limited by at_most_degps, not by at_most_deg"),
        ({"index": "duty", "what": "axis"}, "duty takes no what = 'axis'"),
        ({"index": "settling", "at_most_deg": None, "at_most_orbits": 3.0}, "is after by_orbit = 2"),
        ({"last_orbits": 3.0}, "last_orbits = 3 is longer than the flight by_orbit = 2"),
        ({"index": "mpe", "sunlit": True}, "mpe takes no sunlit"),
        ({"probability": 1.5}, "probability"),
        ({"surprise": 1}, "requirement.0.surprise is not a known key"),
        ({"index": "energy", "at_most_deg": None, "at_most_j": 3.0}, "energy needs coils.resistance_ohm"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_sentence(values, words):
    with pytest.raises(TableError) as caught:
        requirement(**values)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_requirement_may_have_a_name_by_which_others_know_it():
    assert requirement(id="REQ-01.a_2").requirement[0].id == "REQ-01.a_2"
    assert requirement().requirement[0].id is None


@pytest.mark.parametrize("name", ["", "REQ 01", "REQ/01", "REQ:01", "\u00e91", "x" * 101])
def test_a_name_of_other_characters_is_refused_in_one_sentence(name):
    with pytest.raises(TableError) as caught:
        requirement(id=name)
    assert "requirement.0.id: " in str(caught.value)
    assert "allowed are letters, digits" in str(caught.value)


def test_a_name_given_twice_is_refused_in_one_sentence():
    one = {"index": "ape", "at_most_deg": 1.0, "by_orbit": 2.0, "id": "REQ-01"}
    with pytest.raises(TableError) as caught:
        load("microsat", {"requirement": [one, {**one, "id": "REQ-02"}, one]})
    assert str(caught.value) == "scenario microsat: requirement.2.id = 'REQ-01' is that of requirement.0 too"


def test_requirements_without_a_name_may_be_several():
    one = {"index": "ape", "at_most_deg": 1.0, "by_orbit": 2.0}
    assert len(load("microsat", {"requirement": [one, one]}).requirement) == 2


@pytest.mark.parametrize(
    ("text", "index", "what", "limit", "unit"),
    [
        ("ape<2", "ape", None, 2.0, "deg"),
        (" APE.axis <= 1.5 deg ", "ape", "axis", 1.5, "deg"),
        ("ape.spin<0.01", "ape", "spin", 0.01, "deg/s"),
        ("rate<1e-2deg/s", "rate", None, 0.01, "deg/s"),
        ("duty<2.5%", "duty", None, 2.5, "%"),
        ("settling<3", "settling", None, 3.0, "orbits"),
    ],
)
def test_an_expectation_is_a_requirement_at_the_end_of_the_flight(text, index, what, limit, unit):
    found = expectation(text, 5.0)
    assert (found.index, found.what, found.limit, found.unit.symbol) == (index, what, limit, unit)
    assert (found.by_orbit, found.last_orbits) == (5.0, 1.0)


def test_a_flight_shorter_than_an_orbit_is_too_early_to_judge():
    found = expectation("ape<2", 0.25)
    assert (found.by_orbit, found.last_orbits) == (1.0, 1.0)


def test_settling_is_not_judged_before_it_may_have_taken_place():
    assert expectation("settling<3", 1.0).by_orbit == 3.0


WRONG = (
    "",
    "ape",
    "ape<",
    "<2",
    "ape>2",
    "ape=2",
    "ape<two",
    "ape<nan",
    "ape<inf",
    "ape<-1",
    "ape<0",
    "ape<1<2",
)


@pytest.mark.parametrize("text", [*WRONG, "aep<2", "ape.tail<2", "ape<2orbits", "ape<2\n3", "x" * 5000])
def test_a_wrong_expectation_is_refused_in_one_short_sentence(text):
    with pytest.raises(TableError) as caught:
        expectation(text, 5.0)
    assert "--expect" in str(caught.value)
    assert len(str(caught.value)) < 400
    assert "\n" not in str(caught.value)


def test_a_name_that_is_nearly_right_is_told():
    with pytest.raises(TableError, match="did you mean settling"):
        expectation("setling<2", 5.0)


def test_expectations_stand_beside_the_requirements_of_the_scenario():
    scenario = load("posat1")
    found = expecting(scenario, ("ape<2", "duty<3"), 5.0)
    assert found.requirement[: len(scenario.requirement)] == scenario.requirement
    assert [one.index for one in found.requirement[len(scenario.requirement) :]] == ["ape", "duty"]
    assert expecting(scenario, (), 5.0) is scenario
    with pytest.raises(TableError, match="energy needs"):
        expecting(scenario, ("energy<3",), 5.0)


def test_every_index_has_a_limit_of_its_unit():
    for name, row in INDICES.items():
        key = row.unit.key
        values = {"index": name, key: 1.0, "by_orbit": 2.0}
        scenario = load("microsat", {"coils": {"resistance_ohm": 20.0}, "requirement": [values]})
        assert scenario.requirement[0].limit == 1.0
