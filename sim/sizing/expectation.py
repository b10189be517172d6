"""What pointing to expect of coils, how much of their time it takes, and how long they take to stop a tumble.

Five parts that do not depend on each other add up by their squares:

- the floor: a dipole gives no torque along the field, so that a torque d(u) is balanced on the mean alone, by
  the periodic motion with the least mean square (``sim/design/theory/feedforward.py``). No law does better.
  The Earth turns under the orbit, so that the field, and the floor with it, depend on the hour of the day:
  it is determined for each orbit of a day, as if its field were that of every orbit; the largest counts.
- the quantum: by how much the least level turns the body from one pulse to the next, about the axis that it
  turns most, q = m_1 B T_p (T_p + T_b) / J_min.
- the ripple: by how much the disturbance d turns that axis in the same time, r = d (T_p + T_b)^2 / J_min.
- the variation: how the body answers drag and sunlight less their mean under the table's PD gains: the filter
  takes the torque on the body for constant, so that a law learns of what varies by the error alone.
- the knowledge: the error of the estimate, by the covariance of the filter (``knowledge_of``).

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
from numpy.typing import ArrayLike

from fsw.core.algebra.quaternion import IDENTITY, conjugate, multiply, rotate
from fsw.core.algebra.vector import ZERO, Vec3, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.changes import widen
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import advance, reference_at
from fsw.table.config import onboard_ephemeris
from fsw.table.estimator import changes_of, filter_config
from fsw.table.table import FlightTable
from sim.design.from_scenario import body_of, law_from_body
from sim.design.theory.bodies import Body
from sim.design.theory.feedforward import answer, least_error
from sim.design.theory.linear import Gains
from sim.scenario.controlled import SLOW_DEGPS, SLOWEST_DEGPS
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.scenario.sections import ScenarioCoils
from sim.sizing.torques import OrbitNodes, day_of, disturbance_torque, orbit_nodes, surface_torque

# --- How well the filter would know the attitude of a satellite at rest in its nominal one

KNOWN_STEP_S = 10
KNOWN_ORBITS = 3
"""The last one counts."""
PART = 0.5


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What is known of the attitude over an orbit.

    Attributes:
        rms_deg: error to expect, root mean square.
        most_deg: standard deviation of the filter about the axis that it knows least, where it is largest.
        usable_deg: up to it the control relies on the estimate.
    """

    rms_deg: float
    most_deg: float
    usable_deg: float


def knowledge_of(scenario: Scenario) -> Knowledge:
    """The knowledge of a scenario's satellite; nothing is unknown where the plant tells the attitude.

    The flight's own filter is carried along the orbit, in steps of ``KNOWN_STEP_S``, on samples that agree
    with it; attitude and parameters stay as they are, as rounding would lead them astray. What comes of it
    is its covariance, by the noise of the sensors and all bounds of ``[flight.uncertainty]``. In the light
    the Sun sensor decides; in the Earth's shadow the magnetometer alone is left, and what the table grants to
    torque, dipole and bias. Small bodies in low orbits lose degrees there.

    Flights of twelve cubesats, whose table was right but for bias, torque and residual dipole, had 0.2 to 0.8
    of that as the error; ``PART`` of it is expected.
    """
    if scenario.knowledge == "perfect":
        return Knowledge(0.0, 0.0, inf)
    table = flight_table(scenario)
    per_orbit = int(orbit_period_s(scenario) / KNOWN_STEP_S)
    last = _variances(table, KNOWN_ORBITS * per_orbit)[-per_orbit:]
    rms_rad = sqrt(sum(map(sum, last)) / len(last))
    most_rad = sqrt(max(map(max, last)))
    return Knowledge(PART * degrees(rms_rad), degrees(most_rad), table.estimator.usable_sigma_deg)


def _variances(table: FlightTable, steps: int) -> list[list[float]]:
    """The variance of the attitude about each body axis after each step, rad^2."""
    hz, model, changes = table.time.tick_hz, onboard_ephemeris(table), changes_of(table)
    config, driven_am2 = filter_config(table, KNOWN_STEP_S, samples=KNOWN_STEP_S * hz), _mean_drive_am2(table)
    axes, window, estimate, found = table.body.law_axes, None, None, []
    nominal = IDENTITY if axes is None else conjugate(axes.q_law_from_body)
    for tick in range(0, steps * KNOWN_STEP_S * hz, KNOWN_STEP_S * hz):
        window = advance(window, tick, model)
        if window is None:
            break
        reference = reference_at(window, tick, model)
        q_body_from_eci = multiply(reference.q_orbit_from_eci, nominal)
        omega_body_radps = rotate(nominal, (0.0, 0.0, reference.orbit_rate_radps))
        if estimate is None:
            estimate = mekf.start(q_body_from_eci, omega_body_radps, config)
            parameters = estimate.parameters.copy()
        else:
            e1_eci = scale(1.0 / reference.radius_m, reference.r_eci_m)
            gravity_per_s2 = 3.0 * MU_M3PS2 / reference.radius_m**3
            mekf.predict(estimate, e1_eci, reference.b_eci_t, gravity_per_s2, ZERO, config)
            widen(estimate, reference, driven_am2, config, changes)
        estimate.q_body_from_eci, estimate.omega_body_radps = q_body_from_eci, omega_body_radps
        estimate.parameters = parameters.copy()
        b_eci_t, sun_eci = reference.b_eci_t, reference.sun_eci
        b_body_t = rotate(q_body_from_eci, b_eci_t)
        if reference.lit:
            mekf.update_both(estimate, b_body_t, b_eci_t, rotate(q_body_from_eci, sun_eci), sun_eci, config)
        else:
            mekf.update_field(estimate, b_body_t, b_eci_t, config)
        found.append(estimate.covariance.diagonal()[:3].tolist())
    return found


def _mean_drive_am2(table: FlightTable) -> Vec3:
    """The root mean square of each coil's dipole: of pulses at the middle level, or a tenth of full scale."""
    coils = table.coils
    used_am2 = coils.levels_am2[1] if coils.driver == "pulsed" else 0.1 * coils.largest_am2
    each_am2 = used_am2 * sqrt(coils.on_part / 3.0)
    return each_am2, each_am2, each_am2


# --- The error to expect

SPREAD = 1e-3


@dataclass(frozen=True, slots=True)
class Expectation:
    """What to expect.

    Attributes:
        field_t: B, across a coil's axis.
        disturbance_nm: root mean square of the disturbance torque over an orbit.
        floor_deg: error that no law avoids, in the orbit of a day in which it is largest.
        least_floor_deg: the same in the orbit in which it is least.
        quantum_deg: step of the least level.
        ripple_deg: turn by the disturbance between two pulses.
        variation_deg: error by what of drag and sunlight varies along the orbit.
        knowledge_deg: error of the estimate.
        shadow_part: standard deviation of the estimate where it is least certain, mostly in the shadow, over
            the largest with which the control relies on it.
        load: part of the coils' time that balancing the disturbance takes; above 1 it cannot be balanced.
    """

    field_t: float
    disturbance_nm: float
    floor_deg: float
    least_floor_deg: float
    quantum_deg: float
    ripple_deg: float
    variation_deg: float
    knowledge_deg: float
    shadow_part: float
    load: float

    @property
    def pointing_deg(self) -> float:
        """Root mean square of the pointing error once settled, in the worst orbit of a day."""
        return self._with_floor(self.floor_deg)

    @property
    def least_pointing_deg(self) -> float:
        """The same in the best one."""
        return self._with_floor(self.least_floor_deg)

    def _with_floor(self, floor_deg: float) -> float:
        return hypot(floor_deg, self.quantum_deg, self.ripple_deg, self.variation_deg, self.knowledge_deg)


class TorqueBalance(NamedTuple):
    """The disturbances, and what balancing them takes; as in ``Expectation``."""

    disturbance_nm: float
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
        floors_deg = [
            _or_inf(floor_deg(scenario, disturbance_torque(scenario, nodes), nodes))
            for nodes in day_of(scenario)
        ]
        varied_deg = variation_deg(scenario)
    return Expectation(
        field_t=field_t,
        disturbance_nm=balance.disturbance_nm,
        floor_deg=max(floors_deg),
        least_floor_deg=min(floors_deg),
        quantum_deg=_or_inf(degrees(quantum_rad)),
        ripple_deg=_or_inf(degrees(ripple_rad)),
        variation_deg=_or_inf(varied_deg),
        knowledge_deg=knowledge.rms_deg,
        shadow_part=knowledge.most_deg / knowledge.usable_deg,
        load=balance.load,
    )


def variation_deg(scenario: Scenario) -> float:
    """RMS of the answer to drag and sunlight less their mean, in the first orbit, under the table's gains."""
    if not scenario.body.plates:
        return 0.0
    body, control = apart(body_of(scenario)), scenario.control
    torque_nm = surface_torque(scenario, orbit_nodes(scenario)) @ law_from_body(scenario).T
    theta_rad = answer(body, Gains(control.k_w, control.k_a), torque_nm - torque_nm.mean(axis=0))
    return degrees(sqrt(float(np.mean(np.sum(theta_rad**2, axis=1)))))


def torque_balance(scenario: Scenario) -> TorqueBalance:
    """What balancing the disturbances takes in the nominal attitude; what overflows is infinite.

    The dipoles are those in the direct dipole's field: those of the least error in a field that does not
    close after an orbit are several times as large, and gain little.
    """
    coils = scenario.coils
    with np.errstate(all="ignore"):
        torque_nm = disturbance_torque(scenario, orbit_nodes(scenario))
        response = least_error(apart(body_of(scenario)), torque_nm)
        by_coil_am2 = np.abs(response.dipole_am2).mean(axis=0)
        one_at_a_time = coils.driver == "pulsed" and coils.shared
        balancing_am2 = float(by_coil_am2.sum() if one_at_a_time else by_coil_am2.max())
        return TorqueBalance(
            _or_inf(float(np.sqrt(np.mean(np.sum(torque_nm**2, axis=1))))),
            _or_inf(balancing_am2 / (coils.largest_am2 * coils.on_part)),
        )


def floor_deg(scenario: Scenario, torque_nm: ArrayLike, nodes: OrbitNodes) -> float:
    """The least RMS error under a torque in the axes of the laws, in the field of an orbit."""
    body = apart(body_of(scenario))
    return degrees(least_error(body, torque_nm, b_orbit=nodes.b_orbit_t / body.field_t).rms_rad)


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


# --- How long the coils take to stop a tumble, with and without the limits of pulses

ONE_AT_A_TIME, EACH, CONTINUOUS = 0.7, 1.25, 1.1
"""c of coils that share their back-off, that have one each, and that are driven continuously."""
LAST_ORBITS = 2.5
USUAL_DEGPS: Vec3 = (10.0, 10.0, 10.0)
"""About each axis, after a rough separation: where the scenario begins slowly."""


@dataclass(frozen=True, slots=True)
class Detumbling:
    """How long it takes from a rate, by how the coils are driven [s].

    Attributes:
        rate_degps: at the start.
        to_slow_s: until it stays below 1 deg/s.
        to_slowest_s: until it stays below 0.1 deg/s.
        continuous_to_slow_s: the first, by the same dipole driven continuously.
        orbit_s: the orbit's period.
    """

    rate_degps: float
    to_slow_s: float
    to_slowest_s: float
    continuous_to_slow_s: float
    orbit_s: float


def detumbling(scenario: Scenario) -> Detumbling:
    """The time to stop the rate at which the scenario begins, or a usual one where it begins slowly.

    B-dot with the strongest level takes angular momentum away at c m_3 B p, B being the field across a coil's
    axis, p the part of the time for which a coil may be driven, and c how well the coils stand to the field
    and to the rate: measured on flights of two cubesats at 5 to 17 deg/s, within a quarter. From 1 to 0.1
    deg/s takes 1 to 5 orbits more: B-dot ends at twice the orbital rate, with which the field turns; the law
    does the rest.
    """
    began = scenario.initial.rate_degps
    rate_degps = np.array(began if np.linalg.norm(began) > SLOW_DEGPS else USUAL_DEGPS)
    rate = float(np.linalg.norm(rate_degps))
    momentum_nms = float(np.linalg.norm(np.asarray(scenario.body.inertia) @ np.radians(rate_degps)))
    per_degps_nms, orbit_s = momentum_nms / rate, orbit_period_s(scenario)
    coils, across_nm = scenario.coils, scenario.coils.largest_am2 * field_across(body_of(scenario))
    continuous = coils.driver == "continuous"
    part = coils.on_part * (CONTINUOUS if continuous else ONE_AT_A_TIME if coils.shared else EACH)
    freely = CONTINUOUS * (coils.on_part if continuous else ScenarioCoils.model_fields["on_fraction"].default)
    to_slow_nms = per_degps_nms * (rate - SLOW_DEGPS)
    to_slowest_nms = per_degps_nms * (rate - SLOWEST_DEGPS)
    return Detumbling(
        rate,
        to_slow_nms / (across_nm * part),
        to_slowest_nms / (across_nm * part) + LAST_ORBITS * orbit_s,
        to_slow_nms / (across_nm * freely),
        orbit_s,
    )


def detumbling_words(found: Detumbling, continuous: bool) -> str:
    """In hours and orbits, with what a driver without pulse limits would take."""
    text = (
        f"from {found.rate_degps:.3g} deg/s under 1 deg/s in {_long(found.to_slow_s, found.orbit_s)}, "
        f"under 0.1 in {_long(found.to_slowest_s, found.orbit_s)}"
    )
    if continuous:
        return text
    freely = _long(found.continuous_to_slow_s, found.orbit_s)
    return f'{text}; without pulse limits, coils.driver = "continuous", under 1 deg/s in {freely}'


def _long(time_s: float, orbit_s: float) -> str:
    hours = f"{time_s / 3600.0:.2g} h" if time_s < 72.0 * 3600.0 else f"{time_s / 86400.0:.2g} days"
    return f"{hours} ({time_s / orbit_s:.2g} orbits)"
