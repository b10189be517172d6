"""docs/methods.md: a row a method, what is not measured called so, the counts at the top."""

from dataclasses import replace

import pytest

from sim.methods import Kind, Method, missing, numbers, page, verdict

FIGURES = {
    "a.one": {"figure": "1.5 deg", "limits": "<= 2", "verdict": "PASS"},
    "a.two": {"figure": "3 deg", "limits": "<= 2", "verdict": "FAIL"},
    "a.fitted": {"figure": "1.9 deg", "limits": "<= 2", "verdict": "fitted"},
}
LAW = Method("A | law", "[O19] 1 [18, 20-23]", Kind.FLOWN, "So.", "a.py", ("a.one",))
STUDY = Method("Study", "[O15] sec. 3 [4]", Kind.GROUND, "It is so.", "sim/b.py", ("a.one", "a.new"))
NONE = Method("None", "[O19] 2 [1]", Kind.PASSED_OVER, "Nothing.", remark="No equation was found.")


@pytest.mark.parametrize(
    ("claims", "expected"),
    [
        (("a.one",), "holds"),
        (("a.one", "a.two"), "fails"),
        (("a.one", "a.fitted"), "holds"),
        (("a.fitted",), "fitted"),
        (("a.fitted", "a.two"), "fails"),
        (("a.one", "a.new"), "holds, in part not measured"),
        (("a.new",), "not measured"),
        ((), "not measured"),
    ],
)
def test_the_verdict_is_that_of_all_figures(claims, expected):
    method = Method("A", "[T] 1", Kind.FLOWN, "It holds.", "a.py", claims)
    assert verdict(method, FIGURES) == expected


def test_a_row_a_method():
    rows = [line for line in page([LAW, STUDY, NONE], FIGURES).splitlines() if line.startswith("| ")]
    assert rows[1:] == [
        r"| A \| law | [O19] 1 [18, 20-23] | flown | So. | 1.5 deg, <= 2 (`a.one`) | holds | `a.py` |",
        "| Study | [O15] sec. 3 [4] | ground | It is so. | 1.5 deg, <= 2 (`a.one`); "
        "not measured (`a.new`) | holds, in part not measured | `sim/b.py` |",
        "| None | [O19] 2 [1] | passed over | Nothing. No equation was found. | - | passed over | - |",
    ]


def test_a_figure_that_was_fitted_is_called_so():
    law = replace(LAW, claims=("a.one", "a.fitted"))
    assert "1.5 deg, <= 2 (`a.one`); 1.9 deg, <= 2, fitted (`a.fitted`) | holds |" in page([law], FIGURES)


def test_the_top_counts_each_kind_and_names_the_references_left():
    text = page([LAW, STUDY, NONE], FIGURES)
    assert "3 methods: 1 flown, 1 ground, 1 passed over. Verdicts: 1 holds, 1 holds, in part not " in text
    assert "References of the review that no method names: 2, 3, 4, 5," in text
    assert ", 17, 19, 24, " in text


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("[O19] 1 [18, 20-23], eq. 2", {18, 20, 21, 22, 23}),
        ("[T] the choice, [O19] 3.3 [12]", {12}),
        ("[O15] sec. 3 [4]", set()),
        ("[O19] 2.1", set()),
    ],
)
def test_the_numbers_of_a_source(source, expected):
    assert numbers(source) == expected


def test_what_is_missing_is_the_rest():
    assert 18 not in missing([LAW])
    assert 19 in missing([LAW])
    assert 4 in missing([STUDY]), "a number of another paper"
