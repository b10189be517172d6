"""How much the coils of a continuous driver were driven, from the plant's mean dipole of each tick.

The plant's dipole is the true one, body axes. What is driven and what is dissipated is by the current of each
coil, for which its nominal dipole stands here.
"""

import numpy as np
from numpy.typing import NDArray

from sim.plant.hardware.coils import body_from_coils
from sim.scenario.assemble import coil_config
from sim.scenario.schema import Scenario
from sim.value_types import Array

RESIDUAL = 1e-5
"""Fraction of full scale below which a coil counts as not driven: less than the least dipole on the wire."""


def nominal_dipole_am2(scenario: Scenario, dipole_am2: Array) -> Array:
    """The dipole k i that the current of each coil nominally gives, by coil, from the true one in body axes.

    m = A diag(s) k i, the columns of A the true axes of the coils, s their ``dipole_scale``. A coil that
    gives no dipole, s = 0, counts as not driven.

    Args:
        scenario: of the flight.
        dipole_am2: m, (n, 3).
    """
    config = coil_config(scenario)
    axes, scale = body_from_coils(config.misalignment_rad, config.wiring), np.array(config.dipole_scale)
    if axes is None and (scale == 1.0).all():
        return dipole_am2
    true_from_nominal = (np.eye(3) if axes is None else np.array(axes)) * scale
    result: Array = dipole_am2 @ np.linalg.pinv(true_from_nominal).T
    return result


def dipole_squared_a2m4s(scenario: Scenario, dipole_am2: Array) -> float:
    """Integral of |k i|^2 from the mean dipole of each tick, (n, 3); for a pulsed driver too.

    A continuous driver drives 1 / f times the mean over the fraction f of a tick. The rise of the current is
    neglected: it is short against a tick. Times resistance over (dipole per ampere)^2 it is the energy
    dissipated in the coils.
    """
    coils = scenario.coils
    fraction = coils.on_fraction if coils.driver == "continuous" else 1.0
    return float(np.sum(nominal_dipole_am2(scenario, dipole_am2) ** 2)) / fraction / scenario.time.tick_hz


def driven_coils(scenario: Scenario, dipole_am2: Array) -> NDArray[np.bool_]:
    """Whether a continuous driver drove each coil, by tick, (n, 3); decay does not count."""
    coils = scenario.coils
    full_scale_am2 = coils.on_fraction * (coils.max_dipole_am2 or 0.0)
    driven: NDArray[np.bool_] = np.abs(nominal_dipole_am2(scenario, dipole_am2)) > RESIDUAL * full_scale_am2
    return driven


def driven_s(scenario: Scenario, dipole_am2: Array) -> float:
    """Time for which a continuous driver drove any coil, a fraction of each tick."""
    driven = driven_coils(scenario, dipole_am2).any(axis=1)
    return scenario.coils.on_fraction * float(np.count_nonzero(driven)) / scenario.time.tick_hz
