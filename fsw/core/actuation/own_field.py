"""The coils' own field at the magnetometer: subtracted from a sample if known; otherwise it is blanked.

A sample shows the coils as they were ``newest`` to ``oldest`` ticks before. If one dipole m, or none, was
driven throughout those ticks, and each was reported, b = z - F m. Otherwise a coil may have switched within
the age of the sample.
"""

from dataclasses import dataclass

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.pulses import dipole_am2
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, row, scale, sub, transform
from fsw.core.gate.measurements import FieldReading, Measurements
from fsw.core.laws.plan.pulse_model import AXES

SOUND = (0.7, 1.3)
"""Fractions of its nominal current between which a driven coil has about its nominal field."""


@dataclass(frozen=True, slots=True)
class OwnField:
    """The field F m of the coils at the magnetometer, nT, body axes, and the ages at which it shows, ticks.

    ``field_nt_per_am2``: column j is the field of a nominal dipole of 1 A m^2 of the coil along axis j;
    ``levels_am2`` and ``current_ma`` are those of levels 1, 2, 3.
    """

    field_nt_per_am2: Mat3
    newest: int
    oldest: int
    levels_am2: Vec3
    current_ma: Vec3


def subtract_own_field(
    view: CoilView, measurements: Measurements, blank_ticks: int, config: OwnField | None
) -> None:
    """Free the field sample of what the coils add, or mark it; remember what was driven in this tick.

    Args:
        view: after ``update_view``.
        measurements: of this tick.
        blank_ticks: for this long after a pulse a sample may date from it, where that field is not known.
        config: None: the coils' field is not known.
    """
    if config is None:
        measurements.quiet = view.idle_ticks > blank_ticks
        return
    _remember(view, measurements, config)
    shown = view.past_am2[config.newest : config.oldest + 1]
    if len(shown) <= config.oldest - config.newest or any([m_am2 != shown[0] for m_am2 in shown]):
        measurements.quiet = False
    else:
        _subtract(measurements, shown[0], config)


def _remember(view: CoilView, measurements: Measurements, config: OwnField) -> None:
    """Add what was driven in the tick that just ended; forget all if that is uncertain."""
    if not _certain(measurements, config):
        view.past_am2 = ()
        return
    m_am2 = scale(dipole_am2(view.driven_level, config.levels_am2), row(AXES, view.driven_coil))
    view.past_am2 = (m_am2, *view.past_am2)[: config.oldest + 1]


def _certain(measurements: Measurements, config: OwnField) -> bool:
    """Whether the driver has reported, and the current is that of the level."""
    status = measurements.coil
    if status is None or status.level == 0:
        return status is not None and status.current_ma == 0
    nominal_ma = config.current_ma[abs(status.level) - 1]
    low, high = SOUND[0] * nominal_ma, SOUND[1] * nominal_ma
    return low <= (status.current_ma if status.level > 0 else -status.current_ma) <= high


def _subtract(measurements: Measurements, m_am2: Vec3, config: OwnField) -> None:
    field, measurements.settled = measurements.field, True
    if field is not None and m_am2 != ZERO:
        own_nt = transform(config.field_nt_per_am2, m_am2)
        measurements.field = FieldReading(field.valid, sub(field.b_body_nt, own_nt))
