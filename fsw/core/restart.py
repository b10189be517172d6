"""What is left of the flight state when the plant has restarted, or a forged SYNC pretends that it has.

As after a boot every timer starts in full and there is no attitude: what depends on the count of ticks means
nothing under another count. But fsw has not booted. What the ground has set, which units were found faulty,
how often a monitor has tripped, that there is a second sender, and what is counted since boot stay: a forged
SYNC must not bring back an isolated coil or sensor, nor end a SAFE that is to last.
"""

from fsw.core.actuation.actuator import LOCKOUT_UNKNOWN, CoilView
from fsw.core.actuation.pulses import boot
from fsw.core.actuation.wheel import WheelView
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.estimation.estimator import discard_estimate
from fsw.core.fdir import fdir
from fsw.core.laws.interface import FieldSample
from fsw.core.modes import ModeState
from fsw.core.state import FlightState


def begin_count(state: FlightState, tick: int, config: FlightConfig) -> None:
    """Make ``tick`` the first of a new count.

    A throttled event stays throttled for the rest of its time, a second sender detected for all of its time.
    """
    ahead, coil = tick - state.tick, state.coil
    state.tick = -1
    if state.second_sender.signs:
        state.second_sender.tick = tick
    state.ephemeris = None
    discard_estimate(state.estimator)
    fdir.discard_proof(state.health)
    state.attitude = UNKNOWN
    state.modes = ModeState(since_tick=tick, trips=state.modes.trips, held=state.modes.held)
    state.sample = FieldSample()
    state.memory = ()
    state.pulses = boot(tick, config.coils.pulses)
    state.coil = CoilView(LOCKOUT_UNKNOWN, seq=coil.seq, refusals=coil.refusals)
    state.events.reported = [kind.replace(tick=kind.tick + ahead) for kind in state.events.reported]
    if state.wheel is not None:
        state.wheel = WheelView(refused=state.wheel.refused)
