"""A coil that was isolated is tried again: the fault may have passed, or the estimate may have been wrong.

Half of the evidence that isolates it stays: one pulse isolates it again whose current is wrong, or whose
effect weighs the other half and differs from that of all coils alike; one too small for that takes another.
Good ones cancel it. What the filter has learnt of its gain is forgotten. Ticks in which a sensor is suspected
do not count.
"""

from fsw.core.estimation.estimator import EstimatorState, discard_trace
from fsw.core.estimation.loaded import forget
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import COMPONENTS, component_places
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig, with_item
from fsw.core.fdir.coils.weak_test import Older
from fsw.core.fdir.faults import CoilFault

TRIED = (CoilFault.OPEN, CoilFault.WEAK, CoilFault.REVERSED)
"""Not a stuck one: it conducts without being tried."""
GAINS = tuple(COMPONENTS.index(("coil_error", 4 * coil)) for coil in range(3))


def retest(health: CoilHealth, estimator: EstimatorState, sure: bool, config: CoilHealthConfig) -> None:
    """Readmit a coil whose time has come.

    Args:
        health: of the tick before.
        estimator: after the samples of this tick.
        sure: the estimate is proven by both sensors, and will show what the coil does.
        config: limits.
    """
    first, second, third = health.faults
    if not (first or second or third):
        return
    first, second, third = health.until_retest
    health.until_retest = (max(0, first - 1), max(0, second - 1), max(0, third - 1))
    half = 0.5 * config.weak.threshold
    for coil in range(3):
        if sure and health.faults[coil] in TRIED and not health.until_retest[coil]:
            health.faults = with_item(health.faults, coil, 0)
            health.nats = with_item(health.nats, coil, half)
            health.older = with_item(health.older, coil, Older(kept=half))
            discard_trace(estimator)
            forget_gain(estimator, coil, config.mekf)


def forget_gain(state: EstimatorState, coil: int, mekf: MekfConfig) -> None:
    """Forget what the filter has learnt of the gain of a coil; not while parameters are frozen."""
    if not state.frozen and GAINS[coil] in component_places(mekf.layout):
        forget(state, GAINS[coil], mekf)
