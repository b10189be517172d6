"""The onboard tables in the form the core uses: validated elsewhere, prepared once, never changed."""

from dataclasses import dataclass

from fsw.core.control import ControlConfig
from fsw.core.ephemeris import EphemerisModel
from fsw.core.estimator import EstimatorConfig
from fsw.core.modes import ModeConfig
from fsw.core.pulses import PulseConfig
from fsw.core.rates import RateTable


@dataclass(frozen=True, slots=True)
class FlightConfig:
    """Everything a step needs besides state and inbox."""

    tick_hz: int
    epoch_unix_s: int
    table_crc: int
    ephemeris: EphemerisModel
    estimator: EstimatorConfig
    control: ControlConfig
    pulses: PulseConfig
    modes: ModeConfig
    rates: RateTable
    stale_after_ticks: int
