"""Whether an estimate can be right: each parameter within what the bounds of the table allow.

A parameter is credible within ``SIGMAS`` standard deviations of its prior. The filter may explain a fault by
one that is beyond: a Sun sensor with swapped axes as one that is turned, a twisting magnetometer as a bias.
"""

from math import inf
from typing import NamedTuple

from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import NAMES

SIGMAS = 4.0
OF_SENSORS = frozenset({"mag_bias_t", "mag_turn_rad", "mag_scale", "sun_turn_rad", "delay_s"})
"""Parameters that say how a sensor measures; the others say how the satellite moves."""


class CredibilityConfig(NamedTuple):
    """Least and largest credible value of every number of the ``Parameters``; infinite of those left out.

    ``of_sensors`` and ``of_all``: of the parameters of the sensors, and of all.
    """

    of_sensors: tuple[tuple[float, float], ...]
    of_all: tuple[tuple[float, float], ...]


def credibility_config(mekf: MekfConfig) -> CredibilityConfig:
    """The limits that follow from the filter's priors."""
    variances, carried = mekf.initial_covariance.diagonal(), dict(mekf.layout.carried)
    of_sensors, of_all = [], []
    for index, (name, means) in enumerate(zip(NAMES, mekf.initial_parameters, strict=True)):
        limits = [(-inf, inf)] * len(means)
        if index in carried:
            widths = (SIGMAS * variances[carried[index]] ** 0.5).tolist()
            limits = [(mean - width, mean + width) for mean, width in zip(means, widths, strict=True)]
        of_all += limits
        of_sensors += limits if name in OF_SENSORS else [(-inf, inf)] * len(means)
    return CredibilityConfig(tuple(of_sensors), tuple(of_all))


def credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether the satellite that the estimate assumes can be the one of the table."""
    return _within(estimate, config.of_all)


def sensors_credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether its sensors can."""
    return _within(estimate, config.of_sensors)


def _within(estimate: Estimate, limits: tuple[tuple[float, float], ...]) -> bool:
    for number, (low, high) in zip(estimate.parameters.floats(), limits, strict=True):
        if not low <= number <= high:
            return False
    return True
