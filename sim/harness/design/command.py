"""``torquer design``: search or evaluate, say, draw, write."""

import json
from math import isfinite
from pathlib import Path

import click

from sim.design.linear import Gains
from sim.harness.design.analysis import ANALYSIS_STEPS, Analysis, analyse, drawn
from sim.harness.design.pictures import gain_picture, robustness_picture
from sim.harness.design.render import as_json, as_text
from sim.harness.design.subject import body_of, pulsing_of
from sim.harness.design.write import check_writable, write_gains
from sim.harness.errors import HarnessError
from sim.harness.progress import progress
from sim.harness.run_dir import write_json
from sim.harness.scenario import Scenario, load, parse_settings

GAIN_PICTURE, ROBUSTNESS_PICTURE, RESULT = "gains.png", "robustness.png", "design.json"


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
        HarnessError: gains that are no gains, or a file that cannot be written.
        TableError: a scenario that cannot be used.
    """
    target = check_writable(name) if write else None
    scenario, given = load(name, parse_settings(settings)), _given(gains)
    with progress(f"gains for {scenario.name}", ANALYSIS_STEPS) as watch:
        analysis = analyse(body_of(scenario), pulsing_of(scenario), given, watch)
    click.echo(json.dumps(as_json(analysis), indent=2) if as_json_only else as_text(analysis, scenario))
    if out is not None or not as_json_only:
        folder = out or Path("runs") / f"design-{scenario.name}"
        _draw(folder, analysis, scenario)
        click.echo(f"pictures: {folder / GAIN_PICTURE}, {folder / ROBUSTNESS_PICTURE}", err=as_json_only)
    if not analysis.stabilised and given is None:
        return 1
    if target is not None:
        write_gains(target, analysis.chosen.gains)
        click.echo(f"written: k_w and k_a of {target}", err=as_json_only)
    return 0


def _given(gains: tuple[float, float] | None) -> Gains | None:
    if gains is None:
        return None
    if not all(isfinite(gain) and gain >= 0.0 for gain in gains):
        raise HarnessError(f"--gains {gains[0]:g} {gains[1]:g}: both must be finite and not negative")
    return Gains(*gains)


def _draw(folder: Path, analysis: Analysis, scenario: Scenario) -> None:
    flown = Gains(scenario.control.k_w, scenario.control.k_a)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        shown = drawn(analysis)
        gain_picture(folder / GAIN_PICTURE, analysis, shown, flown)
        robustness_picture(folder / ROBUSTNESS_PICTURE, analysis, shown.inertia)
        write_json(folder / RESULT, as_json(analysis))
    except OSError as error:
        raise HarnessError(f"{folder}: cannot be written ({error.strerror or error})") from None
