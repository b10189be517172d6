"""``torquer compare``: flies the laws side by side; writes and draws how they did."""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from fsw.input.schema import Nested, Section
from sim.campaign.claim import Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study_cache import with_cache
from sim.compare.case import Driver, cases, chosen_laws
from sim.compare.picture import axis_label, colour_of, laws_of, picture, with_unit
from sim.compare.score import WINDOW_ORBITS, Result, Score, fly_case
from sim.compare.table import as_csv, as_json, as_table, as_text, error_text, ranked
from sim.console import counted, plain
from sim.drawing.canvas import style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.drawing.time_chart import Level, Panel, Series, TimeChart, draw, time_data
from sim.errors import HarnessError, writing
from sim.flight.record_flight import MOST_IN_MEMORY, ticks_of
from sim.progress import note, progress
from sim.record.destination import check_folder, new_folder
from sim.record.run_dir import RUN, write_json
from sim.record.whole_file import replace_text
from sim.report.summary import last_orbit
from sim.scenario.controlled import SETTLED_DEG, Controlled, controlled
from sim.scenario.schema import Scenario, flight_table, load, orbit_period_s, shipped_names
from sim.scenario.settings import settings_texts
from sim.tuning.applicable import aims_of
from sim.tuning.cost import BY_RATE
from sim.tuning.kept import KeptGains, body_checksum, gains_text, read_gains, shipped_gains
from sim.value_types import Json

# --- compare.html: the laws side by side, by their table and over time

PANEL_IN = 2.8
_MEANING = (
    "Judged by the {what}. Settled: under {threshold} from then on to the end, for its last orbit at least. "
    "RMS, max and rate over {window}; ∫ m² is the energy lost in the coils but for a factor. Best first, "
    "each aim of laws for itself."
)


_FOUND = (
    "The best gains that torquer design --laws has found in {flights} flights a law, {orbits:g} orbits each, "
    "of the rigid body in the direct dipole's field with nothing unknown, and that a whole flight has borne "
    "out: its figures stand here. Cost: share of the flight until "
    "the error stays under 5°, and log2(1 + RMS / 5°) of the last orbit; a law that does not point is judged "
    "by its rate."
)


def compare_page(
    scenario: Scenario,
    facts: Sequence[str],
    scores: Sequence[Score],
    results: Sequence[Result],
    window: str,
    by: Controlled,
    kept: KeptGains | None = None,
    unsettled: Sequence[str] = (),
) -> str:
    """The page of a comparison whose figures are over ``window``; without a flight it has no chart.

    With gains ``kept`` for the body it tells those of each law, and what they cost in a whole flight; below
    the table stand those that are ``unsettled`` here.
    """
    flights = [result for result in results if result.history is not None]
    meaning = _MEANING.format(what=by.words, threshold=with_unit(by.threshold, by), window=window)
    below = "\n".join([*_failures(scores), *unsettled])
    sections = [PageSection("scores", "The laws", meaning, (as_table(scores, by),), text=below)]
    time = None
    if flights and flights[0].history is not None:
        first = flights[0].history
        time = time_data(first.time, first.t_s, scenario.epoch_unix_s)
        with style():
            drawn = draw(first.time, TimeChart(first.t_s, _panels(flights, by)))
            words = f"RMS of {WINDOW_ORBITS:g} orbits about each time. Grey bands are eclipses."
            charts = (chart("error", drawn.picture, words, drawn.data),)
        sections.append(PageSection("error", "The error over time", charts=charts))
    if kept is not None:
        words = _FOUND.format(flights=kept.flights, orbits=kept.orbits)
        sections.append(PageSection("gains", "The gains", words, (_gains_table(kept, scores),)))
    header = PageHeader(
        "Comparison of control laws", scenario.name, facts, _badges(scores), _tiles(scores, window, by)
    )
    return sections_page(header, sections, time)


def _gains_table(kept: KeptGains, scores: Sequence[Score]) -> Table:
    rows = []
    for score in scores:
        row = kept.rows.get(score.driver.value, {}).get(score.law)
        if row is not None:
            settled = row.get("settle_orbits")
            rows.append(
                [
                    score.law,
                    score.driver.value,
                    "never" if settled is None else f"{settled:.2f}",
                    f"{row['rms']:.3g}",
                    f"{row['cost']:.3f}",
                    f"{row['cost_before']:.3f}",
                    gains_text(row["control"]),
                ]
            )
    return Table(["law", "driver", "settled [orbits]", "RMS", "cost", "of the scenario's", "gains"], rows)


def _panels(flights: Sequence[Result], by: Controlled) -> list[Panel]:
    laws = laws_of(flights)
    panels = []
    for driver in Driver:
        series = [
            Series(score.law, history.error, colour_of(laws.index(score.law)))
            for score, history in flights
            if score.driver is driver and history is not None
        ]
        if series:
            settled = (Level(by.threshold, with_unit(by.threshold, by)),)
            title = f"{driver.value.capitalize()} coil driver"
            panels.append(Panel(title, axis_label(by), PANEL_IN, series, 3.5, settled))
    return panels


def _badges(scores: Sequence[Score]) -> list[tuple[str, str]]:
    broken = [score for score in scores if score.limits_ok is False]
    grounded = [score for score in scores if score.failure]
    badges = [("bad", f"✗ limits broken by {len(broken)}") if broken else ("good", "✓ limits kept")]
    if grounded:
        badges.append(("note", f"! {len(grounded)} did not fly"))
    return badges


def _tiles(scores: Sequence[Score], window: str, by: Controlled) -> list[Tile]:
    """The best of each driver."""
    tiles = []
    for driver in Driver:
        flown = [score for score in scores if score.driver is driver and score.error_rms is not None]
        if flown:
            best = min(flown, key=lambda score: score.error_rms or 0.0)
            rms = error_text(best.error_rms or 0.0, by.unit) + ("°" if by.unit == "deg" else f" {by.unit}")
            note = f"{rms} RMS, {window.removeprefix('the ')}"
            tiles.append(Tile(f"Best, {driver.value}", best.law, note))
    return tiles


def _failures(scores: Sequence[Score]) -> list[str]:
    return [f"{score.law}, {score.driver}: {score.failure}" for score in scores if score.failure]


def unsettled_gains(scores: Sequence[Score], kept: KeptGains | None, orbits: float) -> list[str]:
    """A sentence for each law that settled when its gains were found, and does not here, though it has time.

    That is as long as it took then, and the orbit for which it has to stay.
    """
    sentences = []
    for score in scores:
        row = None if kept is None else kept.rows.get(score.driver.value, {}).get(score.law)
        if not score.tuned or score.failure or row is None or "settle_orbits" not in row:
            continue
        if score.settle_orbits is None and orbits >= row["settle_orbits"] + 1.0:
            sentences.append(
                f"{score.law}, {score.driver}: it settled after {row['settle_orbits']:.2f} orbits when its "
                "gains were found, and does not here"
            )
    return sentences


# --- What the laws of a comparison are judged by: the quantity that they are meant to control on this body

WORDS = {"spin": "spin rate about axis 1", "rate": "rate"}


def yardstick(scenario: Scenario) -> Controlled:
    """Body axis 1 or the whole attitude; where the laws meant for the body do not point, a rate.

    It is that of the scenario's first requirement on a rate, by the error under which it has settled there:
    relative to the orbital frame less the spin reference, or the component about axis 1 alone.

    Raises:
        TableError: the scenario's own law cannot be loaded.
    """
    if flight_table(scenario).modes.axis_only:
        return Controlled("axis", "axis 1 from the vertical", "deg", SETTLED_DEG)
    if not aims_of(scenario) <= BY_RATE:
        return Controlled("attitude", "whole attitude", "deg", SETTLED_DEG)
    for required in scenario.requirement:
        if required.what in WORDS:
            return Controlled(required.what, WORDS[required.what], "deg/s", required.settled_degps)
    return controlled(scenario)


# --- The command

BEST, SCENARIO = "best", "scenario"
"""Gains: those that were found for the body, or the scenario's."""
JSON, CSV, PICTURE, PAGE = "compare.json", "compare.csv", "compare.png", "compare.html"


@dataclass(frozen=True, slots=True)
class ComparedLaws:
    """Control laws that were flown side by side.

    Attributes:
        folder: it holds the files.
        scenario: on which they were flown.
        scores: the lines of the table, best first.
        by: what they are judged by.
        description: scenario, seed, settings and length of the flights, as in ``compare.json``.
        asked: the laws that were named, and the scenario's own.
        drawn: whether any was flown, so that there is a picture.
        unsettled: a sentence for each law whose gains settled it when they were found, and do not here.
    """

    folder: Path
    scenario: Scenario
    scores: Sequence[Score]
    by: Controlled
    description: dict[str, Any]
    asked: frozenset[str]
    drawn: bool
    unsettled: Sequence[str]

    @property
    def files(self) -> list[Path]:
        """What was written."""
        names = (JSON, CSV, *([PICTURE] if self.drawn else []), PAGE)
        return [self.folder / name for name in names]

    @property
    def complaints(self) -> list[str]:
        """Why it is no success: limits that were broken, laws that were asked for and could not be flown.

        How well a law does is no failure.
        """
        broken = [f"{score.law} ({score.driver})" for score in self.scores if score.limits_ok is False]
        failed = [score for score in self.scores if score.failure and score.law in self.asked]
        if not failed and all(score.failure for score in self.scores):
            failed = list(self.scores)
        sentences = [f"the limits are broken by {', '.join(broken)}"] if broken else []
        return sentences + [f"{each.law} ({each.driver}) was not flown: {each.failure}" for each in failed]

    @property
    def values(self) -> Json:
        """All scores and the description, as in ``compare.json``."""
        return as_json(self.scores, self.description)

    def __str__(self) -> str:
        heading = _heading(self.scenario, self.description["seed"], self.description["ticks"], self.by)
        return "\n".join([heading, as_text(self.scores, self.by), *self.unsettled])


class CompareOptions(Section):
    """How laws are compared.

    Attributes:
        laws: the text for ``chosen_laws``; None: all that are meant for the body.
        driver: of the coils.
        gains: ``best``: those of ``torquer design --laws`` that ship for this body, where there are some;
            ``scenario``: the scenario's own; else the path of a file of that command.
        orbits: of each flight; None: as the scenario says.
        seed: of the plant's random streams, the same in all flights.
        workers: processes; None: as many as there are cores.
    """

    laws: str | None = None
    driver: Literal["pulsed", "continuous", "both"] = "both"
    gains: str = BEST
    orbits: float | None = Field(default=None, gt=0.0)
    seed: int = Field(default=1, ge=0, le=2**64 - 1)
    workers: int | None = Field(default=None, ge=1)


def compare(
    source: str | Scenario, settings: Nested, options: CompareOptions, out: Path | None
) -> ComparedLaws:
    """Fly every law by every driver and write how they compare.

    Args:
        source: the scenario, its name or its path.
        settings: laid over the scenario.
        options: which laws, and how they are flown.
        out: folder of the files; None: ``compare/<scenario>-<UTC time>``.

    Raises:
        TableError: there is no such scenario, or it is not valid.
        HarnessError: there is no such law, or the folder cannot be used.
    """
    scenario = load(source, settings)
    by = yardstick(scenario)
    chosen = chosen_laws(scenario, options.laws)
    drivers = tuple(Driver) if options.driver == "both" else (Driver(options.driver),)
    kept = _kept(options.gains, scenario)
    chosen_cases = cases(source, settings, chosen, drivers, options.seed, options.orbits, kept)
    ticks = ticks_of(scenario, options.orbits, MOST_IN_MEMORY)
    folder = _checked_folder(out or new_folder(Path("compare"), scenario.name))
    studies = [
        Study(
            f"{case.law}-{case.driver}",
            (partial(fly_case, case, by),),
            lambda results: [],
            has_flights=True,
            here=case.here,
        )
        for case in chosen_cases
    ]
    description = {
        "scenario": scenario.name,
        "seed": options.seed,
        "settings": settings_texts(settings),
        "ticks": ticks,
        "sim_seconds": ticks / scenario.time.tick_hz,
        "judged": by._asdict(),
        "gains": options.gains if kept is not None else SCENARIO,
    }
    if source in shipped_names() and not settings:  # else a file of the user's may be part of it
        studies = with_cache(studies)
    results: list[Result] = []
    bar = sys.stderr.isatty()  # else each flight's line is the progress

    def take(finished: StudyResult) -> None:
        results.append(finished.results[0])
        if not bar:
            note(_line(finished, by))

    try:
        with progress(f"comparing {counted(len(chosen), 'law')} on {scenario.name}", len(studies)) as watch:
            run(studies, options.workers or os.cpu_count() or 1, watch, take)
    finally:  # flights that are done are written when the rest is given up
        scores = ranked((result.score for result in results), by)
        description["complete"] = len(results) == len(studies)
        orbits = ticks / scenario.time.tick_hz / orbit_period_s(scenario)
        unsettled = unsettled_gains(scores, kept, orbits)
        _write(folder, scenario, scores, description, results, by, kept, unsettled)
    asked = {scenario.control.law_name} if scenario.control.own else set()
    asked |= {word.strip() for word in (options.laws or "").split(",")}
    drawn = any(result.history for result in results)
    return ComparedLaws(folder, scenario, scores, by, description, frozenset(asked), drawn, unsettled)


def _kept(gains: str, scenario: Scenario) -> KeptGains | None:
    if gains == SCENARIO:
        return None
    if gains == BEST:
        return shipped_gains(scenario)
    kept = read_gains(Path(gains))
    if kept is None:
        raise HarnessError(f"--gains {gains}: there is no such file: give best, scenario or a file")
    if kept.body != body_checksum(scenario):
        raise HarnessError(f"--gains {gains}: found for another body, orbit, start, coils or torque")
    return kept


def _heading(scenario: Scenario, seed: int, ticks: int, by: Controlled) -> str:
    flown_s = ticks / scenario.time.tick_hz
    return (
        f"{scenario.name}, seed {seed}, {flown_s:.0f} s: {by.words}; settled: under "
        f"{by.threshold:g} {by.unit} from then on, for the last orbit at least; "
        f"RMS, max and rate over {_window(scenario, ticks)}"
    )


def _window(scenario: Scenario, ticks: int) -> str:
    """The part of a flight that its figures are over."""
    return last_orbit({"orbits": ticks / scenario.time.tick_hz / orbit_period_s(scenario)})


def _write(
    folder: Path,
    scenario: Scenario,
    scores: list[Score],
    description: dict[str, Any],
    results: list[Result],
    by: Controlled,
    kept: KeptGains | None,
    unsettled: Sequence[str],
) -> None:
    seed = f"seed {description['seed']}"
    facts = [seed, f"{description['sim_seconds']:.0f} s", f"judged by the {by.words}"]
    if not description["complete"]:
        facts.append("given up before all had flown")
    with writing(folder):
        write_json(folder / JSON, plain(as_json(scores, description)))
        replace_text(folder / CSV, as_csv(scores))
        picture(folder / PICTURE, f"{scenario.name}, {seed}", results, by)
        window = _window(scenario, description["ticks"])
        page = compare_page(scenario, facts, scores, results, window, by, kept, unsettled)
        replace_text(folder / PAGE, page)


def _checked_folder(folder: Path) -> Path:
    """The folder, made before anything is flown."""
    check_folder(folder, (JSON, CSV, PICTURE, PAGE))
    for name, what in ((JSON, "a comparison"), (RUN, "a run")):
        if (folder / name).exists():
            raise HarnessError(f"{folder} already holds {what}: choose another --out")
    return folder


def _line(finished: StudyResult, by: Controlled) -> str:
    score = finished.results[0].score
    figure = score.failure or f"{error_text(score.error_rms, by.unit)} {by.unit} RMS"
    return f"{score.law}, {score.driver}: {figure} ({finished.wall_s:.0f} s)"
