"""campaign.html: one self-contained page."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.distributions import AnyDispersion, Choice
from sim.campaign.definition.words import percent
from sim.campaign.report import pictures, scenario_requirements, text
from sim.campaign.report.analysis import CampaignAnalysis
from sim.campaign.report.verdicts import value_words, verdicts
from sim.console import counted
from sim.drawing.canvas import NARROW_IN, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.record.whole_file import replace_text

MOST_TILES = 4


def write_page(path: Path, campaign: Campaign, analysis: CampaignAnalysis, version: str) -> None:
    """Write the page of a campaign with at least one run."""
    with style():
        sections = list(_sections(path.parent, campaign, analysis))
    runs = analysis.done + len(analysis.failures)
    header = PageHeader(
        "Campaign",
        campaign.name,
        facts=[
            f"{runs} of {campaign.runs} runs of {text.length(campaign, analysis)}",
            f"scenario {campaign.base['name']}",
            f"seed {campaign.seed}",
            counted(len(analysis.inputs), "dispersed number"),
            f"torquer {version}",
        ],
        badges=_badges(campaign, analysis),
        tiles=_tiles(campaign, analysis),
    )
    html = sections_page(header, sections)
    replace_text(path, html)


def _badges(campaign: Campaign, analysis: CampaignAnalysis) -> list[tuple[str, str]]:
    success = analysis.success
    what = "succeed" if campaign.requirements else "keep the limits of the coils"
    badges = [
        ("good" if success.count == success.total else "note", f"{success.count} of {success.total} {what}")
    ]
    badges += [("note", words) for words in scenario_requirements.shortfalls(analysis.shares)]
    if missed := sum(one.met is False for one in verdicts(campaign, analysis)):
        badges.append(("bad", f"{missed} of its limits missed"))
    if analysis.failures:
        badges.append(("bad", f"{len(analysis.failures)} failed"))
    return badges


def _tiles(campaign: Campaign, analysis: CampaignAnalysis) -> list[Tile]:
    probability = campaign.statistics.probability
    return [
        Tile(str(figure.words), value_words(found.value), f"{percent(probability)} of runs")
        for figure in analysis.figures[:MOST_TILES]
        for found in figure.percentiles
        if found.probability == probability
    ]


def _sections(folder: Path, campaign: Campaign, analysis: CampaignAnalysis) -> Iterator[PageSection]:
    confidence = f"{percent(campaign.statistics.confidence)} confidence"
    note = f"Parts of the runs, with two-sided bounds by Clopper and Pearson, {confidence}."
    yield PageSection("requirements", "Requirements", note, (text.requirement_table(campaign, analysis),))
    if analysis.shares and analysis.done:
        note = (
            "Parts of the runs that are judged by each, with the same bounds; a run too short for one "
            "is not judged. The margin, of a run in brackets, is the limit less the figure. Reports that are "
            "kept are linked."
        )
        tables = (
            scenario_requirements.share_table(analysis.shares),
            *scenario_requirements.run_tables(analysis.shares, folder),
        )
        yield PageSection("scenario", "Requirements of the scenario", note, tables)
    if analysis.unsettled:
        count = sum(len(those.runs) for those in analysis.unsettled)
        note = (
            f"{count} of {analysis.done} runs have not settled to the end of their flight. Those of the same "
            "causes are a row, with the reasons of the first of them."
        )
        yield PageSection("unsettled", "Runs that have not settled", note, (text.unsettled_table(analysis),))
    if analysis.failures:
        note = "Not flown to their end; they count as runs that meet nothing."
        yield PageSection("failures", "Runs that failed", note, (text.failure_table(analysis),))
    if not analysis.figures:
        return
    first = analysis.figures[0].words.words
    note = (
        f"Percentiles over all runs, in brackets two-sided bounds by order statistics, {confidence}. "
        "A run that failed or has no such figure is the worst; mean and largest are of those that have it."
    )
    yield PageSection("figures", "Figures", note, (text.figure_table(analysis),), (
        chart("distributions", pictures.distributions(analysis),
               "Distribution of each figure, its percentiles with bounds; red: requirement."),
        chart("cumulative", pictures.cumulative(analysis, campaign.statistics.confidence),
               "Part of the runs up to each value; red: requirement."),
    ))  # fmt: skip
    note, title = text.index_note(campaign, analysis), "Pointing indices of ECSS-E-ST-60-10C"
    yield PageSection("indices", title, note, (text.index_table(campaign, analysis),), (
        chart("indices", pictures.indices(analysis, campaign.statistics.probability, campaign.index),
               "Cumulative distribution of each index, over all times and over runs alone; crosses: limits."),
    ))  # fmt: skip
    note = f"By the {first}. torquer sil --from DIR --run NUMBER flies one again."
    yield PageSection("worst", "Worst runs", note, (text.worst_table(analysis),), (
        chart("worst-runs", pictures.worst_runs(analysis),
               "Pointing error over the flight, RMS of short stretches.",
               narrow=pictures.worst_runs(analysis, NARROW_IN)),
    ))  # fmt: skip
    if any(each.correlation for each in analysis.sensitivities):
        note = f"Spearman's rank correlation of each input with the {first}, bounds {confidence}."
        tables = (text.sensitivity_table(analysis),)
        yield PageSection("sensitivity", "What it depends on", note, tables, (
            chart("scatter", pictures.scatter(analysis),
                   f"The {first} over the inputs with the strongest correlation; red: the worst runs."),
        ))  # fmt: skip
    if analysis.input_words:
        note = "Of the runs that were flown, by section of the scenario; each run has noise of its own."
        yield PageSection("drawn", "What is drawn", note, drawn_tables(campaign, analysis))
    yield PageSection("convergence", "Convergence", "Whether more runs would change the result.", (), (
        chart("convergence", pictures.converging(analysis, campaign.statistics),
               f"Percentile of the {first} over the first runs, by their number.",
               narrow=pictures.converging(analysis, campaign.statistics, NARROW_IN)),
    ))  # fmt: skip


# --- What a campaign draws for each run: lists by the section of the scenario, with what was really drawn

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
