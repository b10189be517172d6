"""Requirements are limits on figures by name, short or whole."""

from math import inf

from sim.campaign.definition.requirements import FigureRequirement, requirements_in

FOUND = requirements_in(
    {
        "pointing_deg": 5.0,
        "estimate_deg": {"max": 2, "within_3sigma": {"at_least": 0.9}},
        "nees_mean": {"at_least": 2.0, "at_most": 8.0},
    },
    "here",
)


def test_a_number_is_the_most():
    assert (
        FigureRequirement("pointing_deg_rms_last_orbit", at_most=5.0),
        FigureRequirement("estimate_deg_max", at_most=2.0),
        FigureRequirement("estimate_deg_within_3sigma", at_least=0.9),
        FigureRequirement("nees_mean", 2.0, 8.0),
    ) == FOUND


def test_limits_belong_to_what_meets_them():
    assert [FOUND[3].met_by(value) for value in (1.9, 2.0, 8.0, 8.1, None)] == [
        False,
        True,
        True,
        False,
        False,
    ]


def test_they_are_written_as_they_are_read():
    again = requirements_in({entry.figure: entry.as_value() for entry in FOUND}, "there")
    assert again == FOUND
    assert FOUND[2].at_most == inf


def test_they_read_as_inequalities():
    assert [str(entry) for entry in FOUND] == [
        "pointing_deg_rms_last_orbit <= 5",
        "estimate_deg_max <= 2",
        "estimate_deg_within_3sigma >= 0.9",
        "2 <= nees_mean <= 8",
    ]
