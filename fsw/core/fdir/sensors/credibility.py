"""Whether an estimate can be right: each parameter within what the bounds of the table allow.

A parameter is credible within ``SIGMAS`` standard deviations of its prior. The filter may explain a fault by
one beyond that: swapped axes of a Sun sensor by a misalignment, a twisting magnetometer by a bias.
"""

from dataclasses import dataclass
from math import sqrt

from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import COMPONENTS, OF_CELLS, component_places
from fsw.core.fdir.evidence import SIGMAS

OF_SENSORS = frozenset({"mag_bias_t", "mag_turn_rad", "mag_scale", "sun_turn_rad", "delay_s"})
"""Parameters that say how a sensor measures; the others say how the satellite moves."""


Limits = tuple[tuple[int, float, float], ...]
"""Place, least and largest credible value of each number that is estimated, among the ``Parameters``."""


@dataclass(frozen=True, slots=True)
class CredibilityConfig:
    """The limits of the parameters of the sensors, of all, and of all but those of the coils."""

    of_sensors: Limits
    of_all: Limits
    but_coils: Limits


def credibility_config(mekf: MekfConfig) -> CredibilityConfig:
    """The limits that follow from the filter's priors."""
    variances, means = mekf.initial_covariance.diagonal().tolist(), mekf.initial_parameters.floats()
    of_sensors, of_all, but_coils = [], [], []
    for number, place in component_places(mekf.layout).items():
        width = SIGMAS * sqrt(variances[place])
        name = COMPONENTS[number][0]
        if name in OF_CELLS:  # each cell is judged by itself, and the Earth's light is no sensor's fault
            continue
        limits = (number, means[number] - width, means[number] + width)
        of_all.append(limits)
        if name != "coil_error":
            but_coils.append(limits)
        if name in OF_SENSORS:
            of_sensors.append(limits)
    return CredibilityConfig(tuple(of_sensors), tuple(of_all), tuple(but_coils))


def is_credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether the satellite that the estimate assumes can be the one of the table."""
    return _is_within(estimate, config.of_all)


def is_credible_but_coils(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether it can be, apart from its coils: a weak one has a gain that is not credible."""
    return _is_within(estimate, config.but_coils)


def are_sensors_credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether its sensors can be those of the table."""
    return _is_within(estimate, config.of_sensors)


def _is_within(estimate: Estimate, limits: Limits) -> bool:
    numbers = estimate.parameters.floats()
    return all(low <= numbers[place] <= high for place, low, high in limits)
