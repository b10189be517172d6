"""The offset of the current read-back: what a board reads of coils that are off is no current."""

from dataclasses import dataclass

from fsw.core.actuation.actuator import CoilView
from fsw.core.gate.measurements import CoilReport, Measurements


@dataclass(frozen=True, slots=True)
class ReadBackConfig:
    """Up to ``off_ma`` a current is an offset, from ``died_away_ticks`` after the last request on."""

    off_ma: float
    died_away_ticks: int


def remove_offset(measurements: Measurements, view: CoilView, tick: int, config: ReadBackConfig) -> None:
    """Take the current for none where all coils are off and what is read is an offset.

    The current of a pulse that dies away remains: its field is sensed too.

    Args:
        measurements: of this tick.
        view: of the tick before.
        tick: this one.
        config: limits.
    """
    coil = measurements.coil
    if coil is None or coil.current_ma == 0 or coil.level or abs(coil.current_ma) > config.off_ma:
        return
    if view.driven_level or (view.fired_tick >= 0 and tick < view.fired_tick + config.died_away_ticks):
        return
    measurements.coil = CoilReport(coil.level, coil.coil, coil.remaining_ms, 0, coil.lockout_ms, coil.seq)
