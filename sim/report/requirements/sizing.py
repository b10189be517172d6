"""What the coils of a scenario can give on average, what its disturbances take, and what its levels cause."""

from contextlib import suppress
from dataclasses import dataclass
from math import degrees, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from fsw.input.schema import TableError
from sim.design.from_scenario import body_of, law_from_body
from sim.design.theory.bodies import Body
from sim.scenario.schema import Scenario
from sim.sizing.expectation import floor_deg, torque_balance
from sim.sizing.levels import MOST_LOAD, levels_against, two_digits
from sim.sizing.torques import orbit_nodes
from sim.value_types import Vec3


def mean_field_t(body: Body) -> float:
    """Root mean square of the direct dipole's field along the orbit, B0 sqrt(1 + 3/2 sin^2 i)."""
    return body.field_t * sqrt(1.0 + 1.5 * sin(radians(body.inclination_deg)) ** 2)


@dataclass(frozen=True, slots=True)
class MeanDipole:
    """Mean dipoles over an orbit, A m^2.

    Attributes:
        given: the most that the coils can give along any one axis.
        torque: that balances the disturbance torque.
        residual: that balances the residual dipole.
    """

    given: float
    torque: float
    residual: float

    @property
    def needed(self) -> float:
        """What both need."""
        return self.torque + self.residual


def mean_dipole(scenario: Scenario, torque_nm: Vec3) -> MeanDipole:
    """What coils can give, on_part m_3, against |T| / |B| and the largest residual dipole of an axis."""
    residual = max(abs(m) for m in scenario.disturbance.residual_dipole_am2)
    torque = float(np.linalg.norm(torque_nm)) / mean_field_t(body_of(scenario))
    return MeanDipole(scenario.coils.on_part * scenario.coils.largest_am2, torque, residual)


class Balance(NamedTuple):
    """What balancing the disturbances takes.

    Attributes:
        load: part of what the coils can give; above 1 they cannot.
        level_am2: highest level with which they would be strong enough, as ``torquer size`` says.
        of_dipole: whether most of it is the residual dipole's, not the torque's.
    """

    load: float
    level_am2: float
    of_dipole: bool


def balance(scenario: Scenario, torque_nm: Vec3, what: str) -> Balance:
    """What it takes: by the mean torque of the flight, and for the whole attitude by that of the scenario."""
    dipole = mean_dipole(scenario, torque_nm)
    load, of_dipole = dipole.needed / dipole.given, dipole.residual > dipole.torque
    if what != "attitude":
        return Balance(load, two_digits(scenario.coils.largest_am2 * load / MOST_LOAD), of_dipole)
    with suppress(TableError):  # of a flight in an orbit that elements or field do not outlast
        load = max(load, torque_balance(scenario).load)
    return Balance(load, levels_against(scenario, load)[2], of_dipole)


def least_error_deg(scenario: Scenario, orbits: float, torque_nm: Vec3) -> float | None:
    """The least RMS error of the whole attitude under a constant torque over the last of some orbits.

    None for a body that the gravity gradient leaves free, for which there is no periodic motion, and where
    the elements do not hold for an orbit.
    """
    try:
        last = orbit_nodes(scenario, max(0.0, orbits - 1.0))
        return floor_deg(scenario, law_from_body(scenario) @ torque_nm, last)
    except (np.linalg.LinAlgError, TableError):
        return None


def pulse_turn_deg(scenario: Scenario, what: str) -> float:
    """Amplitude of the libration that a pulse at level 1 can make, half of (m_1 |B| T_p / J) / w0, deg.

    J is the least moment of inertia about an axis that matters: of axis 1 those of axes 2 and 3.
    """
    body, coils = body_of(scenario), scenario.coils
    moments = [scenario.body.law_inertia[axis][axis] for axis in ((1, 2) if what == "axis" else (0, 1, 2))]
    rate_radps = coils.levels_am2[0] * mean_field_t(body) * coils.pulse_s / min(moments)
    return degrees(0.5 * rate_radps / body.rate_radps)


def gradient_level_am2(scenario: Scenario) -> float:
    """Highest level whose mean torque is the largest gravity gradient, 3/2 w0^2 (C - A) / |B| / on_part.

    Weaker coils cannot turn back a body that the gravity gradient holds upside down.
    """
    body = body_of(scenario)
    moments = np.linalg.eigvalsh(np.array(scenario.body.inertia))
    torque_nm = 1.5 * body.rate_radps**2 * float(moments[-1] - moments[0])
    return float(torque_nm / mean_field_t(body) / scenario.coils.on_part)
