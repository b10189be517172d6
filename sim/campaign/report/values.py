"""The statistics of a campaign as values of JSON."""

from dataclasses import asdict

from sim.campaign.definition.campaign import Campaign
from sim.campaign.report.analysis import CampaignAnalysis, FigureStatistics
from sim.campaign.report.scenario_requirements import share_json
from sim.campaign.report.verdicts import meets, verdicts
from sim.console import plain
from sim.value_types import Json


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
