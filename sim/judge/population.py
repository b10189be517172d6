"""A campaign flown against a user's flight software: its satellites, requirements, probability."""

from collections.abc import Iterator, Sequence

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.columns import cells
from sim.campaign.report.verdicts import CampaignVerdict, meets, proportion, requirement_words
from sim.judge.series import JudgedCase, SeriesCase
from sim.report.requirements.judge import Outcome
from sim.scenario.requirements import in_words
from sim.statistics.proportion import clopper_pearson
from sim.value_types import Json


def population_cases(campaign: Campaign) -> Iterator[SeriesCase]:
    """A case for each run of the campaign."""
    for run in range(campaign.runs):
        drawn = campaign.draw(run)
        yield SeriesCase(f"{run}", campaign.scenario(drawn), drawn.seed)


def population_verdicts(campaign: Campaign, flown: Sequence[JudgedCase]) -> list[CampaignVerdict]:
    """Of each rule, which no run may break, and of each requirement, which the campaign's part must meet."""
    found = []
    for rule in dict.fromkeys(name for one in flown for name in one.rules):
        outcomes = [one.rules[rule] for one in flown if one.rules[rule] is not Outcome.NOT_JUDGED]
        if outcomes:
            broken = outcomes.count(Outcome.FAILED)
            text = f"broken in {broken} of {len(outcomes)} runs" if broken else f"in {len(outcomes)} runs"
            found.append(CampaignVerdict("rule", rule, rule, not broken, text))
    wanted = f"to be {100.0 * campaign.statistics.probability:g} %"
    words = {str(entry): requirement_words(entry) for entry in campaign.requirements}
    for name, met in _by_requirement(campaign, flown).items():
        part = clopper_pearson(sum(met), len(met), campaign.statistics.confidence)
        text = f"{proportion(part, campaign)}, {wanted}"
        found.append(CampaignVerdict("requirement", name, words.get(name, name), meets(part, campaign), text))
    return found


def _by_requirement(campaign: Campaign, flown: Sequence[JudgedCase]) -> dict[str, list[bool]]:
    """Whether each run that was judged by a requirement meets it."""
    found: dict[str, list[bool]] = {}
    for one in flown:
        for number, requirement in enumerate(one.requirements):
            if requirement["verdict"] != Outcome.NOT_JUDGED.value:
                met = requirement["verdict"] == Outcome.MET.value
                found.setdefault(_name(number, requirement), []).append(met)
        figures = cells(one.summary) if one.summary and "isolated" in one.summary else {}
        for entry in campaign.requirements:
            found.setdefault(str(entry), []).append(entry.met_by(figures.get(entry.figure)))
    return found


def _name(number: int, requirement: Json) -> str:
    if requirement["id"] is not None:
        return str(requirement["id"])
    return f"requirement {number + 1}: {in_words(requirement['index'], requirement['what'])}"
