"""A campaign in documents: its verdicts as tests of JUnit, its statistics as values of JSON."""

from collections.abc import Sequence
from dataclasses import asdict

from sim.campaign.definition.campaign import Campaign
from sim.campaign.report.analysis import CampaignAnalysis, FigureStatistics
from sim.campaign.report.scenario_requirements import share_json
from sim.campaign.report.verdicts import WORDS, CampaignVerdict, meets, verdicts
from sim.console import plain
from sim.junit import JunitCase
from sim.value_types import Json

# --- Tests of JUnit


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


# --- Values of JSON


def as_json(campaign: Campaign, analysis: CampaignAnalysis) -> Json:
    """The figures of the page.

    A bound for which there are too few runs is None, and so is a percentile that falls on runs without value.
    """
    values: Json = plain(_values(campaign, analysis))
    return values


def _values(campaign: Campaign, analysis: CampaignAnalysis) -> Json:
    return {
        "name": campaign.name,
        "runs": analysis.done + len(analysis.failures),
        "failed": len(analysis.failures),
        "probability": campaign.statistics.probability,
        "confidence": campaign.statistics.confidence,
        "success": analysis.success.values,
        "requirements": {
            str(entry): {**found.values, "met": meets(found, campaign)}
            for entry, found in analysis.by_requirement.items()
        },
        "scenario_requirements": share_json(analysis.shares),
        "unsettled": [asdict(those) for those in analysis.unsettled],
        "missed": [str(one) for one in verdicts(campaign, analysis) if one.met is False],
        "figures": {figure.name: _figure(figure) for figure in analysis.figures},
        "indices_deg": {
            name: {how.value: asdict(percentile) for how, percentile in found.items()}
            for name, found in analysis.indices.items()
        },
        "rank_correlations": {
            each.column.removeprefix("input_"): asdict(each.correlation)
            for each in analysis.sensitivities
            if each.correlation
        },
    }


def _figure(figure: FigureStatistics) -> Json:
    return {
        "runs": len(figure.values),
        "without": figure.without,
        "mean": float(figure.values.mean()),
        "largest": float(figure.values.max()),
        "percentiles": {f"{each.probability!r}": asdict(each) for each in figure.percentiles},
    }
