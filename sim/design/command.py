"""``torquer design``: searches or evaluates gains; prints, draws and writes the result."""

import re
import shutil
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from fsw.input.text_file import read_text
from fsw.input.toml_text import MOST_BYTES, BoundsError, parse_toml
from sim.design.analysis import ANALYSIS_STEPS, Analysis, PictureMaps, analyse, picture_maps
from sim.design.from_scenario import body_of, pulsing_of
from sim.design.pictures import gain_panels, gain_picture, robustness_panels, robustness_picture
from sim.design.render import as_json, as_text
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains, Number
from sim.design.theory.search import natural_gains
from sim.drawing.canvas import style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Tile, sections_page
from sim.errors import HarnessError, writing
from sim.progress import progress
from sim.record.destination import check_file, check_folder
from sim.record.run_dir import write_json
from sim.record.whole_file import replace_text, replacing
from sim.scenario.schema import Scenario

# --- Write gains into a scenario file: two values of ``[control]`` change, every other byte stays

DIGITS = 9
"""Significant digits of a gain: beside a kink the sixth still shows in the degree of stability."""

_HEADER = re.compile(r"^\s*\[+(?P<name>[^\[\]]+)\]")
_VALUE = re.compile(
    r"^(?P<key>\s*(?:control\s*\.\s*)?(?P<name>k_w|k_a)\s*=\s*)(?P<value>[^\s#]+)(?P<rest>.*)$", re.S
)


def check_writable(scenario: str) -> Path:
    """The file that gains can be written to; checked before anything is computed.

    Raises:
        HarnessError: the scenario is one that ships, given by its name, or as for ``write_gains``.
    """
    if not scenario.endswith(".toml"):
        raise HarnessError(
            f"--write {scenario}: gains are not written into a scenario that ships; copy it into a file and "
            f"give the path, which ends in .toml"
        )
    path = Path(scenario)
    _edited(path, Gains(1.0, 1.0))
    check_file(path.resolve())
    return path


def write_gains(path: Path, gains: Gains) -> None:
    """Replace control.k_w and control.k_a in a scenario file, atomically.

    Raises:
        HarnessError: the file cannot be read or written, or does not give both keys a line of their own.
    """
    after = _edited(path, gains)
    with writing(path):
        _replace(path.resolve(), after)


def _edited(path: Path, gains: Gains) -> str:
    values = {"k_w": _gain_text(gains.k_w), "k_a": _gain_text(gains.k_a)}
    try:
        after = _with_values(read_text(path, MOST_BYTES), values)
    except OSError as error:
        raise HarnessError(f"{path}: cannot be read ({error.strerror or error})") from None
    except BoundsError as error:
        raise HarnessError(f"{path}: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise HarnessError(f"{path}: not TOML: {error}") from None
    if after is None:
        raise HarnessError(f"{path}: gains can be written only where [control] gives k_w and k_a a line each")
    return after


def _with_values(text: str, values: dict[str, str]) -> str | None:
    """The text with other values; None if that would not change just them."""
    lines, section = text.splitlines(keepends=True), ""
    for place, line in enumerate(lines):
        if header := _HEADER.match(line):
            section = header["name"].strip()
        found = _VALUE.match(line)
        if found and (section == "control" or (section == "" and "control" in found["key"])):
            lines[place] = found["key"] + values[found["name"]] + found["rest"]
    after = "".join(lines)
    wanted = parse_toml(text)
    control = wanted.get("control")
    if not isinstance(control, dict):
        return None
    wanted["control"] = {**control, **{key: float(value) for key, value in values.items()}}
    return after if tomllib.loads(after) == wanted else None


def _gain_text(gain: Number) -> str:
    return repr(float(f"{float(gain):.{DIGITS}g}"))


def _replace(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))
        shutil.copymode(path, temporary)


# --- design.html: the gains, how stable they are, and how far gains and inertia may be off


def design_page(analysis: Analysis, scenario: Scenario, maps: PictureMaps) -> str:
    """The page of an analysis."""
    with style():
        charts = (
            chart(
                "gains",
                gain_panels(analysis, maps, Gains(scenario.control.k_w, scenario.control.k_a)),
                "Degree of stability over the gains, blue is stable; the red line is where stability ends.",
            ),
            chart(
                "robustness",
                robustness_panels(maps.inertia),
                "Degree of stability of the same gains on a body whose inertia is off.",
            ),
        )
    body = analysis.body
    header = PageHeader(
        "Gains of the PD law",
        body.name,
        (f"{body.altitude_km:.0f} km", f"inclination {body.inclination_deg:.1f}°", "by Floquet theory"),
        [("good", "✓ stable") if analysis.stabilised else ("bad", "✗ not stable")],
        _tiles(analysis),
    )
    sections = [
        PageSection("pictures", "Where the gains are stable", charts=charts),
        PageSection("figures", "All figures", text=as_text(analysis, scenario)),
    ]
    return sections_page(header, sections)


def _tiles(analysis: Analysis) -> list[Tile]:
    gains, orbits = analysis.chosen.gains, analysis.settling_orbits
    return [
        Tile("k_w", f"{float(gains.k_w):.4g}", "N m s/T²"),
        Tile("k_a", f"{float(gains.k_a):.4g}", "N m/T²"),
        Tile("Degree of stability", f"{analysis.chosen.degree:+.3f}", "1/rad, negative is stable"),
        Tile("Settling", "never" if orbits is None else f"{orbits:.2f}", "orbits to 5 %"),
    ]


# --- The command

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
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        maps = picture_maps(analysis)
        gain_picture(folder / GAIN_PICTURE, analysis, maps, of_scenario)
        robustness_picture(folder / ROBUSTNESS_PICTURE, analysis, maps.inertia)
        replace_text(folder / PAGE, design_page(analysis, scenario, maps))
        write_json(folder / RESULT, as_json(analysis))
    return folder / GAIN_PICTURE, folder / ROBUSTNESS_PICTURE
