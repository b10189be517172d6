"""Coil levels: fine enough to point, strong enough to turn the satellite and to balance what disturbs it.

With B the field across a coil's axis (``sim/sizing/expectation.py``), T_p the length of a pulse, and moments
of inertia J_min <= ... <= J_max:

- a pulse of the least level changes the rate of the lightest axis by w0 / 20: m_1 = w0 J_min / (20 B T_p);
- one of the strongest changes the rate of the heaviest by w0 / 4: m_3 = w0 J_max / (4 B T_p), or more where
  balancing the disturbance would take more than a tenth of the coils' time;
- the middle one is their geometric mean.
"""

from math import sqrt

import numpy as np

from sim.design.from_scenario import body_of
from sim.design.theory.bodies import Body
from sim.scenario.schema import Scenario
from sim.sizing.expectation import field_across

Levels = tuple[float, float, float]

FINE, COARSE = 20.0, 4.0
"""Orbital rate over the change of rate by a pulse of the least and of the strongest level."""
MOST_LOAD = 0.1
"""Part of the coils' time that balancing should take at most."""
TOO_WEAK = 0.5
"""Part of it from which coils are too weak to point with."""


def levels_for(body: Body, pulse_s: float) -> Levels:
    """The levels of a body without disturbances, A m^2, to two digits."""
    moments = np.linalg.eigvalsh(np.asarray(body.inertia_kgm2))
    scale = body.rate_radps / (field_across(body) * pulse_s)
    return _rounded(float(moments[0]) * scale / FINE, float(moments[-1]) * scale / COARSE)


def levels_against(scenario: Scenario, load: float) -> Levels:
    """The levels for a satellite whose coils now take this load, A m^2, to two digits."""
    low, _, high = levels_for(body_of(scenario), scenario.coils.pulse_s)
    return _rounded(low, max(high, scenario.coils.levels_am2[2] * load / MOST_LOAD))


def _rounded(low_am2: float, high_am2: float) -> Levels:
    return two_digits(low_am2), two_digits(sqrt(low_am2 * high_am2)), two_digits(high_am2)


def two_digits(value: float) -> float:
    """A positive number to two significant digits."""
    return float(f"{value:.2g}")
