"""``torquer design``: searches or evaluates gains; prints, draws and writes the result."""

import json
from pathlib import Path

import click

from sim.design.analysis import ANALYSIS_STEPS, Analysis, analyse, picture_maps
from sim.design.from_scenario import body_of, pulsing_of
from sim.design.pictures import gain_picture, robustness_picture
from sim.design.render import as_json, as_text
from sim.design.scenario_file import check_writable, write_gains
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains
from sim.design.theory.search import natural_gains
from sim.errors import HarnessError
from sim.progress import progress
from sim.record.destination import check_folder
from sim.record.run_dir import write_json
from sim.scenario.schema import Scenario, load, parse_settings

GAIN_PICTURE, ROBUSTNESS_PICTURE, RESULT = "gains.png", "robustness.png", "design.json"

MAX_GAIN_RATIO = 1e6
"""Gains are accepted up to this multiple of the natural ones; beyond it the numbers overflow."""


def design(
    name: str,
    settings: tuple[str, ...],
    gains: tuple[float, float] | None,
    as_json_only: bool,
    write: bool,
    out: Path | None,
) -> int:
    """The command; exit code 1 if a search found no gains that stabilise.

    Raises:
        HarnessError: gains out of range, or a file that cannot be written.
        TableError: a scenario that cannot be used.
    """
    target = check_writable(name) if write else None
    scenario = load(name, parse_settings(settings))
    folder = out or Path("runs") / f"design-{scenario.name}"
    drawing = out is not None or not as_json_only
    if drawing:
        check_folder(folder, (GAIN_PICTURE, ROBUSTNESS_PICTURE, RESULT))
    body, given = body_of(scenario), None if gains is None else Gains(*gains)
    if given is not None:
        _check(given, body)
    with progress(f"gains for {scenario.name}", ANALYSIS_STEPS) as watch:
        analysis = analyse(body, pulsing_of(scenario), given, watch)
    click.echo(json.dumps(as_json(analysis), indent=2) if as_json_only else as_text(analysis, scenario))
    if drawing:
        _draw(folder, analysis, scenario)
        click.echo(f"pictures: {folder / GAIN_PICTURE}, {folder / ROBUSTNESS_PICTURE}", err=as_json_only)
    if not analysis.stabilised and given is None:
        return 1
    if target is not None:
        write_gains(target, analysis.chosen.gains)
        click.echo(f"written: k_w and k_a of {target}", err=as_json_only)
    return 0


def _check(gains: Gains, body: Body) -> None:
    natural = natural_gains(body)
    for name, gain, scale in (("K_W", gains.k_w, natural.k_w), ("K_A", gains.k_a, natural.k_a)):
        most = MAX_GAIN_RATIO * float(scale)
        if not 0.0 <= gain <= most:
            raise HarnessError(f"--gains: {name} = {gain:g} is not allowed: for this body 0 to {most:.1g}")


def _draw(folder: Path, analysis: Analysis, scenario: Scenario) -> None:
    of_scenario = Gains(scenario.control.k_w, scenario.control.k_a)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        maps = picture_maps(analysis)
        gain_picture(folder / GAIN_PICTURE, analysis, maps, of_scenario)
        robustness_picture(folder / ROBUSTNESS_PICTURE, analysis, maps.inertia)
        write_json(folder / RESULT, as_json(analysis))
    except OSError as error:
        raise HarnessError(f"{folder}: cannot be written ({error.strerror or error})") from None
