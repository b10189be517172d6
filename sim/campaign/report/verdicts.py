"""Each requirement of a campaign, and each limit on an index: met, missed, or undecided without more runs."""

from math import isfinite
from typing import NamedTuple

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.definition.words import FIGURE_WORDS, percent
from sim.campaign.report.analysis import CampaignAnalysis
from sim.statistics.proportion import Proportion

WORDS = {True: "met", False: "missed", None: "more runs must tell"}


class CampaignVerdict(NamedTuple):
    """One of them.

    Attributes:
        group: requirement or index.
        name: the limit by its column, as in the campaign file.
        words: the same in words.
        met: None if it takes more runs to decide.
        found: what the runs show.
    """

    group: str
    name: str
    words: str
    met: bool | None
    found: str

    def __str__(self) -> str:
        return f"{WORDS[self.met]}: {self.words}: {self.found}"


def meets(found: Proportion, campaign: Campaign) -> bool | None:
    """Whether the fraction of runs that meet a requirement reaches the probability of the campaign.

    None if it takes more runs to decide: the fraction does, but its lower bound does not.
    """
    if found.value < campaign.statistics.probability:
        return False
    return True if found.low >= campaign.statistics.probability else None


def verdicts(campaign: Campaign, analysis: CampaignAnalysis) -> list[CampaignVerdict]:
    """Of the requirements in their order, then of the limits on indices under each interpretation."""
    wanted = percent(campaign.statistics.probability)
    requirements = [
        CampaignVerdict(
            "requirement",
            str(entry),
            requirement_words(entry),
            meets(found, campaign),
            f"{proportion(found, campaign)}, to be {wanted}",
        )
        for entry, found in analysis.by_requirement.items()
    ]
    indices = [
        CampaignVerdict(
            "index",
            f"{name} <= {limit:g} deg, {how}",
            f"{name.upper()}, {how}, at most {limit:g} deg",
            found.within(limit),
            f"it is {found.value:.4g} deg" if isfinite(found.value) else "it falls on runs that failed",
        )
        for name, percentiles in analysis.indices.items()
        if (limit := getattr(campaign.index, name)) is not None
        for how, found in percentiles.items()
    ]
    return requirements + indices


def requirement_words(entry: FigureRequirement) -> str:
    """A limit of the campaign in words."""
    found = FIGURE_WORDS[entry.figure]
    unit = f" {found.unit}" if found.unit else ""
    sides = {"at least": entry.at_least, "at most": entry.at_most}
    limits = (f"{side} {limit:g}{unit}" for side, limit in sides.items() if isfinite(limit))
    return f"{found.words}, {' and '.join(limits)}"


def value_words(value: float | None) -> str:
    """A percentile or bound: a dash where runs are too few, words where it falls on runs without any."""
    if value is None:
        return "–"
    return f"{value:.4g}" if isfinite(value) else "no value"


def proportion(found: Proportion, campaign: Campaign) -> str:
    """A proportion with its bounds."""
    confidence = percent(campaign.statistics.confidence)
    return (
        f"{found.count} of {found.total}, {100.0 * found.value:.1f} % "
        f"({100.0 * found.low:.1f} to {100.0 * found.high:.1f} % with {confidence} confidence)"
    )
