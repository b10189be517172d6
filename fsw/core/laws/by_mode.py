"""Which law each mode flies."""

from fsw.core.laws.damping import bdot, rate_damping
from fsw.core.laws.interface import ControlConfig, Demand, Memory, Seen, Setpoint
from fsw.core.laws.predictive import predictive
from fsw.core.laws.table import LAWS
from fsw.wire.messages import Mode


def detumble(seen: Seen, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """By the estimated rate where it is known: predictive with pulses, else proportional. B-dot where not."""
    if not seen.attitude.valid:
        return bdot(seen, memory, setpoint, config)
    law = predictive if config.pulsed else rate_damping
    return law(seen, memory, setpoint, config)


def demand(
    mode: Mode, seen: Seen, memory: Memory, setpoint: Setpoint, config: ControlConfig
) -> Demand | None:
    """What the law of this mode asks for; in SAFE nothing at all."""
    match mode:
        case Mode.SAFE:
            return None
        case Mode.DETUMBLE:
            return detumble(seen, memory, setpoint, config)._replace(memory=())
        case Mode.ACQUIRE:
            return LAWS[setpoint.law].acquire(seen, memory, setpoint, config)
        case Mode.POINT:
            return LAWS[setpoint.law].point(seen, memory, setpoint, config)
