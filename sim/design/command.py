"""``torquer design``: searches or evaluates gains; prints, draws and writes the result."""

from dataclasses import dataclass, replace
from pathlib import Path

from sim.design.analysis import ANALYSIS_STEPS, Analysis, analyse, picture_maps
from sim.design.from_scenario import body_of, pulsing_of
from sim.design.page import design_page
from sim.design.pictures import gain_picture, robustness_picture
from sim.design.render import as_json
from sim.design.scenario_file import check_writable, write_gains
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains
from sim.design.theory.search import natural_gains
from sim.errors import HarnessError
from sim.progress import progress
from sim.record.destination import check_folder
from sim.record.run_dir import write_json
from sim.record.whole_file import replace_text
from sim.scenario.schema import Scenario

GAIN_PICTURE, ROBUSTNESS_PICTURE = "gains.png", "robustness.png"
PAGE, RESULT = "design.html", "design.json"

MAX_GAIN_RATIO = 1e6
"""Gains are accepted up to this multiple of the natural ones; beyond it the numbers overflow."""


@dataclass(frozen=True, slots=True)
class GainDesign:
    """What ``design`` has found and written.

    Attributes:
        scenario: the gains are for it.
        analysis: of the best gains, or of those given.
        pictures: that were drawn.
        written: the scenario file that has the gains now.
    """

    scenario: Scenario
    analysis: Analysis
    pictures: tuple[Path, ...] = ()
    written: Path | None = None

    @property
    def ok(self) -> bool:
        """Gains were given, or a search has found some that stabilise."""
        return self.analysis.search is None or self.analysis.stabilised


def design(
    scenario: Scenario, gains: tuple[float, float] | None, folder: Path | None, write: str | None
) -> GainDesign:
    """Gains for a scenario: the best, or those given.

    Args:
        scenario: the satellite.
        gains: k_w [N m s/T^2] and k_a [N m/T^2]; None: they are searched.
        folder: of pictures, ``design.html`` and ``design.json``; None: nothing is drawn.
        write: the scenario file into which gains that stabilise are written; None: none.

    Raises:
        HarnessError: gains out of range, gains to be written that do not stabilise, or a file that cannot be
            written.
    """
    target = None if write is None else check_writable(write)
    if folder is not None:
        check_folder(folder, (GAIN_PICTURE, ROBUSTNESS_PICTURE, PAGE, RESULT))
    body, given = body_of(scenario), None if gains is None else Gains(*gains)
    if given is not None:
        _check(given, body)
    with progress(f"gains for {scenario.name}", ANALYSIS_STEPS) as watch:
        analysis = analyse(body, pulsing_of(scenario), given, watch)
    if target is not None and given is not None and not analysis.stabilised:
        raise HarnessError(
            f"--gains {given.k_w:g} {given.k_a:g}: they do not stabilise {scenario.name}; {target} is kept"
        )
    pictures = () if folder is None else _draw(folder, analysis, scenario)
    found = GainDesign(scenario, analysis, pictures)
    if target is None or not found.ok:
        return found
    write_gains(target, analysis.chosen.gains)
    return replace(found, written=target)


def _check(gains: Gains, body: Body) -> None:
    natural = natural_gains(body)
    for name, gain, scale in (("K_W", gains.k_w, natural.k_w), ("K_A", gains.k_a, natural.k_a)):
        most = MAX_GAIN_RATIO * float(scale)
        if not 0.0 <= gain <= most:
            raise HarnessError(f"--gains: {name} = {gain:g} is not allowed: for this body 0 to {most:.1g}")


def _draw(folder: Path, analysis: Analysis, scenario: Scenario) -> tuple[Path, ...]:
    of_scenario = Gains(scenario.control.k_w, scenario.control.k_a)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        maps = picture_maps(analysis)
        gain_picture(folder / GAIN_PICTURE, analysis, maps, of_scenario)
        robustness_picture(folder / ROBUSTNESS_PICTURE, analysis, maps.inertia)
        replace_text(folder / PAGE, design_page(analysis, scenario, maps))
        write_json(folder / RESULT, as_json(analysis))
    except OSError as error:
        raise HarnessError(f"{folder}: cannot be written ({error.strerror or error})") from None
    return folder / GAIN_PICTURE, folder / ROBUSTNESS_PICTURE
