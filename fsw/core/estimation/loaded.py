"""What the ground, or the test of a coil, sets in the estimator: parameters loaded, frozen, thawed."""

from fsw.core.estimation.estimator import EstimatorState, untraced
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import with_component
from fsw.core.estimation.start.first import with_given


def load(state: EstimatorState, component: int, value: float, config: MekfConfig) -> EstimatorState:
    """The state with a new value of one component of the parameters, now and whenever the filter starts.

    Its error is then that of the prior, uncorrelated with the others.

    Args:
        state: before.
        component: its number; it must be carried.
        value: SI units.
        config: the filter.
    """
    first = with_component(state.first or config.initial_parameters, component, value)
    loaded = tuple(sorted({*state.loaded, component}))
    return forget(state._replace(first=first, loaded=loaded), component, config)


def forget(state: EstimatorState, component: int, config: MekfConfig) -> EstimatorState:
    """The state without what its estimate, if there is one, has learnt of one component of the parameters.

    It is back at what it starts from, with the prior's error; what the filter starts from stays.
    """
    if state.estimate is None:
        return state
    first = state.first or config.initial_parameters
    return untraced(state._replace(estimate=with_given(state.estimate, first, (component,), config)))


def freeze(state: EstimatorState) -> EstimatorState:
    """The state with the parameters held as they are, now and whenever the filter starts, until ``thaw``."""
    if state.estimate is None:
        return state._replace(frozen=True)
    first = state.estimate.parameters
    return untraced(state)._replace(first=first, frozen=True, loaded=tuple(range(len(first.floats()))))


def thaw(state: EstimatorState) -> EstimatorState:
    """The state with the parameters estimated again."""
    return state._replace(frozen=False)
