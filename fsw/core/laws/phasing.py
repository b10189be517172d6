"""Each coil in both polarities, one after the other, whatever the attitude: to see what coils and sensors do.

Pulse n = 0, 1, ... is of coil n mod 3, at the highest level unless another is set; after each three the
polarity changes, so that what it does to the rate nearly cancels. The law asks for nothing else, needs no
attitude, and is flown in every mode but SAFE: a satellite that is wired wrongly must not be controlled.
"""

from dataclasses import dataclass

from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.plan.pulse_model import NO_PULSE, Pulse

COILS = 3


@dataclass(frozen=True, slots=True)
class PhasingGains:
    """Which level is fired, and how often each coil is fired in both polarities; 0 rounds: without end."""

    level: float = 3.0
    rounds: float = 0.0

    def __post_init__(self) -> None:
        """Check them.

        Raises:
            ValueError: no such level, or a fraction of a round.
        """
        if self.level not in (1.0, 2.0, 3.0):
            raise ValueError(f"level must be 1, 2 or 3, not {self.level:g}")
        if not (0.0 <= self.rounds <= 1e6 and self.rounds.is_integer()):
            raise ValueError(f"rounds must be a whole number, not {self.rounds:g}")


def phasing(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The pulse to fire in answer to this tick; memory is the number of those that were asked for."""
    gains: PhasingGains = config.gains["phasing"]
    asked = int(memory[0]) if len(memory) == 1 else 0
    if not config.pulsed or (gains.rounds and asked >= 2 * COILS * gains.rounds):
        return Demand(memory=(float(asked),), pulse=NO_PULSE)
    if inputs.wait_ticks[asked % COILS] < 0:  # isolated: its turn passes
        return Demand(memory=(float(asked + 1),), pulse=NO_PULSE)
    if inputs.wait_ticks[asked % COILS] > 0:
        return Demand(memory=(float(asked),), pulse=NO_PULSE)
    return Demand(memory=(float(asked + 1),), pulse=nth_pulse(asked, int(gains.level)))


def nth_pulse(number: int, level: int) -> Pulse:
    """The pulse of this number, counted from 0."""
    return Pulse(number % COILS, level if number // COILS % 2 == 0 else -level)


LAWS = {
    "phasing": LawEntry(70, Aim.CHECK, phasing, phasing, PhasingGains, needs=Need.PULSES, open_loop=True),
}
