"""The estimator's configuration: its noise from the table, its priors and limits from the bounds."""

from math import ceil, hypot, radians, sqrt

import numpy as np

from fsw.core.algebra.vector import inverse
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.changes import EDGE_S, NO_CHANGES, Changes
from fsw.core.estimation.estimator import EstimatorConfig
from fsw.core.estimation.kalman import Algebra
from fsw.core.estimation.mekf_config import MekfConfig, mekf_config
from fsw.core.estimation.orbital_attitude import MOST_AGED_TURN_RAD, MOST_TURN_RAD
from fsw.core.estimation.start.first import StartLimits
from fsw.core.fdir.sensors.plausibility import PlausibilityConfig
from fsw.core.fdir.sensors.standstill import Steps
from fsw.table.calibration import MagnetometerTable, largest_field_nt
from fsw.table.cells import cell_set
from fsw.table.ordinary import mean_moment
from fsw.table.sections import EstimatorTable
from fsw.table.table import FlightTable
from fsw.table.uncertainty import (
    LARGEST_FIELD_T,
    LEAST_FIELD_T,
    QUARTER_ORBIT_S,
    SIDE,
    Uncertainty,
    bounds,
    priors,
)

NT = 1e-9
GATE_NIS = 16.27
"""Chi-square with 3 degrees of freedom: 1 in 1000 sound samples is refused."""
START_SIGMA_RAD = radians(5.0)
"""Of the attitude that TRIAD gives at worst."""
CELLS_START = 2.0
"""The same from cells, in their ``model_sigma``: one of the three may see the Earth and not the Sun."""
MIN_SEPARATION_RAD = radians(15.0)
"""Of field and Sun at the start: TRIAD's error about the axis between them is then below 4 times theirs."""
MAX_REFUSALS_S = 60
"""The filter restarts after as many samples refused in a row as one sensor gives in this time."""
DRIVE_SIGMA = 0.002
"""Relative error of a driven dipole in a tick, independent of those in other ticks."""
TORQUE_NOISE_RTS = 0.05
"""White torque noise as a fraction of the torque's bound, times sqrt(s)."""
LEAST_NOISE_RTS = 1e-10
"""Its least value over the mean moment of inertia, rad/s^2 sqrt(s): it covers rounding."""
ORBIT_RADIUS_M = 7.0e6
QUARTER_PULSATION_S = 75.0
"""A quarter of the time in which the field of a storm pulsates."""


def estimator_config(table: FlightTable) -> EstimatorConfig:
    """Prepare the estimator."""
    tuning, known, tick_s = table.estimator, table_bounds(table), 1.0 / table.time.tick_hz
    cells = _cells(table, known)
    limits = plausibility_config(table)
    return EstimatorConfig(
        mekf=filter_config(table, tick_s, cells),
        perfect=table.knowledge == "perfect",
        start=StartLimits(
            max_field_error_t=limits.field_t + limits.field_part * LARGEST_FIELD_T,
            max_angle_error_rad=limits.angle_rad + limits.field_t / LEAST_FIELD_T,
            min_separation_rad=MIN_SEPARATION_RAD,
            albedo_error=0.5 * known.albedo,
        ),
        restart_after_rejections=MAX_REFUSALS_S * table.time.tick_hz,
        valid_sigma_rad=radians(tuning.valid_sigma_deg),
        usable_sigma_rad=radians(tuning.usable_sigma_deg),
        fastest_valid_radps=(MOST_AGED_TURN_RAD if known.latency_s > 0.0 else MOST_TURN_RAD) / tick_s,
        blank_ticks=ceil(known.latency_s * table.time.tick_hz - 1e-9),
        changes=changes_of(table),
    )


def filter_config(
    table: FlightTable, step_s: float, cells: CellSet | None = None, samples: float = 1.0
) -> MekfConfig:
    """Prepare the filter, for steps of this length that each have the mean of so many samples.

    Without ``cells`` a table with Sun cells has the Sun's direction that they would give.
    """
    tuning, known, inertia = table.estimator, table_bounds(table), table.body.inertia
    averaged = sqrt(1.0 / samples)
    return mekf_config(
        inertia,
        step_s,
        priors(known, inertia),
        wheel_body_nms=table.body.wheel_nms,
        driven_wheel=table.wheel is not None,
        magnetometer_sigma_t=averaged * field_noise_nt(tuning) * NT,
        sun_sigma_rad=averaged * _sun_sigma_rad(table),
        attitude_sigma_rad=START_SIGMA_RAD
        if cells is None
        else max(START_SIGMA_RAD, CELLS_START * cells.model_sigma),
        rate_sigma_radps=radians(tuning.rate_sigma_degps),
        torque_noise_nm_rts=max(TORQUE_NOISE_RTS * known.torque_nm, LEAST_NOISE_RTS * mean_moment(inertia)),
        dipole_sigma=DRIVE_SIGMA,
        gate_nis=GATE_NIS,
        cells=cells,
        algebra=Algebra(tuning.algebra),
    )


def changes_of(table: FlightTable) -> Changes:
    """What changes in orbit, from its bounds."""
    known = table_bounds(table)
    steps = (known.mag_shadow_t, known.shadow_dipole_am2, known.shadow_impulse_nms)
    if not any((*steps, known.storm_t, known.remanence_part)):
        return NO_CHANGES
    kick = SIDE * known.shadow_impulse_nms * np.array(inverse(table.body.inertia))
    return Changes(
        walk_t2ps=(SIDE * known.mag_orbit_t) ** 2 / QUARTER_ORBIT_S,
        edge_bias_t2ps=(SIDE * known.mag_shadow_t) ** 2 / EDGE_S,
        edge_dipole_a2m4ps=(SIDE * known.shadow_dipole_am2) ** 2 / EDGE_S,
        storm_t2ps=(SIDE * known.storm_t) ** 2 / QUARTER_PULSATION_S,
        remanent_ps=2.0 * (SIDE * known.remanence_part) ** 2 / table.coils.pulse_s,
        edge_rate=kick @ kick.T / EDGE_S if known.shadow_impulse_nms else None,
    )


def table_bounds(table: FlightTable) -> Uncertainty:
    """The bounds of the whole table."""
    albedo = None if table.cells is None else table.cells.albedo
    return bounds(table.uncertainty, table.ordinary, albedo)


def field_noise_nt(tuning: EstimatorTable) -> float:
    """Standard deviation of a reading: noise, and the error within a step, which is uniform: q / sqrt 12."""
    return hypot(tuning.magnetometer_sigma_nt, tuning.magnetometer_quantum_nt / sqrt(12.0))


def sun_noise_rad(tuning: EstimatorTable) -> float:
    """The same of the Sun's direction."""
    return hypot(radians(tuning.sun_sigma_deg), tuning.sun_quantum / sqrt(12.0))


def of_steps(tuning: EstimatorTable) -> tuple[float, float]:
    """The part of the variance of field and Sun that is the error within a step."""
    field_nt, sun = tuning.magnetometer_quantum_nt / sqrt(12.0), tuning.sun_quantum / sqrt(12.0)
    return (field_nt / field_noise_nt(tuning)) ** 2, (sun / sun_noise_rad(tuning)) ** 2


def _sun_sigma_rad(table: FlightTable) -> float:
    """The noise of the Sun's direction; with Sun cells, from their noise and the bounds of gain and light."""
    if table.cells is None:
        return sun_noise_rad(table.estimator)
    known = table_bounds(table)
    errors = (0.01 * table.cells.noise_percent, SIDE * known.cell_gain_part, SIDE * known.cell_light)
    return hypot(*errors, 0.01 * table.cells.quantum_percent / sqrt(12.0))


def _cells(table: FlightTable, known: Uncertainty) -> CellSet | None:
    if table.cells is None:
        return None
    sigmas = (SIDE * bound for bound in (known.cell_excess, known.cell_gain_part, known.earth_light))
    return cell_set(table.cells, *sigmas)


def plausibility_config(table: FlightTable) -> PlausibilityConfig:
    """The largest deviations if all is well, from the bounds and the noise at the edge of the gate.

    Along the orbit the field changes in strength and direction, relatively, by up to 3 times the distance
    flown over the orbit's radius.
    """
    known, tuning, sigmas = table_bounds(table), table.estimator, sqrt(GATE_NIS)
    noise_t, noise_rad = field_noise_nt(tuning) * NT, _sun_sigma_rad(table)
    model = known.mag_scale_part + 3.0 * known.along_track_m / ORBIT_RADIUS_M
    bias_t = known.mag_bias_t + known.mag_orbit_t + known.mag_shadow_t + known.storm_t
    field_t = sqrt(3.0) * (bias_t + sigmas * noise_t)
    sensor = table.calibration.magnetometer or MagnetometerTable()
    measurable_t = largest_field_nt(sensor.offset_nt, sensor.matrix, sensor.most_nt) * NT
    return PlausibilityConfig(
        field_t=field_t,
        field_part=model,
        in_range_t=(measurable_t - field_t) / (1.0 + model),
        angle_rad=known.mag_turn_rad + known.sun_turn_rad + model + sigmas * noise_rad,
        sun_norm=sigmas * noise_rad,
        late_ticks=ceil(known.latency_s * table.time.tick_hz - 1e-9),
        cells=_cells(table, known),
        steps=_steps(table),
        most_albedo=known.albedo,
    )


def _steps(table: FlightTable) -> Steps | None:
    """The steps of the readings; None where both are continuous."""
    tuning = table.estimator
    if not (tuning.magnetometer_quantum_nt or tuning.sun_quantum):
        return None
    return Steps(tuning.magnetometer_quantum_nt * NT, tuning.sun_quantum, 1.0 / table.time.tick_hz)
