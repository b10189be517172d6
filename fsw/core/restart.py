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
from fsw.core.estimation.estimator import anew
from fsw.core.events import Throttle
from fsw.core.fdir import fdir
from fsw.core.gate.second_sender import SecondSenderWatch
from fsw.core.laws.interface import FieldSample
from fsw.core.modes import ModeState
from fsw.core.state import FlightState


def restarted(state: FlightState, tick: int, config: FlightConfig) -> FlightState:
    """The state for which ``tick`` is the first of a new count.

    A throttled event stays throttled for the rest of its time, a second sender detected for all of its time.
    """
    other, events = state.second_sender, state.events
    reported = tuple(kind._replace(tick=tick - (state.tick - kind.tick)) for kind in events.reported)
    fdir.discard_proof(state.health)
    return state._replace(
        tick=-1,
        second_sender=SecondSenderWatch(other.signs, tick, other.can_id) if other.signs else other,
        ephemeris=None,
        estimator=anew(state.estimator),
        attitude=UNKNOWN,
        modes=ModeState(since_tick=tick, trips=state.modes.trips, held=state.modes.held),
        sample=FieldSample(),
        memory=(),
        pulses=boot(tick, config.coils.pulses),
        coil=CoilView(LOCKOUT_UNKNOWN, seq=state.coil.seq, refusals=state.coil.refusals),
        events=Throttle(reported, events.held_back),
        wheel=None if state.wheel is None else WheelView(refused=state.wheel.refused),
    )
