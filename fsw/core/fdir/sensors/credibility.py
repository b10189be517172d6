"""Whether an estimate can be right: each parameter within what the bounds of the table allow.

A parameter is credible within ``SIGMAS`` standard deviations of its prior. The filter may explain a fault by
one beyond that: swapped axes of a Sun sensor by a misalignment, a twisting magnetometer by a bias.
"""

from dataclasses import dataclass
from math import inf, sqrt

from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import (
    COMPONENTS,
    NOTHING,
    OF_CELLS,
    Parameters,
    component,
    component_places,
    with_component,
)
from fsw.core.fdir.evidence import SIGMAS


@dataclass(frozen=True, slots=True)
class CredibilityConfig:
    """The least and the largest credible value of each parameter.

    Infinite where none is estimated; those of the cells do not count.
    """

    least: Parameters
    most: Parameters


def credibility_config(mekf: MekfConfig) -> CredibilityConfig:
    """The limits that follow from the filter's priors."""
    variances, places = mekf.initial_covariance.diagonal().tolist(), component_places(mekf.layout)
    least, most = NOTHING, NOTHING
    for number, (name, _) in enumerate(COMPONENTS):
        if name in OF_CELLS:  # each cell is judged by itself, and the Earth's light is no sensor's fault
            continue
        width = SIGMAS * sqrt(variances[places[number]]) if number in places else inf
        mean = component(mekf.initial_parameters, number)
        least = with_component(least, number, mean - width)
        most = with_component(most, number, mean + width)
    return CredibilityConfig(least, most)


def is_credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether the satellite that the estimate assumes can be the one of the table."""
    low, g, high = config.least.coil_error, estimate.parameters.coil_error, config.most.coil_error
    return (
        is_credible_but_coils(estimate, config)
        and _is_within((low[0], low[1], low[2]), (g[0], g[1], g[2]), (high[0], high[1], high[2]))
        and _is_within((low[3], low[4], low[5]), (g[3], g[4], g[5]), (high[3], high[4], high[5]))
        and _is_within((low[6], low[7], low[8]), (g[6], g[7], g[8]), (high[6], high[7], high[8]))
    )


def is_credible_but_coils(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether it can be, apart from its coils: a weak one has a gain that is not credible."""
    least, known, most = config.least, estimate.parameters, config.most
    low, j, high = least.inertia_error_kgm2, known.inertia_error_kgm2, most.inertia_error_kgm2
    return (
        are_sensors_credible(estimate, config)
        and _is_within(least.torque_body_nm, known.torque_body_nm, most.torque_body_nm)
        and _is_within(least.dipole_body_am2, known.dipole_body_am2, most.dipole_body_am2)
        and _is_within((low[0], low[1], low[2]), (j[0], j[1], j[2]), (high[0], high[1], high[2]))
        and _is_within((low[3], low[4], low[5]), (j[3], j[4], j[5]), (high[3], high[4], high[5]))
    )


def are_sensors_credible(estimate: Estimate, config: CredibilityConfig) -> bool:
    """Whether its sensors can be those of the table."""
    least, known, most = config.least, estimate.parameters, config.most
    low, age, high = least.delay_s, known.delay_s, most.delay_s
    return (
        _is_within(least.mag_bias_t, known.mag_bias_t, most.mag_bias_t)
        and _is_within(least.mag_turn_rad, known.mag_turn_rad, most.mag_turn_rad)
        and _is_within(least.mag_scale, known.mag_scale, most.mag_scale)
        and _is_within(least.sun_turn_rad, known.sun_turn_rad, most.sun_turn_rad)
        and low[0] <= age[0] <= high[0]
        and low[1] <= age[1] <= high[1]
    )


def _is_within(low: Vec3, v: Vec3, high: Vec3) -> bool:
    return low[0] <= v[0] <= high[0] and low[1] <= v[1] <= high[1] and low[2] <= v[2] <= high[2]
