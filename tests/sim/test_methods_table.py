"""The table of methods: every row says where, by what it is measured, and every law is in it."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from sim.methods import LAST, Kind, missing, read_methods
from sim.validate.outcomes import as_figures, read_record
from sim.validate.registry import all_studies

METHODS = read_methods()
ROOT = Path(__file__).resolve().parents[2]
PROPER = ("B-dot", "Y-Thomson", "Sun ", "Lorentz ", "PD ", "H2 ", "H-infinity ")
EVERY_METHOD = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)


def laws_of(method):
    """Those that its name has in parentheses and backquotes."""
    return [
        law for group in re.findall(r"\((`[^)]*`)\)", method.name) for law in re.findall(r"`(\w+)`", group)
    ]


def unnamed_laws(methods):
    """Laws of the table that no row has in its name."""
    named = {law for method in methods for law in laws_of(method)}
    return [law for law in LAWS if LAWS[law].aim is not Aim.CHECK and law not in named]


def unknown_claims(methods, studies, measured):
    """Ids that are no claims of a study; where a study's figures are written, they say which it has."""

    def known(claim):
        study = max((one for one in studies if f"{claim}.".startswith(f"{one}.")), key=len, default=None)
        others = [one for one in measured if f"{one}.".startswith(f"{study}.")]
        return study is not None and (claim in measured or not others)

    return [claim for method in methods for claim in method.claims if not known(claim)]


@pytest.fixture(scope="module")
def studies():
    return [study.id for study in all_studies()]


@EVERY_METHOD
def test_what_is_built_is_where_the_row_says(method):
    assert method.name
    assert method.claim
    if method.kind is Kind.PASSED_OVER:
        assert not method.where
        assert not method.claims
        assert method.remark, "the reason, and what was searched"
    else:
        for place in method.where.split(", "):
            assert (ROOT / place).is_file(), place


@EVERY_METHOD
def test_a_name_begins_with_a_small_letter_but_for_a_proper_one(method):
    assert method.name[0].islower() or method.name.startswith(PROPER)


@EVERY_METHOD
def test_claim_and_remark_are_sentences(method):
    for text in (method.claim, method.remark or method.claim):
        assert not text[0].islower()
        assert text.endswith(".")


@EVERY_METHOD
def test_its_laws_are_in_the_modules_that_it_names(method):
    """One of the two forms of each at least: the other may be another law's."""
    for law in laws_of(method):
        forms = {form.__module__.replace(".", "/") + ".py" for form in (LAWS[law].acquire, LAWS[law].point)}
        assert forms & set(method.where.split(", "))


@EVERY_METHOD
def test_a_source_is_one_of_the_three_papers(method):
    assert method.source.startswith(("[O19] ", "[O15] ", "[T] "))


def test_no_two_rows_are_the_same_method():
    rows = Counter((method.name, method.source) for method in METHODS)
    assert max(rows.values()) == 1


def test_every_claim_is_one_of_torquer_validate(studies):
    assert unknown_claims(METHODS, studies, read_record(ROOT / "docs" / "validation.json")) == []


@pytest.mark.parametrize("claim", ["nothing.at_all", "jacob", "genetic.most", "genetic"])
def test_a_claim_that_is_none_is_found(studies, claim):
    measured = as_figures(read_record(ROOT / "docs" / "validation.json"))
    assert "genetic.median" in measured
    assert unknown_claims([replace(METHODS[0], claims=(claim,))], studies, measured) == [claim]


def test_every_law_that_flies_is_in_a_row():
    assert unnamed_laws(METHODS) == []


@pytest.mark.parametrize("law", ["pd", "spin_up", "pd_weighted"])
def test_a_law_that_no_row_names_is_found(law):
    others = [method for method in METHODS if law not in laws_of(method)]
    assert unnamed_laws(others) == [law]


def test_the_references_that_no_row_names_stand_on_the_page():
    """They are told, so that it can be seen what is missing; the surveys and the history have rows too."""
    text = (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")
    listed = ", ".join(map(str, missing(METHODS))) or "none"
    assert f"References of the review that no method names: {listed}.\n" in text
    assert missing([]) == list(range(1, LAST + 1))
