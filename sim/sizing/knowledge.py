"""How well the filter would know the attitude of a satellite at rest in its nominal one.

The flight's own filter is carried along the orbit, in steps of ``STEP_S``, on samples that agree with it:
what comes of it is its covariance, by the noise of the sensors and all bounds of ``[flight.uncertainty]``. In
the light the Sun sensor decides; in the Earth's shadow the magnetometer alone is left, and what the table
grants to torque, dipole and bias. Small bodies in low orbits lose degrees there.

Flights of twelve cubesats, whose table was right but for bias, torque and residual dipole, had 0.2 to 0.8 of
that as the error; ``PART`` of it is expected.
"""

from dataclasses import dataclass
from math import degrees, inf, sqrt

from fsw.core.algebra.quaternion import IDENTITY, conjugate, multiply, rotate
from fsw.core.algebra.vector import ZERO, Vec3, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.changes import widen
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import advance, reference_at
from fsw.table.config import onboard_ephemeris
from fsw.table.estimator import changes_of, filter_config
from fsw.table.table import FlightTable
from sim.scenario.schema import Scenario, flight_table, orbit_period_s

STEP_S = 10
ORBITS = 3
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
    """The knowledge of a scenario's satellite; nothing is unknown where the plant tells the attitude."""
    if scenario.knowledge == "perfect":
        return Knowledge(0.0, 0.0, inf)
    table = flight_table(scenario)
    per_orbit = int(orbit_period_s(scenario) / STEP_S)
    last = _variances(table, ORBITS * per_orbit)[-per_orbit:]
    rms_rad = sqrt(sum(map(sum, last)) / len(last))
    most_rad = sqrt(max(map(max, last)))
    return Knowledge(PART * degrees(rms_rad), degrees(most_rad), table.estimator.usable_sigma_deg)


def _variances(table: FlightTable, steps: int) -> list[list[float]]:
    """The variance of the attitude about each body axis after each step, rad^2."""
    hz, model, changes = table.time.tick_hz, onboard_ephemeris(table), changes_of(table)
    config, driven_am2 = filter_config(table, STEP_S, samples=STEP_S * hz), _mean_drive_am2(table)
    axes, window, estimate, found = table.body.law_axes, None, None, []
    nominal = IDENTITY if axes is None else conjugate(axes.q_law_from_body)
    for tick in range(0, steps * STEP_S * hz, STEP_S * hz):
        window = advance(window, tick, model)
        if window is None:
            break
        reference = reference_at(window, tick, model)
        q_body_from_eci = multiply(reference.q_orbit_from_eci, nominal)
        omega_body_radps = rotate(nominal, (0.0, 0.0, reference.orbit_rate_radps))
        if estimate is None:
            estimate = mekf.start(q_body_from_eci, omega_body_radps, config)
        else:
            e1_eci = scale(1.0 / reference.radius_m, reference.r_eci_m)
            gravity_per_s2 = 3.0 * MU_M3PS2 / reference.radius_m**3
            mekf.predict(estimate, e1_eci, reference.b_eci_t, gravity_per_s2, ZERO, config)
            widen(estimate, reference, driven_am2, config, changes)
        estimate.q_body_from_eci, estimate.omega_body_radps = q_body_from_eci, omega_body_radps
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
