"""Requirements of the scenario over a campaign: the share of the runs that meets each."""

from dataclasses import dataclass

import numpy as np

from sim.campaign.definition.campaign import Campaign
from sim.campaign.results.store import Results, Status
from sim.report.requirements.judge import Outcome, pointed
from sim.report.requirements.words import limit_words
from sim.scenario.requirements import in_words
from sim.scenario.schema import scenario_of
from sim.statistics.proportion import Proportion, clopper_pearson
from sim.value_types import Array

_ABSENT = "–"


@dataclass(frozen=True, slots=True)
class RequirementShare:
    """A requirement of the scenario over all runs.

    Attributes:
        id: its name; None where it has none.
        words: index and what it is of, after the name where there is one.
        unit: of figures, limits and margins.
        by_orbit: when a run is judged by it.
        runs: the numbers of the runs that were flown.
        verdicts: of these runs.
        measured: of these runs; NaN where one has no figure.
        limits: of these runs; NaN where one was not scored by it.
        met: the runs that meet it, of those that are judged by it; one that failed to fly does not. None
            where none is judged.
    """

    id: str | None
    words: str
    unit: str
    by_orbit: float
    runs: tuple[int, ...]
    verdicts: tuple[Outcome, ...]
    measured: Array
    limits: Array
    met: Proportion | None

    @property
    def unjudged(self) -> int:
        """How many runs are too short to be judged by it."""
        return self.verdicts.count(Outcome.NOT_JUDGED)

    @property
    def margins(self) -> Array:
        """How far each figure is under its limit; NaN where there is none."""
        margins: Array = self.limits - self.measured
        return margins

    @property
    def tightest(self) -> int | None:
        """The place of the run with the least margin; None where no run has a figure."""
        return None if np.isnan(self.margins).all() else int(np.nanargmin(self.margins))

    @property
    def limit(self) -> str:
        """The limit in words, of all runs."""
        known = np.unique(self.limits[np.isfinite(self.limits)])
        if len(known) > 2:
            return f"at most its own limit, {self.unit}"
        return limit_words(known, self.unit) if len(known) else _ABSENT


def requirement_shares(campaign: Campaign, results: Results, failed: int) -> tuple[RequirementShare, ...]:
    """Each requirement of the scenario over the runs, of which some failed to fly."""
    nominal = scenario_of(campaign.base, campaign.name)
    runs = tuple(results.runs(Status.DONE))
    shares = []
    for place, section in enumerate(nominal.requirement):
        verdict, measured, limit = (f"requirements_{place}_{key}" for key in ("verdict", "measured", "limit"))
        figures = results.numbers((measured, limit))
        cells = results.each((verdict,), Status.DONE)
        verdicts = tuple(Outcome(str(cell)) if cell else Outcome.NOT_JUDGED for (cell,) in cells)
        met, judged = verdicts.count(Outcome.MET), len(runs) - verdicts.count(Outcome.NOT_JUDGED)
        shares.append(
            RequirementShare(
                section.id,
                in_words(section.index, section.what or pointed(nominal), section.id),
                section.unit.symbol,
                section.by_orbit,
                runs,
                verdicts,
                figures[measured],
                figures[limit],
                clopper_pearson(met, judged + failed, campaign.statistics.confidence) if judged else None,
            )
        )
    return tuple(shares)
