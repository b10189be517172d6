"""Columns are the keys of the summary with underscores, and nothing that differs between equal flights."""

import pytest

from sim.campaign.definition.columns import (
    NUMBERS,
    TEXTS,
    cells,
    input_cells,
    requirement_cells,
    requirement_kinds,
)
from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.flight import record_scenario
from sim.scenario.schema import load

SUMMARY = {
    "wall_seconds": 3.0,
    "pulses": {"total": 17, "per_coil": [10, 4, 3], "refused": 0},
    "min_gap_s": {"per_coil": [102.0, None, 101.0], "any": 100.0},
    "limits_ok": True,
    "estimate_deg": {"within_3sigma": None},
    "parameters": {"delay_s": {"value": [0.5, 0.25], "sigma": [0.1, 0.2], "bound": [1.0, 1.0]}},
    "mode_final": "POINT",
    "requirements": [{"verdict": "met"}, {"verdict": "failed"}],
    "isolated": ["coil 1", "sun sensor"],
    "event_count": 4711,
    "events": [{}, {}, {}],
}


def test_keys_become_columns():
    assert cells(SUMMARY) == {
        "pulses_total": 17,
        "pulses_per_coil_0": 10,
        "pulses_per_coil_1": 4,
        "pulses_per_coil_2": 3,
        "pulses_refused": 0,
        "min_gap_s_per_coil_0": 102.0,
        "min_gap_s_per_coil_1": None,
        "min_gap_s_per_coil_2": 101.0,
        "min_gap_s_any": 100.0,
        "limits_ok": 1,
        "estimate_deg_within_3sigma": None,
        "parameters_delay_s_value_0": 0.5,
        "parameters_delay_s_value_1": 0.25,
        "parameters_delay_s_sigma_0": 0.1,
        "parameters_delay_s_sigma_1": 0.2,
        "mode_final": "POINT",
        "requirements_failed": 1,
        "isolated": "coil 1, sun sensor",
        "isolated_units": 2,
        "event_count": 4711,
        "unsettled_causes": "",
        "unsettled_why": "",
    }


def test_a_run_that_has_not_settled_says_why():
    reasons = [
        {"cause": "estimate", "text": "never valid"},
        {"cause": "mismatch", "text": "off by 9 %"},
    ]
    found = cells(SUMMARY | {"diagnosis": {"reasons": reasons}})
    assert found["unsettled_causes"] == "estimate, mismatch"
    assert found["unsettled_why"] == "never valid; off by 9 %"


def test_failed_requirements_are_not_counted_while_one_is_not_judged():
    """A limit on their number is not met then."""
    unjudged = SUMMARY | {"requirements": [{"verdict": "met"}, {"verdict": "not judged"}]}
    failed = cells(unjudged)["requirements_failed"]
    assert failed is None
    assert not FigureRequirement("requirements_failed", at_most=0.0).met_by(failed)
    assert cells(SUMMARY | {"requirements": []})["requirements_failed"] == 0


def test_each_requirement_of_the_scenario_has_its_columns_and_no_more():
    judged = {"verdict": "met", "measured": 0.5, "limit": 1.0, "text": "APE"}
    unjudged = judged | {"verdict": "not judged", "measured": None}
    found = requirement_cells({"requirements": [judged, unjudged, judged]}, 2)
    assert found == {
        "requirements_0_verdict": "met",
        "requirements_0_measured": 0.5,
        "requirements_0_limit": 1.0,
        "requirements_1_verdict": "not judged",
        "requirements_1_measured": None,
        "requirements_1_limit": 1.0,
    }
    assert requirement_kinds(2).keys() == found.keys()
    assert requirement_kinds(0) == {}


SHARED = {"scenario", "seed", "wall_seconds", "realtime_factor", "events"}
"""By all runs, or different in each flight."""
SHARED |= {f"controlled_{key}" for key in ("what", "words", "unit", "threshold")}
LISTS = ("events_", "requirements_", "diagnosis_")
"""Of these there is no column an element."""


def flat(values, above=""):
    for key, value in values.items():
        below = dict(enumerate(value)) if isinstance(value, list) else value
        yield from flat(below, f"{above}{key}_") if isinstance(below, dict) else [f"{above}{key}"]


@pytest.mark.parametrize("name", ["realsat", "posat1-spin"])
def test_every_figure_of_a_summary_has_its_column(name):
    summary = record_scenario(load(name), seed=1, orbits=0.02).summary()
    figures = {column for column in flat(summary) if "_bound_" not in column} - SHARED
    figures = {column for column in figures if not column.startswith(LISTS)}
    assert figures <= {*NUMBERS, *TEXTS}
    assert figures <= set(cells(summary))
    assert len(figures) > 30
    assert not {"wall_seconds", "realtime_factor"} & {*NUMBERS, *TEXTS}


def test_inputs_are_named_by_their_key():
    drawn = {"a.b": [1.0, 2.0], "c.0": 3.0, "d.length": 4.0, "e": "word", "f": True, "g": [[1.0], [2.0]]}
    assert input_cells(drawn) == {
        "input_a_b_0": 1.0,
        "input_a_b_1": 2.0,
        "input_c_0": 3.0,
        "input_d_length": 4.0,
        "input_e": "word",
        "input_f": 1,
        "input_g_0_0": 1.0,
        "input_g_1_0": 2.0,
    }
