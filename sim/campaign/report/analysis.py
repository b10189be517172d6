"""The statistics of a campaign, from its results."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.columns import input_keys
from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.definition.words import FIGURE_WORDS, ColumnWords, input_words
from sim.campaign.one_run import ERROR_HISTORY
from sim.campaign.report.shares import RequirementShare, requirement_shares
from sim.campaign.results.store import Results, Status
from sim.statistics.indices import INDICES, POINTS, IndexPercentile, Interpretation, table
from sim.statistics.order_statistics import Percentile, percentile
from sim.statistics.proportion import Proportion, clopper_pearson
from sim.statistics.sensitivity import RankCorrelation, spearman
from sim.value_types import Array

MAIN_FIGURES = ("pointing_deg_rms_last_orbit", "pointing_deg_max_last_orbit", "ake_deg_rms", "converged_at_s")
"""Shown of every campaign, after the figures that have a requirement."""
WORST = 5


@dataclass(frozen=True, slots=True)
class FigureStatistics:
    """A figure over all runs.

    Attributes:
        name: its column.
        values: of the runs that have it, in order of their number.
        runs: these numbers.
        ranked: of all runs in order; one that failed or has no such figure counts as the worst, infinite.
        percentiles: of all runs: 5 %, 50 %, and the probability of the campaign.
        requirement: the limits; None if there are none.
    """

    name: str
    values: Array
    runs: NDArray[np.int64]
    ranked: Array
    percentiles: tuple[Percentile, ...]
    requirement: FigureRequirement | None

    @property
    def words(self) -> ColumnWords:
        """What it is."""
        return FIGURE_WORDS[self.name]

    @property
    def worst_first(self) -> NDArray[np.int64]:
        """Places of the runs, the worst first: the largest value, or the least where that is limited."""
        return np.argsort(self.values if falls(self.requirement) else -self.values, kind="stable")

    @property
    def without(self) -> int:
        """How many runs have no such figure."""
        return len(self.ranked) - len(self.values)


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """The rank correlation of an input with the first figure; None where it cannot be determined."""

    column: str
    correlation: RankCorrelation | None


@dataclass(frozen=True, slots=True)
class UnsettledRuns:
    """Runs that have not settled, for the same causes.

    Attributes:
        causes: by name.
        runs: their numbers.
        why: the sentences of the first of them.
    """

    causes: tuple[str, ...]
    runs: tuple[int, ...]
    why: str


@dataclass(frozen=True, slots=True)
class CampaignAnalysis:
    """What the page shows.

    Attributes:
        done: how many runs were flown.
        failures: the sentence of each run that failed, by run.
        success: runs that meet all requirements, of those that have a result; a failed one does not.
        by_requirement: the same for each requirement.
        shares: the requirements of the scenario.
        unsettled: the runs that have not settled, by their causes, the most frequent ones first.
        figures: the first is the one that runs are ranked by.
        indices: percentiles of each pointing index over all runs.
        profiles: of each index, (runs that were flown, points).
        inputs: numeric inputs by column, of the runs that were flown.
        input_words: of every input, by column.
        sensitivities: the strongest first.
        errors: pointing error over time by run.
        orbits: how long each of these runs was.
    """

    done: int
    failures: dict[int, str]
    success: Proportion
    by_requirement: dict[FigureRequirement, Proportion]
    shares: tuple[RequirementShare, ...]
    unsettled: tuple[UnsettledRuns, ...]
    figures: tuple[FigureStatistics, ...]
    indices: dict[str, dict[Interpretation, IndexPercentile]]
    profiles: dict[str, Array]
    inputs: dict[str, Array]
    input_words: dict[str, ColumnWords]
    sensitivities: tuple[Sensitivity, ...]
    errors: dict[int, Array]
    orbits: Array


def analyse(campaign: Campaign, results: Results) -> CampaignAnalysis:
    """The statistics of all runs that have a result, at least one."""
    settings = campaign.statistics
    done = np.array(results.runs(Status.DONE))
    failures = {int(str(run)): str(why) for run, why in results.each(("run", "failure"), Status.FAILED)}
    total = len(done) + len(failures)
    limited = {entry.figure: entry for entry in campaign.requirements}
    names = list(dict.fromkeys((*limited, *MAIN_FIGURES)))
    columns = results.numbers((*names, "orbits"))
    runs = np.union1d(done, list(failures)).astype(int)
    known = [_figure(name, columns[name], done, runs, limited.get(name), campaign) for name in names]
    figures = tuple(figure for figure in known if len(figure.values))
    met = {entry: sum(map(entry.met_by, columns[entry.figure].tolist())) for entry in campaign.requirements}
    successes = int(results.numbers(("success",))["success"].sum())
    numeric = [name for name, kind in results.kinds().items() if name.startswith("input_") and kind != "TEXT"]
    inputs, all_inputs = results.numbers(numeric), _inputs_of(results, numeric, runs)
    profiles = {name: np.array(list(results.profiles(name).values())).reshape(-1, POINTS) for name in INDICES}
    return CampaignAnalysis(
        done=len(done),
        failures=failures,
        success=clopper_pearson(successes, total, settings.confidence),
        by_requirement={
            entry: clopper_pearson(count, total, settings.confidence) for entry, count in met.items()
        },
        shares=requirement_shares(campaign, results, len(failures)),
        unsettled=_unsettled(results),
        figures=figures,
        indices=table(profiles, settings.probability, settings.confidence, len(failures)),
        profiles=profiles,
        inputs=inputs,
        input_words={name: input_words(key) for name, key in input_keys(campaign.draw(0).inputs).items()},
        sensitivities=_sensitivities(all_inputs, figures[0].ranked, settings.confidence) if figures else (),
        errors=results.profiles(ERROR_HISTORY),
        orbits=np.where(np.isfinite(columns["orbits"]), columns["orbits"], campaign.base["time"]["orbits"]),
    )


def _unsettled(results: Results) -> tuple[UnsettledRuns, ...]:
    found: dict[str, list[tuple[int, str]]] = {}
    for run, causes, why in results.each(("run", "unsettled_causes", "unsettled_why"), Status.DONE):
        if causes:
            found.setdefault(str(causes), []).append((int(str(run)), str(why)))
    groups = [
        UnsettledRuns(tuple(causes.split(", ")), tuple(run for run, _ in those), those[0][1])
        for causes, those in found.items()
    ]
    return tuple(sorted(groups, key=lambda group: -len(group.runs)))


def _figure(
    name: str,
    column: Array,
    done: NDArray[np.int64],
    runs: NDArray[np.int64],
    requirement: FigureRequirement | None,
    campaign: Campaign,
) -> FigureStatistics:
    known = np.isfinite(column)
    values, settings = column[known], campaign.statistics
    ranked = np.full(len(runs), -np.inf if falls(requirement) else np.inf)
    ranked[np.searchsorted(runs, done[known])] = values
    wanted = sorted({0.05, 0.5, settings.probability}) if len(values) else []
    percentiles = tuple(percentile(ranked, each, settings.confidence) for each in wanted)
    return FigureStatistics(name, values, done[known], ranked, percentiles, requirement)


def falls(requirement: FigureRequirement | None) -> bool:
    """Whether a figure is the worse the less it is."""
    return requirement is not None and requirement.at_most == np.inf


def _inputs_of(results: Results, names: Sequence[str], runs: NDArray[np.int64]) -> dict[str, Array]:
    """The inputs of these runs, with those that failed."""
    rows = {
        run: values
        for status in (Status.DONE, Status.FAILED)
        for run, *values in results.each(("run", *names), status)
    }
    table_of_all = np.array([rows[run] for run in runs.tolist()], dtype=float).reshape(len(runs), len(names))
    return dict(zip(names, table_of_all.T, strict=True))


def _sensitivities(inputs: dict[str, Array], results: Array, confidence: float) -> tuple[Sensitivity, ...]:
    found = [Sensitivity(name, spearman(values, results, confidence)) for name, values in inputs.items()]
    return tuple(sorted(found, key=lambda each: -abs(each.correlation.value) if each.correlation else 0.0))
