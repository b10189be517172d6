"""What the ground, or the test of a coil, sets in the estimator: parameters loaded, frozen, thawed."""

from fsw.core.estimation.estimator import EstimatorState, discard_trace
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import with_component
from fsw.core.estimation.start.first import give_parameters


def load(state: EstimatorState, component: int, value: float, config: MekfConfig) -> None:
    """Give one component of the parameters a new value, now and whenever the filter starts.

    Its error is then that of the prior, uncorrelated with the others.

    Args:
        state: of the estimator.
        component: its number; it must be carried.
        value: SI units.
        config: the filter.
    """
    state.first = with_component(state.first or config.initial_parameters, component, value)
    state.loaded = tuple(sorted({*state.loaded, component}))
    forget(state, component, config)


def forget(state: EstimatorState, component: int, config: MekfConfig) -> None:
    """Forget what the estimate, if there is one, has learnt of one component of the parameters.

    It is back at what it starts from, with the prior's error; what the filter starts from stays.
    """
    if state.estimate is None:
        return
    first = state.first or config.initial_parameters
    give_parameters(state.estimate, first, (component,), config)
    discard_trace(state)


def freeze(state: EstimatorState) -> None:
    """Hold the parameters as they are, now and whenever the filter starts, until ``thaw``."""
    state.frozen = True
    if state.estimate is None:
        return
    discard_trace(state)
    state.first = state.estimate.parameters.copy()
    state.loaded = tuple(range(len(state.first.floats())))


def thaw(state: EstimatorState) -> None:
    """Estimate the parameters again."""
    state.frozen = False
