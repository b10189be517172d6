"""The figures of a satellite as options of ``new`` and ``size``, and as questions on a terminal."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sim.errors import HarnessError
from torquer.cli.options import Number

if TYPE_CHECKING:
    from sim.new_scenario.satellite import NewSatellite

Answer = TypeVar("Answer")
_ABOVE_0 = Number(min=0.0, min_open=True)
_THREE = (float, float, float)
_OPTIONS = (
    click.option("--tle", metavar="FILE", type=click.Path(path_type=Path), help="Orbit: TLE or OMM."),
    click.option("--altitude-km", type=Number(150.0, 40_000.0), help="Orbit: circular."),
    click.option("--inclination-deg", type=Number(0.0, 180.0), help="Of the circular orbit."),
    click.option("--mass-kg", type=_ABOVE_0, help="Of a homogeneous box, with --size-m."),
    click.option(
        "--size-m", type=_THREE, metavar="A B C", help="Its edges along x, y, z; the longest looks up."
    ),
    click.option("--inertia-kgm2", type=_THREE, metavar="A B C", help="Principal moments, kg m^2."),
    click.option(
        "--axes",
        type=(str, str, str),
        metavar="UP AHEAD NORMAL",
        help="Body axes that look up, ahead and along the orbit's normal, as z x y.",
    ),
    click.option(
        "--levels-am2",
        type=_THREE,
        metavar="A B C",
        help="Three dipoles of each coil, least first. Default: as suggested.",
    ),
    click.option("--dipole-am2", type=_ABOVE_0, help="Largest dipole of each coil; the levels follow."),
    click.option(
        "--driver",
        default="pulsed",
        show_default=True,
        type=click.Choice(["pulsed", "continuous"]),
        help="pulsed: 3 s every 103 s, as PoSAT-1's; continuous: a dipole each tick.",
    ),
    click.option(
        "--sun",
        default="sensor",
        show_default=True,
        type=click.Choice(["sensor", "cells"]),
        help="A Sun sensor, or Sun cells on the six sides.",
    ),
)


def satellite_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of orbit, body and coils."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def satellite(name: str, tle: Path | None, figures: dict[str, Any]) -> "NewSatellite":
    """The satellite of these options.

    Raises:
        HarnessError: the TLE cannot be read, or a figure contradicts another.
    """
    from sim.new_scenario.satellite import NewSatellite

    if tle is not None and (figures["altitude_km"] is not None or figures["inclination_deg"] is not None):
        raise HarnessError("--tle and --altitude-km, --inclination-deg exclude each other")
    if figures["inertia_kgm2"] is not None and figures["size_m"] is not None:
        raise HarnessError("--inertia-kgm2 and --size-m exclude each other")
    axes = None if figures["axes"] is None else tuple(axis.lower() for axis in figures["axes"])
    given = figures | {
        "axes": axes,
        "continuous": figures["driver"] == "continuous",
        "cells": figures["sun"] == "cells",
    }
    del given["driver"], given["sun"]
    return NewSatellite(name, None if tle is None else tle_lines(tle), **given)


def tle_lines(file: Path) -> tuple[str, str]:
    """The two lines of a file of element sets, of several the newest, which is said.

    Raises:
        HarnessError: it cannot be read, holds no elements, or those of several satellites.
    """
    from sim.console import warn
    from sim.scenario.element_file import check_one_satellite, read_element_file

    found = read_element_file(file)
    check_one_satellite(file, found)
    newest = max(found, key=lambda one: one.epoch_day)
    if len(found) > 1:
        warn(f"{file}: of {len(found)} sets of {newest.title} the newest is used, {newest.where}")
    return newest.lines


def asked(figures: dict[str, Any], tle: Path | None) -> tuple[dict[str, Any], Path | None]:
    """The figures that are missing, asked for on the terminal; Enter takes what stands in brackets."""
    found = dict(figures)
    has_orbit = tle is not None or None not in (found["altitude_km"], found["inclination_deg"])
    has_body = found["inertia_kgm2"] is not None or None not in (found["mass_kg"], found["size_m"])
    if not has_orbit and found["altitude_km"] is None and found["inclination_deg"] is None:
        tle = _optional("File with the TLE (Enter: a circular orbit)", _tle_file)
    if tle is None:
        for name, text, usual, kind in (
            ("altitude_km", "Altitude, km", 550.0, Number(150.0, 40_000.0)),
            ("inclination_deg", "Inclination, deg", 97.6, Number(0.0, 180.0)),
        ):
            if found[name] is None:
                found[name] = click.prompt(text, usual, type=kind)
    if not has_body and found["mass_kg"] is None and found["size_m"] is None:
        question = "Moments of inertia about x, y, z, kg m^2 (Enter: by mass and size)"
        found["inertia_kgm2"] = _optional(question, _three)
        if found["inertia_kgm2"] is not None and found["axes"] is None:
            question = "Which of them look up, ahead, along the orbit's normal (Enter: x y z)"
            found["axes"] = _optional(question, _axes)
    if found["inertia_kgm2"] is None:
        found["mass_kg"] = found["mass_kg"] or click.prompt("Mass, kg", 4.0, type=_ABOVE_0)
        found["size_m"] = found["size_m"] or click.prompt("Edges, m", "0.34 0.1 0.1", value_proc=_three)
    if not (has_orbit and has_body):
        drivers, suns = click.Choice(["pulsed", "continuous"]), click.Choice(["sensor", "cells"])
        found["driver"] = click.prompt(
            "Coils in pulses of 3 s every 103 s, or", found["driver"], type=drivers
        )
        if found["levels_am2"] is None and found["dipole_am2"] is None:
            question = "Largest dipole of a coil, A m^2 (Enter: as suggested)"
            found["dipole_am2"] = _optional(question, _positive)
        found["sun"] = click.prompt("Sun sensor or cells", found["sun"], type=suns)
    return found, tle


def _optional(question: str, read: Callable[[str], Answer]) -> Answer | None:
    """An answer, or None."""
    answer: Answer | None = click.prompt(
        question, default="", show_default=False, value_proc=lambda text: read(text) if text else None
    )
    return answer


def _tle_file(text: str) -> Path:
    """A file with two lines; another one is asked for again."""
    file = Path(text)
    try:
        tle_lines(file)
    except HarnessError as error:
        raise click.BadParameter(str(error)) from None
    return file


def _axes(text: str) -> tuple[str, str, str]:
    """The three axes in an order; what is none is asked for again."""
    words = text.lower().replace(",", " ").split()
    if sorted(words) != ["x", "y", "z"]:
        raise click.BadParameter(f"{text!r}: x, y and z are needed, each once")
    up, ahead, normal = words
    return up, ahead, normal


def _positive(text: str) -> float:
    """A positive number; what is none is asked for again."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not value > 0.0:
        raise click.BadParameter(f"{text!r}: a positive number is needed")
    return value


def _three(text: str) -> tuple[float, float, float]:
    """Three numbers; what is none is asked for again."""
    try:
        first, second, third = (float(word) for word in text.replace(",", " ").split())
    except ValueError:
        raise click.BadParameter(f"{text!r}: three numbers are needed") from None
    return first, second, third
