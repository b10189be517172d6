"""What pointing to expect of coils, and how much of their time it takes.

Four parts that do not depend on each other add up by their squares:

- the floor: a dipole gives no torque along the field, so that a torque d(u) is balanced on the mean alone, by
  the periodic motion with the least mean square (``sim/design/theory/feedforward.py``). No law does better.
- the quantum: by how much the least level turns the body from one pulse to the next, about the axis that it
  turns most, q = m_1 B T_p (T_p + T_b) / J_min.
- the ripple: by how much the disturbance d turns that axis in the same time, r = d (T_p + T_b)^2 / J_min.
- the knowledge: the error of the estimate, by the covariance of the filter (``knowledge``).

The load is the part of the coils' time that balancing takes: the mean over an orbit of |m_1| + |m_2| + |m_3|
of the balancing dipole, over what one coil at a time gives, m_3 T_p / (T_p + T_b). Where each coil has a
back-off of its own, or is driven continuously, that of the coil with most to do counts, not the sum. Damping,
turns and what the filter does not know need the rest.

Equal principal moments are taken apart by ``SPREAD``: about such an axis nothing holds the body, and the
linear motion has no periodic answer to a torque, which the coils give it all the same.

A continuous driver has neither quantum nor back-off: its cycle is a tick.

B is the root mean square of the direct dipole's field across a coil's axis, B_0 sqrt(1 + 3/2 sin^2 i)
sqrt(2/3), since B^2 = B_0^2 (1 + 3 sin^2 i sin^2 u).
"""

from dataclasses import dataclass, replace
from math import degrees, hypot, inf, isnan, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from sim.design.from_scenario import body_of
from sim.design.theory.bodies import Body
from sim.design.theory.feedforward import least_error
from sim.scenario.schema import Scenario
from sim.sizing.knowledge import knowledge_of
from sim.sizing.torques import disturbance_torque

SPREAD = 1e-3


@dataclass(frozen=True, slots=True)
class Expectation:
    """What to expect.

    Attributes:
        field_t: B, across a coil's axis.
        disturbance_nm: root mean square of the disturbance torque over an orbit.
        floor_deg: error that no law avoids.
        quantum_deg: step of the least level.
        ripple_deg: turn by the disturbance between two pulses.
        knowledge_deg: error of the estimate.
        shadow_part: standard deviation of the estimate where it is least certain, mostly in the shadow, over
            the largest with which the control relies on it.
        load: part of the coils' time that balancing the disturbance takes; above 1 it cannot be balanced.
    """

    field_t: float
    disturbance_nm: float
    floor_deg: float
    quantum_deg: float
    ripple_deg: float
    knowledge_deg: float
    shadow_part: float
    load: float

    @property
    def pointing_deg(self) -> float:
        """Root mean square of the pointing error once settled."""
        return hypot(self.floor_deg, self.quantum_deg, self.ripple_deg, self.knowledge_deg)


class TorqueBalance(NamedTuple):
    """What balancing the disturbances takes, and leaves; as in ``Expectation``."""

    disturbance_nm: float
    floor_deg: float
    load: float


def expect(scenario: Scenario) -> Expectation:
    """What to expect of a satellite in its nominal attitude; what overflows is infinite.

    Raises:
        TableError: the onboard models have no orbit or field at the epoch.
    """
    body, coils, balance = apart(body_of(scenario)), scenario.coils, torque_balance(scenario)
    field_t, knowledge = field_across(body), knowledge_of(scenario)
    pulsed = coils.driver == "pulsed"
    cycle_s = coils.pulse_s + coils.backoff_s if pulsed else 1.0 / scenario.time.tick_hz
    with np.errstate(all="ignore"):
        least_kgm2 = float(np.linalg.eigvalsh(np.asarray(body.inertia_kgm2))[0])
        quantum_rad = coils.levels_am2[0] * field_t * coils.pulse_s * cycle_s / least_kgm2 if pulsed else 0.0
        ripple_rad = balance.disturbance_nm * cycle_s**2 / least_kgm2
    return Expectation(
        field_t=field_t,
        disturbance_nm=balance.disturbance_nm,
        floor_deg=balance.floor_deg,
        quantum_deg=_or_inf(degrees(quantum_rad)),
        ripple_deg=_or_inf(degrees(ripple_rad)),
        knowledge_deg=knowledge.rms_deg,
        shadow_part=knowledge.most_deg / knowledge.usable_deg,
        load=balance.load,
    )


def torque_balance(scenario: Scenario) -> TorqueBalance:
    """What balancing the disturbances takes in the nominal attitude; what overflows is infinite."""
    coils = scenario.coils
    with np.errstate(all="ignore"):
        torque_nm = disturbance_torque(scenario)
        response = least_error(apart(body_of(scenario)), torque_nm)
        by_coil_am2 = np.abs(response.dipole_am2).mean(axis=0)
        one_at_a_time = coils.driver == "pulsed" and coils.shared
        balancing_am2 = float(by_coil_am2.sum() if one_at_a_time else by_coil_am2.max())
        return TorqueBalance(
            _or_inf(float(np.sqrt(np.mean(np.sum(torque_nm**2, axis=1))))),
            _or_inf(degrees(response.rms_rad)),
            _or_inf(balancing_am2 / (coils.largest_am2 * coils.on_part)),
        )


def _or_inf(figure: float) -> float:
    """What is no number has overflowed on its way."""
    return inf if isnan(figure) else figure


def apart(body: Body) -> Body:
    """The body with moments about axes 2 and 3 that are a little larger, by unlike parts of their mean."""
    inertia = np.asarray(body.inertia_kgm2)
    inertia = inertia + np.diag([0.0, 0.5, 1.0]) * SPREAD * float(np.trace(inertia)) / 3.0
    rows = ((float(a), float(b), float(c)) for a, b, c in inertia)
    return replace(body, inertia_kgm2=(next(rows), next(rows), next(rows)))


def field_across(body: Body) -> float:
    """B, the root mean square of the field across a coil's axis [T]."""
    sine = sin(radians(body.inclination_deg))
    return body.field_t * sqrt((1.0 + 1.5 * sine * sine) * 2.0 / 3.0)
