"""``torquer new``: a commented scenario, checked as any other before it is written."""

from dataclasses import replace
from functools import cache
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from fsw.input.schema import Nested, TableError
from fsw.input.toml_text import parse_toml
from fsw.table.ordinary import (
    TORQUE_NM,
    ordinary_dipole_am2,
    ordinary_shadow_impulse_nms,
    ordinary_torque_nm,
    relative_volume,
)
from sim.console import answer, say, warn
from sim.errors import HarnessError, writing
from sim.new_scenario.satellite import NewSatellite, gains_for
from sim.record.destination import check_file
from sim.scenario.names import ALLOWED, is_name
from sim.scenario.schema import Scenario, scenario_of, shipped_names
from sim.sizing.command import doubt_of, points
from sim.sizing.expectation import expect, field_across, torque_balance
from sim.sizing.gravity import gravity_on, turned_away
from sim.sizing.levels import TOO_WEAK, levels_against, two_digits
from sim.sizing.scenario_warnings import scenario_warnings

# --- What the few figures of a new satellite say that is allowed and most likely wrong or left out

DENSEST_KGPM3, LIGHTEST_KGPM3 = 22_600.0, 1.2
"""Of osmium, and of air at sea level."""
OF_BOUND = 5.0
"""A bound of the torque, as in ``fsw/table/ordinary.py``, is five times what changes along an orbit."""
OPTIONS = {
    "orbit.altitude_km": "--altitude-km",
    "orbit.inclination_deg": "--inclination-deg",
    "orbit.tle": "--tle",
    "body.inertia_kgm2": "--inertia-kgm2, or what follows from --mass-kg and --size-m,",
    "coils.levels_am2": "--levels-am2",
    "coils.max_dipole_am2": "--dipole-am2",
}
"""The option that gives each key of a scenario."""


def figure_warnings(satellite: NewSatellite, scenario: Scenario) -> list[str]:
    """The doubts, each a sentence; ``scenario`` is what was made of the figures."""
    return [*_density(satellite), *_drag(satellite, scenario)]


def in_options(sentence: str) -> str:
    """A sentence about keys of a scenario in terms of the options that gave them."""
    for key, option in OPTIONS.items():
        sentence = sentence.replace(key, option)
    return sentence


def _density(satellite: NewSatellite) -> list[str]:
    if satellite.inertia_kgm2 is not None or satellite.mass_kg is None or satellite.size_m is None:
        return []
    density = satellite.mass_kg / prod(satellite.size_m)
    if LIGHTEST_KGPM3 <= density <= DENSEST_KGPM3:
        return []
    edges = " x ".join(f"{edge:g}" for edge in satellite.size_m)
    than = "more than osmium, 22 600" if density > DENSEST_KGPM3 else "less than air, 1.2"
    return [
        f"{satellite.mass_kg:g} kg in {edges} m are {density:.3g} kg/m^3, {than}: is --mass-kg in kg, and "
        "--size-m in m?"
    ]


def _drag(satellite: NewSatellite, scenario: Scenario) -> list[str]:
    """The scenario has no plates for drag to act on; whether it would rule."""
    body = satellite.body
    drag_nm = ordinary_torque_nm(body.inertia_kgm2, scenario.orbit.perigee_km) / OF_BOUND
    given_nm = scenario.coils.largest_am2 * scenario.coils.on_part * field_across(body)
    if scenario.disturbance.drag is not None or drag_nm <= TOO_WEAK * given_nm:
        return []
    return [
        f"drag is left out, and at {scenario.orbit.perigee_km:.0f} km it rules: about {drag_nm:.1g} N m on "
        f"such a body, {drag_nm / given_nm:.0%} of what its coils can give; a scenario with "
        "body.plates and [disturbance.drag] has it"
    ]


# --- The command

TORQUE_PART, DIPOLE_PART = 0.1, 0.03
"""Parts of the bounds that the satellite is assumed to have: one that was built magnetically clean."""
COMMENTS = 34
"""Column of the comments, where the value is no longer."""
STRONGEST_A = 0.4
"""Current at the strongest level, for a coil of which nothing is known."""
COIL_FIELD_NT = 24_000.0
"""Field at the magnetometer of the strongest coil, for one of which nothing is known."""


def new(satellite: NewSatellite, out: Path | None) -> int:
    """Write the scenario, and say how to fly it.

    Args:
        satellite: what the user gave.
        out: the file; None: NAME.toml here.

    Raises:
        HarnessError: figures are missing, the name is taken, the file exists or cannot be written.
        TableError: the figures make no satellite.
    """
    file, scenario, warnings, pointing_deg = write_new(satellite, out)
    for warning in warnings:
        warn(warning)
    about = "no pointing" if pointing_deg is None else f"about {pointing_deg:.1f} deg RMS"
    say(f"written: {file}; {about} to expect (torquer size {file})")
    say(f"fly it: torquer sil {file}")
    answer({"file": file, "name": scenario.name, "pointing_rms_deg": pointing_deg})
    return 0


class WrittenScenario(NamedTuple):
    """A scenario and its file.

    Attributes:
        file: in which it stands.
        scenario: what stands there.
        warnings: what of it is most likely wrong, a sentence each.
        pointing_deg: to expect, root mean square; None: none to rely on.
    """

    file: Path
    scenario: Scenario
    warnings: tuple[str, ...]
    pointing_deg: float | None


def write_new(satellite: NewSatellite, out: Path | None) -> WrittenScenario:
    """Write the scenario.

    Raises:
        HarnessError: as for ``new``.
        TableError: the figures make no satellite.
    """
    file = out or Path(f"{satellite.name}.toml")
    check_new(satellite.name, file)
    text = scenario_text(satellite, file.name)
    scenario = scenario_made(text)
    with writing(file), file.open("x", encoding="utf-8") as target:
        target.write(text)
    warnings = [*figure_warnings(satellite, scenario), *scenario_warnings(scenario)]
    expectation = expect(scenario)
    if not points(expectation, gravity_on(scenario)):
        return WrittenScenario(file, scenario, tuple(warnings), None)
    if doubt := doubt_of(expectation):
        warnings.append(doubt)
    return WrittenScenario(file, scenario, tuple(warnings), expectation.pointing_deg)


def check_new(name: str, file: Path) -> None:
    """Check that there can be a scenario of this name in this file.

    Raises:
        HarnessError: the name cannot be part of a path or is that of a scenario that ships; the file exists.
    """
    if not is_name(name):
        raise HarnessError(f"{name!r} is no name of a scenario: allowed are {ALLOWED}")
    if name in shipped_names():
        raise HarnessError(f"{name!r} is a scenario that ships: choose another name")
    if file.suffix != ".toml":
        raise HarnessError(f"{file}: a scenario's file ends in .toml")
    if file.exists():
        raise HarnessError(f"{file} exists, and is not overwritten: choose another name or --out")
    check_file(file)


def scenario_text(satellite: NewSatellite, file: str) -> str:
    """The text of the scenario, with its comments; where no levels are given, those that would do.

    Raises:
        HarnessError: figures are missing.
        TableError: the figures make no satellite.
    """
    satellite.check()
    text = _rendered(satellite, file)
    if satellite.levels_am2 is not None or satellite.dipole_am2 is not None:
        return text
    scenario = scenario_made(text)
    levels = levels_against(scenario, torque_balance(scenario).load)
    return _rendered(replace(satellite, levels_am2=levels), file)


def scenario_made(text: str, settings: Nested | None = None) -> Scenario:
    """The scenario of a text that was made of options, before it is in a file.

    Raises:
        TableError: in terms of the options.
    """
    try:
        return scenario_of(parse_toml(text), "the satellite", settings)
    except TableError as error:
        raise TableError(in_options(str(error))) from None


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("sim.new_scenario"),
        undefined=StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,
    )
    return environment.get_template("scenario.toml.j2")


def _rendered(satellite: NewSatellite, file: str) -> str:
    text = _template().render(file=file, **_figures(satellite))
    return "".join(map(_aligned, text.splitlines(keepends=True)))


def _aligned(line: str) -> str:
    """The line with its comment, which has a tab before it, in the column of comments."""
    value, tab, comment = line.partition("\t")
    return f"{value:<{COMMENTS - 1}} {comment}" if tab else line


def _driver(satellite: NewSatellite) -> str:
    if satellite.continuous:
        return "coils driven continuously"
    return f"pulsed coils with {'own' if satellite.per_coil else 'shared'} back-off"


def _figures(satellite: NewSatellite) -> dict[str, Any]:
    body, moments, levels = satellite.body, satellite.body_moments_kgm2, satellite.levels
    gains, strongest = gains_for(body), levels[2]
    dipole_am2 = ordinary_dipole_am2(body.inertia_kgm2)
    mass = f"{satellite.mass_kg:g} kg, " if satellite.mass_kg else ""
    orbit = f"{body.altitude_km:.0f} km, {body.inclination_deg:.1f} deg"
    return {
        "name": satellite.name,
        "summary": f"{mass}{orbit}, {_driver(satellite)}",
        "tle": satellite.tle,
        "epoch": f"{satellite.epoch:%Y-%m-%dT%H:%M:%SZ}",
        "altitude_km": satellite.altitude_km,
        "inclination_deg": satellite.inclination_deg,
        "mass_kg": satellite.mass_kg,
        "edges": None if satellite.inertia_kgm2 else satellite.size_m,
        "moments": [float(f"{moment:.6g}") for moment in moments],
        "unstable": bool(turned_away(body)),
        "levels": levels,
        "up": satellite.looking[0],
        "ahead": satellite.looking[1],
        "continuous": satellite.continuous,
        "cells": satellite.cells,
        "backoff": "per_coil" if satellite.per_coil else "shared",
        "dipole_per_ampere": two_digits(strongest / STRONGEST_A),
        "coil_field": two_digits(COIL_FIELD_NT / strongest),
        "magnetometer_nt": satellite.magnetometer_nt,
        "sun_deg": satellite.sun_deg,
        "torque": two_digits(TORQUE_PART * TORQUE_NM * relative_volume(body.inertia_kgm2)),
        "dipole": two_digits(DIPOLE_PART * dipole_am2),
        "dipole_bound": two_digits(dipole_am2),
        "shadow_impulse": two_digits(ordinary_shadow_impulse_nms(body.inertia_kgm2)),
        "k_w": gains.k_w,
        "k_a": gains.k_a,
        "exact": satellite.exact,
    }
