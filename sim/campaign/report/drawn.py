"""What a campaign draws for each run: lists by the section of the scenario, with what was really drawn."""

import numpy as np

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.distributions import AnyDispersion, Choice
from sim.campaign.report.analysis import CampaignAnalysis
from sim.drawing.page_parts import Table

_HEAD = ("drawn", "distribution", "least", "median", "largest")
_APPLIED = {"replace": "", "add": ", added to the scenario's", "multiply": ", times the scenario's"}


def drawn_tables(campaign: Campaign, analysis: CampaignAnalysis) -> list[Table]:
    """A table for each section of the scenario of which something is drawn, a row per number or text."""
    rows: dict[str, list[tuple[str, ...]]] = {}
    for column, words in analysis.input_words.items():
        entry = _dispersion_of(campaign, column)
        values = analysis.inputs.get(column)
        if values is None or not len(values):
            figures: tuple[str, ...] = ("–",) * 3
        else:
            figures = tuple(f"{value:.4g}" for value in (values.min(), np.median(values), values.max()))
        rows.setdefault(words.kind, []).append((str(words), _in_words(entry), *figures))
    return [Table(_HEAD, listed, caption=kind) for kind, listed in sorted(rows.items())]


def _dispersion_of(campaign: Campaign, column: str) -> AnyDispersion:
    """The dispersion that draws a column: of those whose key it begins with, the one of the longest key."""
    keys = {f"input_{key.replace('.', '_')}": entry for entry in campaign.disperse for key in entry.targets}
    return keys[max((key for key in keys if f"{column}_".startswith(f"{key}_")), key=len)]


def _in_words(entry: AnyDispersion) -> str:
    applied = _APPLIED[entry.apply]
    if isinstance(entry, Choice):
        return f"choice of {len(entry.values)}{applied}"
    return f"{entry.distribution.replace('_', '-')}{applied}"
