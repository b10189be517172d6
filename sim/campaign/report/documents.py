"""The verdicts of a campaign as tests of JUnit."""

from collections.abc import Sequence

from sim.campaign.report.analysis import CampaignAnalysis
from sim.campaign.report.verdicts import WORDS, CampaignVerdict
from sim.junit import JunitCase


def suites(
    verdicts: Sequence[CampaignVerdict], analysis: CampaignAnalysis, broken: Sequence[int]
) -> dict[str, list[JunitCase]]:
    """Each requirement and each limit on an index as a test; then that all runs flew and kept the limits."""
    failed = "; ".join(f"run {run}: {why}" for run, why in analysis.failures.items())
    kept = ", ".join(f"run {run}" for run in broken)
    unflown = "" if analysis.done else "no run was flown"
    runs = [
        JunitCase("campaign.runs", "every run flew", failure=failed),
        JunitCase("campaign.runs", "every run kept the limits of the coils", failure=kept, skipped=unflown),
    ]
    return {
        "requirements": [_test(one) for one in verdicts if one.group == "requirement"],
        "indices": [_test(one) for one in verdicts if one.group == "index"],
        "runs": runs,
    }


def _test(one: CampaignVerdict) -> JunitCase:
    return JunitCase(
        f"campaign.{one.group}",
        one.name,
        failure=one.found if one.met is False else "",
        skipped=f"{one.found}: {WORDS[None]}" if one.met is None else "",
    )
