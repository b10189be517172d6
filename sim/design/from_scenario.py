"""The body on its circular orbit and the pulsing of its coils, from a scenario."""

from math import pi

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.orbit.tle import tle_elements
from sim.design.theory.bodies import EARTH_RADIUS_KM, MU_M3PS2, Body
from sim.design.theory.pulsed import Pulsing
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Array


def body_of(scenario: Scenario) -> Body:
    """The body, in the axes that the laws count by, and its orbit.

    For a TLE the circular orbit with its mean motion and inclination.
    """
    orbit = scenario.orbit
    inclination_deg = orbit.inclination_deg if orbit.tle is None else tle_elements(*orbit.tle).inclination_deg
    radius_m = (MU_M3PS2 * (orbit_period_s(scenario) / (2.0 * pi)) ** 2) ** (1.0 / 3.0)
    altitude_km = orbit.altitude_km if orbit.altitude_km is not None else radius_m / 1e3 - EARTH_RADIUS_KM
    body = scenario.body
    return Body(scenario.name, body.law_inertia, altitude_km, inclination_deg, body.law_wheel_nms)


def law_from_body(scenario: Scenario) -> Array:
    """The matrix that carries components in body axes to those in the axes of the laws, (3, 3)."""
    axes = scenario.body.law_axes
    return np.eye(3) if axes is None else np.array(dcm(axes.q_law_from_body)).round()


def pulsing_of(scenario: Scenario) -> Pulsing | None:
    """The pulsing: one coil in turn where they share their back-off; None for a continuous driver."""
    coils = scenario.coils
    if coils.driver == "continuous":
        return None
    return Pulsing(coils.pulse_s, coils.backoff_s, scenario.control.leak_s, coils.shared)
