"""The statistics of a campaign in words: the lines on the terminal, and the tables of the page."""

from sim.campaign.definition.campaign import Campaign
from sim.campaign.definition.words import percent
from sim.campaign.report.analysis import WORST, CampaignAnalysis, FigureStatistics
from sim.campaign.report.scenario_requirements import share_lines
from sim.campaign.report.verdicts import WORDS, meets, proportion, requirement_words, value_words, verdicts
from sim.console import counted
from sim.drawing.page_parts import Table
from sim.statistics.indices import IndexPercentile, Interpretation
from sim.statistics.order_statistics import Percentile, runs_needed
from sim.statistics.proportion import Proportion

INDEX_NAMES = {
    "ape": "APE, absolute performance error",
    "mpe": "MPE, mean performance error",
    "rpe": "RPE, relative performance error",
    "ake": "AKE, absolute knowledge error",
}
ALIKE = 0.01
"""Runs whose length differs by less than this part have the scenario's: it is rounded to ticks."""
MOST_REASONS = 3
"""Most groups of runs that have not settled, each for other causes, on the terminal."""
STRONGEST = 3
"""Most dependences listed on the terminal."""
_ABSENT = "–"


def lines(campaign: Campaign, analysis: CampaignAnalysis) -> list[str]:
    """A few lines for the terminal."""
    runs = analysis.done + len(analysis.failures)
    heading = f"{campaign.name}: {counted(runs, 'run')} of {length(campaign, analysis)}"
    label = "success    " if campaign.requirements else "limits     kept by "
    rows = [heading, f"  {label}{proportion(analysis.success, campaign)}"]
    rows += [f"  required   {one}" for one in verdicts(campaign, analysis) if one.group == "requirement"]
    rows += share_lines(analysis.shares, campaign)
    rows += [
        f"  unsettled  {len(those.runs)} of {analysis.done}, as run {those.runs[0]}: {those.why}"
        for those in analysis.unsettled[:MOST_REASONS]
    ]
    rows += [f"  {figure.words}: {_percentiles(figure, campaign)}" for figure in analysis.figures]
    strongest = [
        f"{analysis.input_words[each.column].words} {each.correlation.value:+.2f}"
        for each in analysis.sensitivities
        if each.correlation and each.correlation.significant
    ]
    if strongest:
        rows.append(f"  depends on {', '.join(strongest[:STRONGEST])} (rank correlation)")
    if analysis.figures:
        first = analysis.figures[0]
        worst = [f"{first.runs[place]} ({first.values[place]:.4g})" for place in first.worst_first[:WORST]]
        rows.append(f"  worst runs {', '.join(worst)}")
    limited = [name for name in analysis.indices if getattr(campaign.index, name) is not None]
    for name in limited:
        limit, found = getattr(campaign.index, name), analysis.indices[name]
        cells = ", ".join(f"{how} {_index_cell(found[how], how, limit)}" for how in Interpretation)
        rows.append(f"  {name.upper()} <= {limit:g} deg: {cells}")
    if analysis.failures:
        run, why = next(iter(analysis.failures.items()))
        rows.append(f"  failed     {len(analysis.failures)}, first run {run}: {why}")
    return rows


def length(campaign: Campaign, analysis: CampaignAnalysis) -> str:
    """How long the runs are: the range where they differ from the scenario's length."""
    nominal = float(campaign.base["time"]["orbits"])
    shortest, longest = (analysis.orbits.min(), analysis.orbits.max()) if analysis.done else (nominal,) * 2
    if max(abs(shortest - nominal), abs(longest - nominal)) <= ALIKE * nominal:
        return _orbits(f"{nominal:g}")
    least, most = f"{shortest:.3g}", f"{longest:.3g}"
    return _orbits(least) if least == most else f"{least} to {most} orbits"


def _orbits(number: str) -> str:
    return f"{number} orbit{'' if number == '1' else 's'}"


def requirement_table(campaign: Campaign, analysis: CampaignAnalysis) -> Table:
    """How many runs meet each requirement, and whether that reaches the probability of the campaign."""
    wanted = f"of {percent(campaign.statistics.probability)}"
    rows = [
        (requirement_words(entry), *_cells_of(found), WORDS[meets(found, campaign)])
        for entry, found in analysis.by_requirement.items()
    ]
    limits = "all, and the limits of the coils" if campaign.requirements else "the limits of the coils"
    rows.append((limits, *_cells_of(analysis.success), _ABSENT))
    return Table(("requirement", "runs that meet it", "part", "at least", "at most", wanted), rows)


def _cells_of(found: Proportion) -> tuple[str, ...]:
    parts = (f"{100.0 * part:.2f} %" for part in (found.value, found.low, found.high))
    return f"{found.count} of {found.total}", *parts


def figure_table(analysis: CampaignAnalysis) -> Table:
    """Percentiles of the figures with their bounds."""
    if not analysis.figures:
        return Table((), [])
    names = [percent(each.probability) for each in analysis.figures[0].percentiles]
    rows = [
        (
            str(figure.words),
            f"{len(figure.values)}" + (f" of {len(figure.ranked)}" if figure.without else ""),
            f"{figure.values.mean():.4g}",
            *map(with_bounds, figure.percentiles),
            f"{figure.values.max():.4g}",
        )
        for figure in analysis.figures
    ]
    return Table(("figure", "runs", "mean", *names, "largest"), rows)


def index_table(campaign: Campaign, analysis: CampaignAnalysis) -> Table:
    """Percentiles of the pointing indices under the three interpretations, with verdicts where limited."""
    rows = []
    for name, found in analysis.indices.items():
        limit = getattr(campaign.index, name)
        cells = [_index_cell(found[how], how, limit) for how in Interpretation]
        rows.append((INDEX_NAMES[name], _ABSENT if limit is None else f"{limit:g}", *cells))
    wanted = percent(campaign.statistics.probability)
    return Table((f"[deg], {wanted}", "limit", *(f"{how}" for how in Interpretation)), rows)


def _index_cell(found: IndexPercentile, how: Interpretation, limit: float | None) -> str:
    """The percentile, its bound where it has one of its own, and the verdict."""
    bound = "" if how is Interpretation.TEMPORAL else f" (bound {value_words(found.bound)})"
    verdict = "" if limit is None else f": {WORDS[found.within(limit)]}"
    return f"{value_words(found.value)}{bound}{verdict}"


def index_note(campaign: Campaign, analysis: CampaignAnalysis) -> str:
    """What the numbers of the index table mean."""
    settings = campaign.statistics
    wanted, confidence = percent(settings.probability), percent(settings.confidence)
    held = next(iter(analysis.indices.values()))[Interpretation.TEMPORAL].held
    needed = runs_needed(settings.probability, settings.confidence)
    counted = "orbit" if settings.last_orbits == 1.0 else f"{settings.last_orbits:g} orbits"
    return (
        f"Over the last {counted} of each run, windows of {settings.window_s:g} s. "
        f"Ensemble: at all times in {wanted} of the runs. Mixed: at {wanted} of all times of all runs. "
        f"Temporal: at {wanted} of the time in the worst of these runs, which bounds {100.0 * held:.1f} % "
        "of the ensemble. "
        f"Bounds are one-sided with {confidence} confidence; those of ensemble and mixed need {needed} runs."
    )


def sensitivity_table(analysis: CampaignAnalysis) -> Table:
    """Rank correlations of the inputs with the first figure."""
    rows = []
    for each in analysis.sensitivities:
        found = each.correlation
        cells = (
            (f"{found.value:+.3f}", f"{found.low:+.3f} to {found.high:+.3f}") if found else (_ABSENT, _ABSENT)
        )
        rows.append((str(analysis.input_words[each.column]), *cells))
    return Table(("input", "rank correlation", "bounds"), rows)


def worst_table(analysis: CampaignAnalysis) -> Table:
    """The worst runs by the first figure, with what drives it."""
    if not analysis.figures:
        return Table((), [])
    first, inputs = analysis.figures[0], [each.column for each in analysis.sensitivities[:4]]
    head = (
        "run",
        *(str(figure.words) for figure in analysis.figures),
        *(str(analysis.input_words[name]) for name in inputs),
    )
    flown = {int(run): place for place, run in enumerate(analysis.errors)}
    rows = []
    for place in first.worst_first[:WORST]:
        run = int(first.runs[place])
        figures = (_value_of(figure, run) for figure in analysis.figures)
        rows.append((str(run), *figures, *(f"{analysis.inputs[name][flown[run]]:.4g}" for name in inputs)))
    return Table(head, rows)


def unsettled_table(analysis: CampaignAnalysis) -> Table:
    """The runs that have not settled, by their causes."""
    rows = [
        (f"{len(those.runs)} of {analysis.done}, as run {those.runs[0]}", those.why)
        for those in analysis.unsettled
    ]
    return Table(("runs", "why they have not settled"), rows)


def failure_table(analysis: CampaignAnalysis) -> Table:
    """The runs that failed."""
    return Table(("run", "why"), [(str(run), why) for run, why in analysis.failures.items()])


def with_bounds(found: Percentile) -> str:
    """A percentile with its bounds."""
    return f"{value_words(found.value)} ({value_words(found.low)} to {value_words(found.high)})"


def _value_of(figure: FigureStatistics, run: int) -> str:
    place = figure.runs.searchsorted(run)
    known = place < len(figure.runs) and figure.runs[place] == run
    return f"{figure.values[place]:.4g}" if known else _ABSENT


def _percentiles(figure: FigureStatistics, campaign: Campaign) -> str:
    """The median, and the percentile of the campaign."""
    wanted = (0.5, campaign.statistics.probability)
    shown = (each for each in figure.percentiles if each.probability in wanted)
    return ", ".join(f"{percent(each.probability)} {with_bounds(each)}" for each in shown)
