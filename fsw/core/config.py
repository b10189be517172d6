"""The onboard tables in the form the core uses: validated elsewhere, prepared once, never changed."""

from dataclasses import dataclass

from fsw.core.actuation.actuator import ActuatorConfig
from fsw.core.actuation.own_field import OwnField
from fsw.core.actuation.read_back import ReadBackConfig
from fsw.core.estimation.estimator import EstimatorConfig
from fsw.core.fdir.fdir import FdirConfig
from fsw.core.gate.calibration import NO_CALIBRATION, Calibration
from fsw.core.gate.second_sender import SecondSenderConfig
from fsw.core.gate.sync_watch import LEAP_S
from fsw.core.laws.interface import ControlConfig, Wheel
from fsw.core.modes import ModeConfig
from fsw.core.orbit.ephemeris import EphemerisModel
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
    coils: ActuatorConfig
    read_back: ReadBackConfig
    fdir: FdirConfig
    modes: ModeConfig
    rates: RateTable
    second_sender: SecondSenderConfig
    stale_after_ticks: int
    event_spacing_ticks: int
    calibration: Calibration = NO_CALIBRATION
    own_field: OwnField | None = None
    wheel: Wheel | None = None
    """A wheel that can be driven, its axis in body axes; None: there is none."""

    @property
    def leap_ticks(self) -> int:
        """How far ahead a SYNC is believed at once."""
        return LEAP_S * self.tick_hz
