"""The statistics of made-up results, whose answers are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.report.analysis import MAIN_FIGURES, analyse
from sim.campaign.results.store import open_results
from sim.statistics.indices import Interpretation
from sim.statistics.proportion import clopper_pearson


@pytest.mark.long
def test_success_counts_failed_runs_as_none(campaign_of_40, analysis):
    assert analysis.done == 38
    assert list(analysis.failures) == [7, 21]
    met = [run for run in range(40) if run not in (7, 21) and pointing(run) <= 60.0]
    assert analysis.success == clopper_pearson(len(met), 40, 0.9)
    (limit,) = campaign_of_40.requirements
    assert analysis.by_requirement[limit] == analysis.success


def pointing(run):
    """As in the fixture."""
    return 20.0 + 1.5 * run


def test_figures_begin_with_what_is_required(analysis):
    assert [figure.name for figure in analysis.figures] == list(MAIN_FIGURES[:2])
    first = analysis.figures[0]
    assert first.requirement is not None
    assert analysis.figures[1].requirement is None
    assert [each.probability for each in first.percentiles] == [0.05, 0.5, 0.95]
    assert first.percentiles[1].value == pytest.approx(np.median(np.append(first.values, [np.inf, np.inf])))


def test_the_worst_come_first(analysis):
    first = analysis.figures[0]
    assert first.runs[first.worst_first[:3]].tolist() == [39, 38, 37]
    falling = replace(first, requirement=replace(first.requirement, at_least=3.0, at_most=np.inf))
    assert falling.runs[falling.worst_first[:2]].tolist() == [0, 1]


def test_inputs_are_ranked_by_what_depends_on_them_and_failed_runs_are_the_worst(campaign_of_40, analysis):
    strongest = analysis.sensitivities[0]
    assert strongest.column == "input_initial_angle_deg"
    drawn = campaign_of_40.draw
    inputs = [drawn(run).inputs["initial.angle_deg"] if run in (7, 21) else float(run) for run in range(40)]
    results = [np.inf if run in (7, 21) else float(run) for run in range(40)]
    assert strongest.correlation.value == pytest.approx(stats.spearmanr(inputs, results).statistic)
    assert "input_coils_backoff" not in analysis.inputs
    assert "input_disturbance_residual_dipole_am2_length" in analysis.inputs


def test_indices_are_there_under_every_interpretation(analysis):
    assert set(analysis.indices) == {"ape", "mpe", "rpe", "ake"}
    ape = analysis.indices["ape"]
    assert ape[Interpretation.ENSEMBLE].value > ape[Interpretation.TEMPORAL].value


def test_without_a_run_that_was_flown_there_are_no_figures(small, tmp_path, failed_row):
    with open_results(tmp_path, small) as results:
        results.add(failed_row(3))
        found = analyse(small, results)
    assert (found.done, found.figures, found.sensitivities) == (0, (), ())
    assert found.success.count == 0
    assert {each.value for index in found.indices.values() for each in index.values()} == {np.inf}


def test_runs_without_a_figure_rank_as_the_worst(small, tmp_path, done_row):
    """Of 20 runs, 12 have no time of convergence: half of the runs have none."""
    wanted = replace(small, requirements=(FigureRequirement("nees_mean", at_least=2.0),))
    with open_results(tmp_path, wanted) as results:
        for run in range(20):
            row = done_row(run)
            known = {"converged_at_s": 100.0 + run, "nees_mean": 3.0 + run} if run < 8 else {}
            results.add(replace(row, cells=row.cells | known))
        figures = {figure.name: figure for figure in analyse(wanted, results).figures}
    assert figures["converged_at_s"].without == 12
    assert [each.value for each in figures["converged_at_s"].percentiles] == [100.95, np.inf, np.inf]
    assert figures["converged_at_s"].percentiles[2].high is None
    assert [each.value for each in figures["nees_mean"].percentiles] == [-np.inf, -np.inf, 9.05]
    assert len(figures["pointing_deg_max_last_orbit"].ranked) == 20


def test_runs_that_have_not_settled_stand_together_by_their_causes(unsettled):
    most, other = unsettled.unsettled
    assert (most.causes, most.runs, most.why) == (
        ("estimate", "mismatch"),
        (7, 8, 9, 10, 11),
        "estimate, mismatch <of> 7",
    )
    assert (other.causes, other.runs) == (("weak",), (3,))


def test_where_all_have_settled_there_are_none(analysis):
    assert analysis.unsettled == ()


def test_a_run_that_failed_ranks_as_the_worst(analysis):
    first = analysis.figures[0]
    assert first.without == 2
    assert np.flatnonzero(np.isinf(first.ranked)).tolist() == [7, 21]
    assert first.percentiles[2].value == 78.5, "38 of 40 runs are 95 %"
