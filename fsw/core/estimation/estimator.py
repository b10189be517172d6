"""From readings to an estimate: start by TRIAD, then the filter, gated, blanked and restarted when lost."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from math import ceil
from typing import ClassVar, Final, final

from fsw.core.algebra.vector import ZERO, Vec3, dot, norm
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.relinearise import Linear, linear_about, relinearise
from fsw.core.estimation.cells.update import NO_CELLS, CellsUsed, update_cells
from fsw.core.estimation.changes import NO_CHANGES, Changes, fade, widen
from fsw.core.estimation.dynamics.error_dynamics import (
    FAST_SQUARE,
    KNOWN_VARIANCE,
    SLOW_RADPS,
    SLOW_SQUARE,
    Driven,
)
from fsw.core.estimation.kalman import largest_variance
from fsw.core.estimation.measurement import deflected_sun, field_sampled
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig, WheelMotion
from fsw.core.estimation.orbital_attitude import MOST_TURN_RAD
from fsw.core.estimation.parameters import ATTITUDE_AND_RATE, Parameters
from fsw.core.estimation.samples import saturated_field, sensed_sun, usable_cells, usable_field, usable_sun
from fsw.core.estimation.start.batch import SampleBatch, discard_samples, pass_tick
from fsw.core.estimation.start.first import (
    StartLimits,
    estimate_from_batch,
    first_estimate,
    give_parameters,
)
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference, earlier
from fsw.wire.value import Value

MAX_ELAPSED_S = 60.0
"""After a longer silence the filter restarts instead of predicting."""
WAIT_S: Final = 60.0
"""After the field has turned too far in a tick: it does so once a turn at least, unless it is the axis."""
EASED: Final = 2.0
"""Factor on the standard deviations of attitude, rate and bias when the estimate is eased, and from then on
on the bounds of what changes."""
MOST_EASINGS: Final = 2
"""Beyond four times its bounds, nothing is a change of this satellite."""
CELLS_RESTART = 2.0
"""Factor on the standard deviations of attitude and rate when the parameters start anew, with cells."""


class Turning(IntEnum):
    """Whether the satellite turns fast; the parameters start anew at KNOWN and when the turn ends.

    FAST: it does or it may, as after a start. KNOWN: its rate is known too; before, a sample seems not to
    depend on its age, and what is learnt of the parameters is wrong. The turn ends below ``SLOW_RADPS``: the
    errors it leaves in the parameters exceed their standard deviations.
    """

    NO = 0
    FAST = 1
    KNOWN = 2


@final
@dataclass(frozen=True, slots=True)
class EstimatorConfig:
    """Filter tuning and the tests around it; ``perfect`` takes the reference messages instead.

    ``blank_ticks``: for this long after a pulse a field sample may still date from it.
    """

    mekf: MekfConfig
    perfect: bool
    start: StartLimits
    restart_after_rejections: int
    valid_sigma_rad: float
    usable_sigma_rad: float
    fastest_valid_radps: float
    blank_ticks: int = 0
    changes: Changes = NO_CHANGES


@final
@dataclass(slots=True)
class EstimatorState:
    """The estimate, or None before start-up, and the measurements the gate refused in a row.

    ``first``: what the parameters start from, None: the prior's mean; of it, those components that were
    ``loaded``, by number. ``easings``: how often an estimate was eased. ``frozen``: the parameters are not
    estimated. ``batch``: samples for a start from fewer than three lit cells. ``wait_ticks``: until an
    estimate may start, for the body turned too far in a tick.
    """

    estimate: Estimate | None = None
    rejected_in_a_row: int = 0
    rejected_total: int = 0
    restarts: int = 0
    turning: Turning = Turning.NO
    first: Parameters | None = None
    frozen: bool = False
    batch: SampleBatch = field(default_factory=SampleBatch)
    loaded: tuple[int, ...] = ()
    easings: int = 0
    wait_ticks: int = 0

    def copy(self) -> "EstimatorState":
        """A state that goes on by itself from here."""
        return EstimatorState(
            None if self.estimate is None else self.estimate.copy(),
            self.rejected_in_a_row,
            self.rejected_total,
            self.restarts,
            self.turning,
            None if self.first is None else self.first.copy(),
            self.frozen,
            self.batch.copy(),
            self.loaded,
            self.easings,
            self.wait_ticks,
        )


@final
class Used(Value):
    """Which measurements were taken in this tick; with Sun cells ``sun`` is whether any was."""

    FIELDS: ClassVar[tuple[str, ...]] = ("field", "sun", "blanked", "cells")
    __slots__ = FIELDS

    def __init__(self, field: bool, sun: bool, blanked: bool, cells: CellsUsed = NO_CELLS) -> None:
        self.field = field
        self.sun = sun
        self.blanked = blanked
        self.cells = cells


NONE_USED = Used(False, False, False)


def predict(
    state: EstimatorState,
    reference: Reference,
    driven: Sequence[Driven],
    config: EstimatorConfig,
    wheel: WheelMotion | None = None,
) -> None:
    """Carry the estimate, if there is one, to this tick; drop it if it is too old or no longer sound.

    Args:
        state: of the tick before.
        reference: field, Sun and orbit at this tick.
        driven: over each tick since ``state``, the last of which ends now; several where a SYNC was lost.
        config: tuning.
        wheel: how a driven wheel moves over these ticks, if there is one.
    """
    if state.estimate is None:
        for one in driven:
            pass_tick(state.batch, one.m_body_am2, config.mekf.tick_s)
        return
    if len(driven) * config.mekf.tick_s > MAX_ELAPSED_S + 1e-6:
        restart(state)
        return
    _predict(state.estimate, reference, driven, config, wheel, _eased_variance(state))
    if not mekf.healthy(state.estimate):
        restart(state)


def _eased_variance(state: EstimatorState) -> float:
    """By what factor the variance of what changes grows, for it exceeded its bounds so often."""
    return EASED ** (2 * min(state.easings, MOST_EASINGS))


def _predict(
    estimate: Estimate,
    reference: Reference,
    driven: Sequence[Driven],
    config: EstimatorConfig,
    wheel: WheelMotion | None,
    eased: float,
) -> None:
    tuning = config.mekf
    gravity = 3.0 * MU_M3PS2 / reference.radius_m**3
    for left, one in enumerate(driven, 1 - len(driven)):
        e1_eci, b_eci_t = earlier(reference, -left * tuning.tick_s)
        mekf.predict(estimate, e1_eci, b_eci_t, gravity, one.m_body_am2, tuning, one.doubted_am2, wheel)
        widen(estimate, reference, one.m_body_am2, tuning, config.changes, eased)
        fade(estimate, tuning)


def update(
    state: EstimatorState,
    measurements: Measurements,
    reference: Reference,
    config: EstimatorConfig,
    wheel_nms: Vec3 = ZERO,
    field_turn_rad: float = 0.0,
) -> Used:
    """Take the samples of this tick, or start from them; which of them were taken.

    No estimate starts on a body that turns too far in a tick: it would be lost within a minute.

    Args:
        state: predicted to this tick.
        measurements: what the boards sent.
        reference: field, Sun and orbit at this tick.
        config: tuning.
        wheel_nms: momentum of a driven wheel, body axes.
        field_turn_rad: by how much the measured field has turned since the tick before.
    """
    field, sun, cells = usable_field(measurements), usable_sun(measurements), config.mekf.cells
    currents = usable_cells(measurements, cells)
    blanked = field is None and measurements.field is not None and measurements.field_trusted
    if state.estimate is None:
        if field_turn_rad > MOST_TURN_RAD:
            state.wait_ticks = ceil(WAIT_S / config.mekf.tick_s)
        elif state.wait_ticks > 0:
            state.wait_ticks -= 1
        started = state.wait_ticks == 0 and _start(state, field, sun, currents, reference, config)
        return Used(started, started, blanked)

    estimate, frozen = state.estimate, state.frozen
    limited = saturated_field(measurements)
    open_body: Vec3 | None = None
    if limited is not None:
        field, open_body = limited
        blanked = False
    b = field_sampled(estimate.parameters, reference.b_eci_t, reference.b_rate_eci_tps)
    known: Linear | None = None
    if cells is not None:
        seen = light(reference.r_eci_m, reference.sun_eci, cells.albedo) if currents else None
        known = linear_about(estimate, b, seen, config.mekf, cells)
    took_field = took_sun = False
    s_eci, slope_eci = deflected_sun(estimate.parameters, reference, config.mekf)
    if field is not None and sun is not None:
        took_field = took_sun = mekf.update_both(
            estimate, field, b, sun, s_eci, config.mekf, open_body, frozen, wheel_nms, slope_eci
        )
    if field is not None and not took_field:
        took_field = mekf.update_field(estimate, field, b, config.mekf, open_body, frozen, wheel_nms)
    if sun is not None and not took_sun:
        s_eci, slope_eci = deflected_sun(estimate.parameters, reference, config.mekf)  # the field moved them
        took_sun = mekf.update_sun(estimate, sun, s_eci, config.mekf, frozen, wheel_nms, slope_eci)
    rejected = (field is not None and not took_field) + (sun is not None and not took_sun)
    by_cell = NO_CELLS
    if cells is not None and known is not None:
        by_cell = update_cells(estimate, currents, known, config.mekf, cells, frozen, wheel_nms)
        relinearise(estimate, known, config.mekf, cells, frozen)
        took_sun = bool(by_cell.taken)
        rejected += len(by_cell.refused) > 1 and not took_sun  # one alone may be faulty
    in_a_row = 0 if not rejected and (took_field or took_sun) else state.rejected_in_a_row + rejected
    state.rejected_in_a_row = in_a_row
    state.rejected_total += rejected
    if not state.frozen:
        both = took_field and took_sun and (cells is None or sensed_sun(measurements, cells) is not None)
        _settle(state, estimate, both, config.mekf)
    if in_a_row >= config.restart_after_rejections or not mekf.healthy(estimate):
        restart(state)
    return Used(took_field, took_sun, blanked, by_cell)


def _start(
    state: EstimatorState,
    field: Vec3 | None,
    sun: Vec3 | None,
    currents: tuple[float | None, ...],
    reference: Reference,
    config: EstimatorConfig,
) -> bool:
    """Start from the samples of this tick, or of a batch, if they allow it."""
    if config.mekf.cells is None:
        estimate = first_estimate(field, sun, reference, config.start, config.mekf)
    else:
        estimate = estimate_from_batch(state.batch, field, currents, reference, config.start, config.mekf)
    if estimate is None:
        return False
    slow = norm(estimate.omega_body_radps) > 0.0 and norm(estimate.omega_body_radps) < SLOW_RADPS
    state.turning = Turning.NO if slow else Turning.FAST  # one tick shows no rate
    give_parameters(estimate, state.first, state.loaded, config.mekf)
    state.estimate = estimate
    discard_samples(state.batch)
    return True


def _settle(state: EstimatorState, estimate: Estimate, seen: bool, config: MekfConfig) -> None:
    """Set the parameters back to their priors where ``Turning`` requires it; the rest goes on.

    A rate that is hardly known, as after a start, is neither fast nor slow. Like a start, this takes both
    field and Sun, ``seen`` in this tick: with one alone the covariance of a start would not shrink.
    """
    square = dot(estimate.omega_body_radps, estimate.omega_body_radps)
    known = largest_variance(estimate.covariance, 3, 6) < KNOWN_VARIANCE
    if state.turning is Turning.NO and known and square > FAST_SQUARE:
        state.turning = Turning.FAST
    after = state.turning
    if known and square <= SLOW_SQUARE:
        after = Turning.NO
    elif known and state.turning is not Turning.NO and config.layout.delay is not None:
        after = Turning.KNOWN
    if after is state.turning or not seen:
        return
    again = mekf.start(estimate.q_body_from_eci, estimate.omega_body_radps, config)
    if config.cells is not None:  # with the attitude as uncertain as at a start, the filter would diverge
        covariance = again.covariance.copy()
        covariance[0:6, 0:6] = CELLS_RESTART**2 * estimate.covariance[0:6, 0:6]
        again.covariance = covariance
    give_parameters(again, state.first, state.loaded, config)
    state.estimate, state.turning = again, after


def ease_estimate(state: EstimatorState, config: MekfConfig) -> None:
    """Go on with attitude, rate and bias, less certain; put the other parameters back to their priors.

    What changes beyond its bounds has misled them. From here on it may change by twice as much.
    """
    estimate = state.estimate
    if estimate is None:
        return
    again = mekf.start(estimate.q_body_from_eci, estimate.omega_body_radps, config)
    bias, kept = config.layout.mag_bias, ATTITUDE_AND_RATE
    if bias is not None:
        kept = bias.stop
    covariance = again.covariance.copy()
    covariance[:kept, :kept] = EASED**2 * estimate.covariance[:kept, :kept]
    again.covariance = covariance
    give_parameters(again, state.first, state.loaded, config)
    again.parameters.mag_bias_t = estimate.parameters.mag_bias_t
    state.estimate = again
    state.easings += 1


def discard_trace(state: EstimatorState) -> None:
    """Forget the trace of deviations."""
    if state.estimate is not None:
        state.estimate.trace = None


def discard_estimate(state: EstimatorState) -> None:
    """Forget all of the past; that counts as a restart if there was an estimate."""
    if state.estimate is not None:
        restart(state)
    state.rejected_in_a_row = 0
    discard_samples(state.batch)


def restart(state: EstimatorState) -> None:
    """End the estimate: the next pair of good samples starts the filter."""
    state.estimate, state.rejected_in_a_row, state.turning = None, 0, Turning.NO
    state.restarts += 1
    discard_samples(state.batch)
