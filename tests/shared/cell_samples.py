"""What the tests of Sun cells use: cells in no simple directions, and their filter."""

from dataclasses import replace
from math import radians

import numpy as np

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.algebra.vector import norm, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import CellSet, Shade, light
from fsw.core.estimation.cells.relinearise import linear_about, relinearise
from fsw.core.estimation.cells.update import update_cells
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.orbit.ephemeris import Reference

NORMALS = tuple(
    map(
        unit,
        (
            (1.0, 0.1, -0.2),
            (-1.0, 0.2, 0.1),
            (0.1, 1.0, 0.15),
            (-0.1, -1.0, 0.05),
            (0.2, -0.1, 1.0),
            (0.0, 0.1, -1.0),
        ),
    )
)
EXCESS_SIGMA, GAIN_SIGMA, LIGHT_SIGMA, NOISE_SIGMA = 0.06, 0.05, 0.08, 0.012
CELLS = CellSet(
    normals_body=NORMALS,
    full_sun=(1.0, 0.8, 1.2, 0.9, 1.1, 1.3),
    shades=((), (), (Shade((0.0, 1.0, 0.0), 0.9),), (), (), ()),
    dark=0.05,
    sigma=NOISE_SIGMA,
    excess_sigma=EXCESS_SIGMA,
    gain_sigma=GAIN_SIGMA,
    light_sigma=LIGHT_SIGMA,
    albedo=0.3,
)
Q_BODY_FROM_ECI = normalise((0.6, 0.4, -0.5, -0.3))
R_ECI_M = (-4.0e6, 5.0e6, 3.0e6)
REFERENCE = Reference(
    r_eci_m=R_ECI_M,
    radius_m=norm(R_ECI_M),
    b_eci_t=(1.7e-5, -2.3e-5, 3.1e-5),
    sun_eci=unit((-0.8, 0.35, 0.4)),
    lit=True,
    q_orbit_from_eci=normalise((0.3, 0.5, -0.7, 0.4)),
    orbit_rate_radps=1.04e-3,
)


def cell_filter(cells=CELLS, **priors):
    """A filter with these cells, the turn and age of their samples, and further parameters."""
    known = {
        "mag_bias_t": Prior((3e-7,) * 3, (1e-10,) * 3),
        "sun_turn_rad": Prior((0.01, 0.012, 0.008), (0.0,) * 3),
        "delay_s": Prior((0.3, 0.3), (0.0, 0.0), mean=(0.5, 0.4)),
        "cell_excess": Prior((cells.excess_sigma,) * 6, (0.0,) * 6),
        "cell_gain": Prior((cells.gain_sigma,) * 6, (0.0,) * 6),
        "earth_light": Prior((cells.light_sigma,), (0.0,)),
    }
    return mekf_config(
        ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45)),
        1.0,
        {**known, **priors},
        magnetometer_sigma_t=2e-7,
        sun_sigma_rad=radians(6.0),
        attitude_sigma_rad=radians(8.0),
        rate_sigma_radps=radians(0.5),
        torque_noise_nm_rts=1e-7,
        gate_nis=16.27,
        cells=cells,
    )


SEEN = light(REFERENCE.r_eci_m, REFERENCE.sun_eci, CELLS.albedo)
OMEGA = (0.004, -0.006, 0.003)
EXCESS = (0.03, -0.05, 0.04, -0.02, 0.06, -0.03)
GAIN = (0.04, 0.06, -0.05, 0.03, -0.02, 0.05)
LIGHT = 0.07


def begun(q=Q_BODY_FROM_ECI):
    """An estimate with parameters of their own."""
    estimate = mekf.start(q, OMEGA, cell_filter())
    known = replace(
        estimate.parameters,
        sun_turn_rad=(0.004, -0.006, 0.005),
        cell_excess=EXCESS,
        cell_gain=GAIN,
        earth_light=(LIGHT,),
    )
    return replace(estimate, parameters=known)


def shown(q_body_from_eci=Q_BODY_FROM_ECI, gain=(0.0,) * 6, light=0.0):
    """What cells show, without excess, turn and age: written out again."""
    s, e = rotate(q_body_from_eci, SEEN.s_eci), rotate(q_body_from_eci, SEEN.e_eci)
    earth = SEEN.earth * (1.0 + light / CELLS.albedo)
    return [
        (1.0 + more) * max(0.0, float(np.dot(normal, s)))
        + earth * (0.5 + 0.5 * float(np.dot(normal, e))) ** 2
        for normal, more in zip(CELLS.normals_body, gain, strict=True)
    ]


def cells_taken(estimate, currents, seen, config):
    """The estimate after these currents, by the equations about what it was, and which cells were taken."""
    cells = config.cells
    after = estimate.copy()
    known = linear_about(estimate, REFERENCE.b_eci_t, seen, config, cells)
    used = update_cells(after, currents, known, config, cells)
    relinearise(after, known, config, cells)
    return after, used
