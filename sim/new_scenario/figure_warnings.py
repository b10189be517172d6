"""What the few figures of a new satellite say that is allowed and most likely wrong or left out."""

from math import prod

from fsw.table.ordinary import ordinary_torque_nm
from sim.new_scenario.satellite import NewSatellite
from sim.scenario.schema import Scenario
from sim.sizing.expectation import field_across
from sim.sizing.levels import TOO_WEAK

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
