"""The offset of the current read-back: what a board reads of coils that are off is no current."""

from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView
from fsw.core.gate.readings import Readings
from fsw.wire.messages import CoilStatus


class ReadBackConfig(NamedTuple):
    """Up to ``off_ma`` a current is an offset, from ``died_away_ticks`` after the last request on."""

    off_ma: float
    died_away_ticks: int


def without_offset(readings: Readings, view: CoilView, tick: int, config: ReadBackConfig) -> Readings:
    """The readings with no current where all coils are off and what is read is an offset.

    The current of a pulse that dies away remains: its field is sensed too.

    Args:
        readings: of this tick.
        view: of the tick before.
        tick: this one.
        config: limits.
    """
    coil = readings.coil
    if coil is None or coil.current_ma == 0 or coil.level or abs(coil.current_ma) > config.off_ma:
        return readings
    if view.driven_level or (view.fired_tick >= 0 and tick < view.fired_tick + config.died_away_ticks):
        return readings
    coil = CoilStatus(coil.level, coil.coil, coil.remaining_ms, 0, coil.lockout_ms, coil.seq, coil.counter)
    return readings._replace(coil=coil)
