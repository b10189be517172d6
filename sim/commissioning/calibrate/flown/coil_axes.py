"""The coils' dipoles by what they do to the body, with the flight filter run on the ground.

The filter estimates m = (1 + G) m_driven with a prior of G that admits every axis, sense and gain. m_driven
is the nominal dipole of each output along the axis of its number, so that column j of 1 + G is the true
dipole of a nominal 1 A m^2 of output j.
"""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from fsw.core.algebra.vector import ZERO, norm, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig, mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.estimation.start.triad import triad
from fsw.core.orbit.earth import MU_M3PS2
from fsw.table.estimator import (
    DRIVE_SIGMA,
    LEAST_NOISE_RTS,
    START_SIGMA_RAD,
    TORQUE_NOISE_RTS,
    field_noise_nt,
    sun_noise_rad,
    table_bounds,
)
from fsw.table.ordinary import mean_moment
from fsw.table.table import FlightTable
from fsw.table.uncertainty import priors
from sim.commissioning.calibrate.flown.expected import Expected
from sim.commissioning.calibrate.flown.samples import Samples, whole
from sim.value_types import Array

ANY_COIL = 1.2
"""Standard deviation of a component of G: every coil within 1.5 of any axis is near."""
OF_THE_FIELD = {"mag_bias_t": 3e-6, "mag_turn_rad": 0.04, "mag_scale": 0.04}
"""What a short log leaves open of the magnetometer: standard deviations of offset, turn and scale."""
SHEAR_NT = 400.0
"""Of what that does not describe, as noise."""
GATE_NIS = 40.0
MOST_REFUSALS = 30
NT = 1e-9
RATE = slice(3, 6)
"""Of the error state."""


@dataclass(frozen=True, slots=True)
class CoilAxes:
    """Column j of ``matrix``: dipole, body axes, of a nominal 1 A m^2 of output j.

    ``covariance`` is that of the matrix by rows, (9, 9). ``refused``: share of the samples that the filter
    did not take.
    """

    matrix: Array
    covariance: Array
    refused: float

    def column(self, output: int) -> tuple[Array, Array]:
        """The dipole of an output, and its covariance."""
        places = [output, 3 + output, 6 + output]
        return self.matrix[:, output], self.covariance[np.ix_(places, places)]


def coil_axes(
    samples: Samples, b_body_nt: Array, usable: NDArray[np.bool_], along: Expected, table: FlightTable
) -> CoilAxes | None:
    """The coils' dipoles; None where there is no tick with field and Sun to start from.

    Args:
        samples: of the log.
        b_body_nt: field in body axes, (n, 3).
        usable: ticks whose field may be used.
        along: what the models expect.
        table: inertia, levels, noise and bounds.
    """
    config = _config(table)
    lit = whole(samples.sun)
    starts = np.flatnonzero(usable & lit)
    if not len(starts):
        return None
    levels = (0.0, *table.coils.levels_am2)
    strongest_radps_per_t = levels[-1] / table.time.tick_hz / float(np.linalg.eigvalsh(table.body.inertia)[0])
    field = (b_body_nt * NT).tolist()
    sun, b_eci = samples.sun.tolist(), (along.b_eci_nt * NT).tolist()
    s_eci, r_eci = along.sun_eci.tolist(), along.r_eci_m.tolist()
    estimate: Estimate | None = None
    refused = taken = in_a_row = 0
    for k in range(int(starts[0]), len(samples)):
        b, s, r = tuple(b_eci[k]), tuple(s_eci[k]), tuple(r_eci[k])
        if estimate is None:
            if usable[k] and lit[k]:
                estimate = mekf.start(triad(tuple(sun[k]), tuple(field[k]), s, b), ZERO, config)
            continue
        radius = norm(r)
        m = [0.0, 0.0, 0.0]
        level = int(samples.level[k])
        m[int(samples.coil[k])] = levels[abs(level)] * (1.0 if level > 0 else -1.0)
        gravity = 3.0 * MU_M3PS2 / radius**3
        mekf.predict(estimate, scale(1.0 / radius, r), b, gravity, (m[0], m[1], m[2]), config)
        if not samples.reported[k]:
            _doubt_rate(estimate, strongest_radps_per_t * norm(b))
        for seen, update, sample, reference in (
            (usable[k], mekf.update_field, field[k], b),
            (lit[k], mekf.update_sun, sun[k], s),
        ):
            if not seen:
                continue
            took = update(estimate, tuple(sample), reference, config)
            taken, refused = taken + took, refused + (not took)
            in_a_row = 0 if took else in_a_row + 1
        if not mekf.healthy(estimate) or in_a_row > MOST_REFUSALS:
            return None
    if estimate is None:
        return None
    coils = config.layout.coils
    matrix = np.eye(3) + np.array(estimate.parameters.coil_error).reshape(3, 3)
    return CoilAxes(matrix, estimate.covariance[coils, coils], refused / max(1, taken + refused))


def _doubt_rate(estimate: Estimate, by_radps: float) -> None:
    """After a tick in which any coil may have been driven: by so much the rate may have changed, rad/s."""
    covariance = estimate.covariance.copy()
    covariance[RATE, RATE] += by_radps**2 * np.eye(3)
    estimate.covariance = covariance


def _config(table: FlightTable) -> MekfConfig:
    """The filter of the table, but for a coil that may be any, and a sample that is not late."""
    known, tuning = table_bounds(table), table.estimator
    known = replace(known, latency_s=0.0)
    of_table = priors(known, table.body.inertia)
    of_table["coil_error"] = Prior((ANY_COIL,) * 9, (0.0,) * 9)
    for name, sigma in OF_THE_FIELD.items():
        of_table[name] = Prior((sigma,) * 3, (0.0,) * 3)
    return mekf_config(
        table.body.inertia,
        1.0 / table.time.tick_hz,
        of_table,
        wheel_body_nms=table.body.wheel_nms,
        magnetometer_sigma_t=hypot(field_noise_nt(tuning), SHEAR_NT) * NT,
        sun_sigma_rad=sun_noise_rad(tuning),
        attitude_sigma_rad=START_SIGMA_RAD,
        rate_sigma_radps=float(np.radians(tuning.rate_sigma_degps)),
        torque_noise_nm_rts=max(
            TORQUE_NOISE_RTS * known.torque_nm, LEAST_NOISE_RTS * mean_moment(table.body.inertia)
        ),
        dipole_sigma=DRIVE_SIGMA,
        gate_nis=GATE_NIS,
    )
