"""``torquer size``: coil levels, and what pointing to expect, of a scenario's satellite."""

from dataclasses import asdict
from itertools import permutations
from math import pi
from typing import NamedTuple

import numpy as np

from sim.console import answer, say
from sim.design.from_scenario import body_of
from sim.scenario.schema import Scenario
from sim.sizing.expectation import Expectation, detumbling, detumbling_words, expect
from sim.sizing.gravity import Gravity, gravity_on, gravity_words, moments_of
from sim.sizing.levels import MOST_LOAD, Levels, levels_against
from sim.value_types import Json

ROUNDED = 1.05
"""By so much the load of levels that were made for a tenth may exceed it: they have two digits."""
SMALL_DEG = 15.0
"""Above it a floor by small angles is no figure: the satellite will not point."""
SURE_DEG = 3.0
"""Floor up to which flights agree with the figure."""
STEADY_DEG = 0.6
"""Turn between two pulses up to which they do: of four kinds of cubesat, and most of a heavier one."""
LOST = 2.0
"""Times the standard deviation with which the control relies on an estimate: beyond it, none points."""
MOST_SPREAD = 20.0
"""Ratio of the moments of inertia up to which the least level is judged by the lightest axis."""


class SizingReport(NamedTuple):
    """What to expect of a scenario, in words and values, and whether its disturbance is balanced."""

    text: str
    values: Json
    balanced: bool


def size(scenario: Scenario) -> int:
    """Print what is expected and what levels would do; 1 if the coils cannot balance the disturbance."""
    found = sizing_report(scenario)
    say(found.text, failed=not found.balanced)
    answer(found.values)
    return int(not found.balanced)


def sizing_report(scenario: Scenario) -> SizingReport:
    """What is expected and what levels would do."""
    expectation = expect(scenario)
    levels, gravity = levels_against(scenario, expectation.load), gravity_on(scenario)
    return SizingReport(
        as_text(scenario, expectation, levels, gravity),
        as_json(scenario, expectation, levels, gravity),
        expectation.load <= 1.0,
    )


def as_json(scenario: Scenario, expectation: Expectation, levels: Levels, gravity: Gravity) -> Json:
    """The same for programs."""
    body = body_of(scenario)
    return {
        "scenario": scenario.name,
        "inertia_kgm2": scenario.body.inertia,
        "altitude_km": body.altitude_km,
        "inclination_deg": body.inclination_deg,
        "levels_am2": scenario.coils.levels_am2,
        "suggested_levels_am2": levels,
        "field_across_coil_t": expectation.field_t,
        "disturbance_rms_nm": expectation.disturbance_nm,
        "load": expectation.load,
        "gravity_holds": not (gravity.away or gravity.rests_elsewhere),
        "gravity_away_nm": gravity.away_nm,
        "detumbling": asdict(detumbling(scenario)),
        "pointing_rms_deg": expectation.pointing_deg if points(expectation, gravity) else None,
        "least_pointing_rms_deg": expectation.least_pointing_deg if points(expectation, gravity) else None,
        "floor_deg": expectation.floor_deg,
        "quantum_deg": expectation.quantum_deg,
        "ripple_deg": expectation.ripple_deg,
        "variation_deg": expectation.variation_deg,
        "knowledge_deg": expectation.knowledge_deg,
        "points": points(expectation, gravity),
    }


def points(expectation: Expectation, gravity: Gravity) -> bool:
    """Whether there is a pointing error to expect.

    Gravity does not turn the body over, the attitude is known, the disturbance is balanced by small angles.
    """
    held = not (gravity.falls_over or gravity.rests_elsewhere)
    known = expectation.shadow_part <= LOST
    return held and known and expectation.load <= 1.0 and expectation.floor_deg <= SMALL_DEG


def doubt_of(expectation: Expectation) -> str:
    """Why flights may have several times the expected error; empty where they agree with it."""
    if expectation.floor_deg > SURE_DEG:
        return "so large an error is a lower bound: flights had it or several times as much"
    if expectation.shadow_part > 1.0:
        return f"{shadow_words(expectation)}: flights then lost it for minutes, and took ten orbits to settle"
    if expectation.ripple_deg > STEADY_DEG:
        return (
            f"the disturbance turns it by {expectation.ripple_deg:.2g} deg between two pulses: flights of "
            "such bodies had the expected error or several times as much, and took up to ten orbits to settle"
        )
    return ""


def shadow_words(expectation: Expectation) -> str:
    """How uncertain the estimate becomes, and by what."""
    return (
        f"in the Earth's shadow the estimate becomes {expectation.shadow_part:.1f} times as uncertain as the "
        "control can use, by the bounds of [flight.uncertainty], ordinary ones where none is given"
    )


def as_text(scenario: Scenario, expectation: Expectation, levels: Levels, gravity: Gravity) -> str:
    """What is given, what to expect and why, what levels would do."""
    body = body_of(scenario)
    up, ahead, normal = moments_of(body)
    lines = [
        f"{scenario.name}: J {up:.3g} up, {ahead:.3g} ahead, {normal:.3g} along the normal, kg m^2; "
        f"{body.altitude_km:.0f} km, {body.inclination_deg:.1f} deg; "
        f"orbit {pi / body.rate_radps / 30.0:.1f} min, {1e6 * expectation.field_t:.1f} uT across a coil",
        f"  coils      {_coils(scenario)}",
        f"  disturbed by {expectation.disturbance_nm:.2e} N m RMS: balancing it takes {expectation.load:.1%} "
        "of what the coils can give",
        f"  gravity    {gravity_words(gravity)}",
        _pointing(expectation, gravity),
    ]
    if scenario.coils.driver == "pulsed":
        lines.append(f"  levels     {_levels(levels)} A m^2 would do")
    driven_freely = scenario.coils.driver == "continuous"
    lines.append(f"  detumbling {detumbling_words(detumbling(scenario), driven_freely)}")
    turned_deg = principal_turn_deg(body.inertia_kgm2)
    if turned_deg > 0.0:
        lines.insert(
            1,
            f"  principal  axes turned by {turned_deg:.1f} deg from the body axes, with products of inertia "
            "as J_xy = - integral of x y dm",
        )
    if expectation.load > MOST_LOAD * ROUNDED:
        lines.append(f"  note: over {MOST_LOAD:.0%} of the coils' time: they hardly turn and damp as well")
    if points(expectation, gravity) and (doubt := doubt_of(expectation)):
        lines.append(f"  note: {doubt}")
    if _spread(body.inertia_kgm2) > MOST_SPREAD:
        lines.append("  note: about its lightest axis such a body turns freely: judge it by axis 1 alone")
    return "\n".join(lines)


def principal_turn_deg(inertia_kgm2: object) -> float:
    """The angle by which the principal axes are turned from the body axes; 0 where these are principal."""
    inertia = np.asarray(inertia_kgm2, dtype=np.float64)
    if not np.any(inertia - np.diag(np.diag(inertia))):
        return 0.0
    _, axes = np.linalg.eigh(inertia)
    traces = []
    for order in permutations(range(3)):
        named = axes[:, list(order)]
        along = np.abs(np.diag(named))
        mirrored = np.linalg.det(named * np.where(np.diag(named) < 0.0, -1.0, 1.0)) < 0.0
        traces.append(float(along.sum() - 2.0 * along.min() * mirrored))
    return float(np.degrees(np.arccos(min(1.0, 0.5 * (max(traces) - 1.0)))))


def _coils(scenario: Scenario) -> str:
    coils = scenario.coils
    if coils.driver == "continuous":
        return (
            f"driven continuously, {coils.largest_am2:g} A m^2 for {coils.on_fraction:.0%} of a tick at most"
        )
    return (
        f"pulses of {coils.pulse_s:g} s every {coils.pulse_s + coils.backoff_s:g} s, levels "
        f"{_levels(coils.levels_am2)} A m^2"
    )


def _pointing(expectation: Expectation, gravity: Gravity) -> str:
    parts = (
        f"{expectation.floor_deg:.2f} disturbance, {expectation.quantum_deg:.2f} least level, "
        f"{expectation.ripple_deg:.2f} between pulses, {expectation.variation_deg:.2f} drag and light "
        f"varying, {expectation.knowledge_deg:.2f} estimate"
    )
    if not points(expectation, gravity):
        return f"  pointing   none to rely on: {why_not(expectation, gravity)} ({parts} deg where it holds)"
    return (
        f"  pointing   {expectation.pointing_deg:.2f} deg RMS once settled, in the worst orbit of a day "
        f"({parts}); {expectation.least_pointing_deg:.2f} in the best"
    )


def why_not(expectation: Expectation, gravity: Gravity) -> str:
    """Why there is no pointing error to expect, as a clause."""
    if gravity.rests_elsewhere:
        return "it does not rest in this attitude"
    if gravity.falls_over:
        return "gravity turns it over"
    if expectation.shadow_part > LOST:
        return shadow_words(expectation)
    return "the disturbance is too strong"


def _levels(levels_am2: Levels) -> str:
    return ", ".join(f"{level:g}" for level in levels_am2)


def _spread(inertia_kgm2: object) -> float:
    moments = np.linalg.eigvalsh(np.asarray(inertia_kgm2))
    return float(moments[-1] / moments[0])
