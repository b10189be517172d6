"""What the tests of Sun cells use: cells in no simple directions, and their filter."""

from math import radians

from fsw.core.algebra.quaternion import normalise
from fsw.core.algebra.vector import norm, unit
from fsw.core.estimation.cells.cell_set import CellSet, Shade
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
