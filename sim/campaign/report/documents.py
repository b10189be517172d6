"""The verdicts of a campaign as tests of JUnit."""

from collections.abc import Sequence

from sim.campaign.definition.campaign import Campaign
from sim.campaign.report.analysis import CampaignAnalysis
from sim.campaign.report.text import proportion
from sim.junit import JunitCase
from sim.statistics.proportion import Proportion


def meets(found: Proportion, campaign: Campaign) -> bool | None:
    """Whether the part of the runs that meet a requirement is the probability of the campaign or more.

    None if more runs would have to tell: it is, but its lower bound is not.
    """
    if found.value < campaign.statistics.probability:
        return False
    return True if found.low >= campaign.statistics.probability else None


def suites(
    campaign: Campaign, analysis: CampaignAnalysis, broken: Sequence[int]
) -> dict[str, list[JunitCase]]:
    """Each requirement and each limit on an index as a test; then that all runs flew and kept the limits."""
    requirements = [
        _test("requirement", str(entry), meets(found, campaign), proportion(found, campaign))
        for entry, found in analysis.by_requirement.items()
    ]
    limits = {name: getattr(campaign.index, name) for name in analysis.indices}
    indices = [
        _test("index", f"{name} <= {limit:g} deg, {how}", found.within(limit), f"it is {found.value:.4g} deg")
        for name, limit in limits.items()
        if limit is not None
        for how, found in analysis.indices[name].items()
    ]
    failed = "; ".join(f"run {run}: {why}" for run, why in analysis.failures.items())
    kept = ", ".join(f"run {run}" for run in broken)
    runs = [
        JunitCase("campaign.runs", "every run flew", failure=failed),
        JunitCase("campaign.runs", "every run kept the limits of the coils", failure=kept),
    ]
    return {"requirements": requirements, "indices": indices, "runs": runs}


def _test(group: str, name: str, met: bool | None, found: str) -> JunitCase:
    return JunitCase(
        f"campaign.{group}",
        name,
        failure=found if met is False else "",
        skipped=f"{found}: more runs must tell" if met is None else "",
    )
