"""What the ground, or the test of a coil, sets in the estimator: parameters loaded, frozen, thawed."""

from fsw.core.estimation.estimator import EstimatorState, untraced
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import component_places, with_component


def load(state: EstimatorState, component: int, value: float, config: MekfConfig) -> EstimatorState:
    """The state with a new value of one component of the parameters, now and whenever the filter starts.

    Its error is then that of the prior, uncorrelated with the others.

    Args:
        state: before.
        component: its number; it must be carried.
        value: SI units.
        config: the filter.
    """
    estimate = state.estimate
    first = with_component(state.first or config.initial_parameters, component, value)
    if estimate is None:
        return state._replace(first=first)
    place = component_places(config.layout)[component]
    covariance = estimate.covariance.copy()
    covariance[place, :] = covariance[:, place] = config.initial_covariance[place]
    parameters = with_component(estimate.parameters, component, value)
    loaded = estimate._replace(parameters=parameters, covariance=covariance, trace=None)
    return state._replace(first=first, estimate=loaded)


def freeze(state: EstimatorState) -> EstimatorState:
    """The state with the parameters held as they are, now and whenever the filter starts, until ``thaw``."""
    first = state.first if state.estimate is None else state.estimate.parameters
    return untraced(state)._replace(first=first, frozen=True)


def thaw(state: EstimatorState) -> EstimatorState:
    """The state with the parameters estimated again."""
    return state._replace(frozen=False)
