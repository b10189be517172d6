"""From readings to an estimate: start by TRIAD, then the filter, gated, blanked and restarted when lost."""

from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.algebra.quaternion import canonical, conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, Vec3, scale, sub
from fsw.core.estimation import mekf
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.triad import consistent, triad
from fsw.core.gate.readings import Readings
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference

TESLA_PER_NT = 1e-9
MAX_ELAPSED_TICKS = 60
"""After a longer silence the filter restarts instead of predicting."""


@dataclass(frozen=True, slots=True)
class EstimatorConfig:
    """Filter tuning and the tests around it; ``perfect`` takes the reference messages instead."""

    mekf: MekfConfig
    perfect: bool
    max_field_error_t: float
    max_angle_error_rad: float
    min_separation_rad: float
    restart_after_rejections: int
    valid_sigma_rad: float


class EstimatorState(NamedTuple):
    """The estimate, or None before start-up, and the measurements the gate refused in a row."""

    estimate: Estimate | None = None
    rejected_in_a_row: int = 0
    rejected_total: int = 0
    restarts: int = 0

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state, as are the next two."""
        return (self.rejected_in_a_row, self.rejected_total, self.restarts)

    def floats(self) -> tuple[float, ...]:
        """The estimate, if there is one, without its arrays."""
        return () if self.estimate is None else self.estimate.floats()

    def packed(self) -> bytes:
        """The arrays of the estimate."""
        return b"" if self.estimate is None else self.estimate.packed()


class Used(NamedTuple):
    """Which measurements were taken in this tick."""

    field: bool
    sun: bool
    blanked: bool


NONE_USED = Used(False, False, False)


def usable_field(readings: Readings) -> Vec3 | None:
    """The field sample, T; None where a coil was driven, its current still flowed, or either may be."""
    field, coil = readings.field, readings.coil
    if field is None or not field.valid or coil is None or coil.level != 0 or coil.current_ma != 0:
        return None
    return (field.b_x * TESLA_PER_NT, field.b_y * TESLA_PER_NT, field.b_z * TESLA_PER_NT)


def usable_sun(readings: Readings) -> Vec3 | None:
    """The measured Sun direction, or None."""
    sun = readings.sun
    return (sun.s_x, sun.s_y, sun.s_z) if sun is not None and sun.valid else None


def predict(
    state: EstimatorState,
    reference: Reference,
    m_body_am2: Vec3,
    elapsed_ticks: int,
    config: EstimatorConfig,
) -> EstimatorState:
    """Carry the estimate, if there is one, to this tick; without it where it is too old or no longer sound.

    Args:
        state: of the tick before.
        reference: field, Sun and orbit at this tick.
        m_body_am2: dipole driven over the tick that ends now, body axes.
        elapsed_ticks: ticks since ``state``; more than one where a SYNC was lost.
        config: tuning.
    """
    estimate = state.estimate
    if estimate is None:
        return state
    if elapsed_ticks > MAX_ELAPSED_TICKS:
        return restart(state)
    gravity = 3.0 * MU_M3PS2 / reference.radius_m**3
    e1_eci = scale(1.0 / reference.radius_m, reference.r_eci_m)
    for remaining in range(elapsed_ticks, 0, -1):
        dipole = m_body_am2 if remaining == 1 else ZERO
        estimate = mekf.predict(estimate, e1_eci, reference.b_eci_t, gravity, dipole, config.mekf)
    return state._replace(estimate=estimate) if mekf.healthy(estimate) else restart(state)


def update(
    state: EstimatorState, readings: Readings, reference: Reference, config: EstimatorConfig
) -> tuple[EstimatorState, Used]:
    """Take the samples of this tick, or start by them; also which of them were taken.

    Args:
        state: predicted to this tick.
        readings: what the boards sent.
        reference: field, Sun and orbit at this tick.
        config: tuning.
    """
    field, sun = usable_field(readings), usable_sun(readings)
    blanked = field is None and readings.field is not None
    if state.estimate is None:
        started = _start(field, sun, reference, config)
        return state._replace(estimate=started), Used(started is not None, started is not None, blanked)

    estimate, took_field, took_sun = _updated(state.estimate, field, sun, reference, config.mekf)
    rejected = (field is not None and not took_field) + (sun is not None and not took_sun)
    in_a_row = state.rejected_in_a_row + rejected
    if not rejected and (took_field or took_sun):
        in_a_row = 0
    updated = EstimatorState(estimate, in_a_row, state.rejected_total + rejected, state.restarts)
    lost = in_a_row >= config.restart_after_rejections or not mekf.healthy(estimate)
    return (restart(updated) if lost else updated), Used(took_field, took_sun, blanked)


def _updated(
    current: Estimate, field: Vec3 | None, sun: Vec3 | None, reference: Reference, config: MekfConfig
) -> tuple[Estimate, bool, bool]:
    """The estimate after what was measured, and whether field and Sun were taken."""
    b, s = reference.b_eci_t, reference.sun_eci
    if field is not None and sun is not None:
        after_both = mekf.update_both(current, field, b, sun, s, config)
        if after_both is not None:
            return after_both, True, True
    after_field = mekf.update_field(current, field, b, config) if field is not None else None
    current = after_field or current
    after_sun = mekf.update_sun(current, sun, s, config) if sun is not None else None
    return after_sun or current, after_field is not None, after_sun is not None


def orbital_attitude(state: EstimatorState, reference: Reference, config: EstimatorConfig) -> Attitude:
    """The estimate relative to the orbital frame."""
    estimate = state.estimate
    if estimate is None:
        return UNKNOWN
    q = canonical(multiply(conjugate(reference.q_orbit_from_eci), estimate.q_body_from_eci))
    e3_body = rotate(q, (0.0, 0.0, 1.0))
    omega = sub(estimate.omega_body_radps, scale(reference.orbit_rate_radps, e3_body))
    variances: list[float] = estimate.covariance.diagonal().tolist()
    sigma_attitude, sigma_rate = max(variances[0:3]) ** 0.5, max(variances[3:6]) ** 0.5
    return Attitude(
        q, omega, 3.0 * sigma_attitude, 3.0 * sigma_rate, sigma_attitude <= config.valid_sigma_rad
    )


def perfect_attitude(readings: Readings, before: Attitude) -> Attitude:
    """The attitude the reference messages give; the one before, no longer valid, where they are missing."""
    q, w = readings.ref_attitude, readings.ref_rate
    if q is None or w is None or not q.valid or not w.valid:
        return before._replace(valid=False)
    scalar = max(0.0, 1.0 - q.q_x**2 - q.q_y**2 - q.q_z**2) ** 0.5
    near_unit = (scalar, q.q_x, q.q_y, q.q_z)  # near 180 deg rounding makes the vector longer than 1
    return Attitude(normalise(near_unit), (w.w_x, w.w_y, w.w_z), 0.0, 0.0, True)


def _start(
    field: Vec3 | None, sun: Vec3 | None, reference: Reference, config: EstimatorConfig
) -> Estimate | None:
    if field is None or sun is None or not reference.lit:
        return None
    b, s = reference.b_eci_t, reference.sun_eci
    limits = (config.max_field_error_t, config.max_angle_error_rad, config.min_separation_rad)
    if not consistent(field, sun, b, s, *limits):
        return None
    return mekf.start(triad(sun, field, s, b), ZERO, config.mekf)


def untraced(state: EstimatorState) -> EstimatorState:
    """Without the trace of deviations."""
    estimate = state.estimate
    return state if estimate is None else state._replace(estimate=estimate._replace(trace=None))


def restart(state: EstimatorState) -> EstimatorState:
    """Without an estimate: the next pair of good samples starts the filter."""
    return EstimatorState(None, 0, state.rejected_total, state.restarts + 1)
