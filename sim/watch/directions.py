"""Directions around the satellite: what is measured against what the model of the orbit has."""

from collections.abc import Callable
from dataclasses import dataclass
from math import acos, degrees

from fsw.core.algebra.quaternion import Quaternion, conjugate, rotate
from fsw.core.algebra.vector import Vec3, dot, norm, unit
from fsw.core.orbit.ephemeris import EphemerisWindow, advance, reference_at
from fsw.table.config import onboard_ephemeris
from sim.scenario.schema import Scenario, flight_table

AXES: tuple[Vec3, Vec3, Vec3] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class Around:
    """Field and Sun as the onboard model has them, orbit axes; ``sun_orbit`` is None in the shadow."""

    b_orbit_t: Vec3
    sun_orbit: Vec3 | None


AroundAt = Callable[[int], Around | None]


def nothing_around(tick: int) -> None:
    """Where the orbit is not known."""


def onboard_around(scenario: Scenario) -> AroundAt:
    """By the onboard model of a scenario: a function of the tick, for ticks that rise.

    Raises:
        TableError: the onboard table cannot be used.
    """
    model = onboard_ephemeris(flight_table(scenario))
    window: EphemerisWindow | None = None

    def around_at(tick: int) -> Around | None:
        nonlocal window
        window = advance(window, tick, model)
        if window is None:
            return None
        there = reference_at(window, tick, model)
        to_orbit = there.q_orbit_from_eci
        return Around(rotate(to_orbit, there.b_eci_t), rotate(to_orbit, there.sun_eci) if there.lit else None)

    return around_at


def off_deg(attitude: Quaternion | None, measured_body: Vec3, modelled_orbit: Vec3 | None) -> float | None:
    """Angle between a measured direction and the one that the attitude predicts; None if one is unknown."""
    if attitude is None or modelled_orbit is None or not norm(measured_body) > 0.0:
        return None
    predicted = rotate(attitude, unit(modelled_orbit))
    return degrees(acos(max(-1.0, min(1.0, dot(unit(measured_body), predicted)))))


def arrows(
    attitude: Quaternion | None,
    field_body: Vec3 | None,
    sun_body: Vec3 | None,
    dipole_body: Vec3 | None = None,
    torque_body: Vec3 | None = None,
) -> dict[str, Vec3]:
    """Unit vectors by name, in orbit axes: 1 up, 2 ahead, 3 along the orbit normal.

    Without an attitude they are in body axes, and nothing of the orbit is among them.

    Args:
        attitude: q_body_from_orbit, if it is valid.
        field_body: field as measured, body axes.
        sun_body: direction to the Sun as measured, body axes.
        dipole_body: that the coils are driven to, body axes.
        torque_body: of it in the field, body axes.
    """

    def to_orbit(vector: Vec3) -> Vec3:
        return vector if attitude is None else rotate(conjugate(attitude), vector)

    found = {f"body {number}": to_orbit(axis) for number, axis in enumerate(AXES, start=1)}
    if attitude is not None:
        found |= {"nadir": (-1.0, 0.0, 0.0), "ahead": (0.0, 1.0, 0.0)}
    seen = {"field": field_body, "Sun": sun_body, "dipole": dipole_body, "torque": torque_body}
    for name, vector in seen.items():
        if vector is not None and norm(vector) > 0.0:
            found[name] = to_orbit(unit(vector))
    return found
