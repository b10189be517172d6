"""Fault detection, isolation and recovery as the flight loop calls it: one state, one configuration."""

from dataclasses import dataclass, field
from math import inf
from typing import Final, final

from fsw.core.actuation.actuator import CoilView, unexpected
from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState, Used, discard_estimate, discard_trace, ease_estimate
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.coils import currents, retest, torques
from fsw.core.fdir.coils import health as coil_health
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig
from fsw.core.fdir.coils.torques import BelievedParts
from fsw.core.fdir.faults import OPEN_PART
from fsw.core.fdir.sensors import health as sensor_health
from fsw.core.fdir.sensors import pair, plausibility
from fsw.core.fdir.sensors.cells import (
    cell_faults,
    forget_isolated,
    is_doubtful,
    isolated_cells,
    unusable_cells,
)
from fsw.core.fdir.sensors.credibility import is_credible_but_coils
from fsw.core.fdir.sensors.health import SensorConfig, SensorHealth
from fsw.core.fdir.sensors.pair import Pair, Standing
from fsw.core.fdir.sensors.plausibility import Findings, PlausibilityConfig
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.ephemeris import Reference


@dataclass(frozen=True, slots=True)
class FdirConfig:
    """Limits for samples, sensors and coils."""

    plausibility: PlausibilityConfig
    sensors: SensorConfig
    coils: CoilHealthConfig


@final
@dataclass(slots=True)
class Health:
    """What has been found of sensors and coils so far."""

    sensors: SensorHealth = field(default_factory=SensorHealth)
    coils: CoilHealth = field(default_factory=CoilHealth)


@final
class Evidence:
    """What health is judged by in one tick.

    ``findings`` are of all that the sensors sent; ``view`` is that of the coil driver; ``used`` is what the
    filter took. ``settled``: the time is not in doubt, and the bus tells that of the table; otherwise field
    and Sun may be those of another, and no sensor is judged by them. ``wheel_nms`` is the momentum of a
    driven wheel, body axes.
    """

    __slots__ = ("findings", "reference", "settled", "tick", "used", "view", "wheel_nms")

    def __init__(
        self,
        tick: int,
        findings: Findings,
        view: CoilView,
        reference: Reference,
        used: Used,
        settled: bool = True,
        wheel_nms: Vec3 = ZERO,
    ) -> None:
        self.tick = tick
        self.findings = findings
        self.view = view
        self.reference = reference
        self.used = used
        self.settled = settled
        self.wheel_nms = wheel_nms


def judge_current(
    health: Health, view: CoilView, measurements: Measurements, tick: int, config: FdirConfig
) -> None:
    """Compare what the coil driver reports with what was requested of it."""
    unasked = unexpected(view, tick, config.coils.pulses)
    currents.judge_current(health.coils, view, measurements, unasked, tick, config.coils)


def driven_am2(health: Health, view: CoilView, config: FdirConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, that of a stuck coil included."""
    return coil_health.driven_am2(health.coils, view, config.coils)


def examine(
    measurements: Measurements,
    health: Health,
    reference: Reference,
    config: FdirConfig,
    estimate: Estimate | None = None,
) -> Findings:
    """What the samples of this tick show by themselves; by an estimate, if it is valid, while they repeat."""
    memory, isolated = health.sensors.memory, isolated_cells(health.sensors.cells)
    return plausibility.examine(memory, measurements, reference, config.plausibility, estimate, isolated)


def judge_samples(measurements: Measurements, health: Health, findings: Findings) -> None:
    """Withhold samples from the filter: of an isolated sensor, and those that something speaks against.

    The Sun too while the pair is disputed, so that no estimate begins.
    """
    sensors = health.sensors
    disputed = sensors.pair.standing is Standing.DISPUTED
    measurements.field_trusted = not (sensors.field.fault or findings.field_cause)
    measurements.sun_trusted = not (sensors.sun.fault or findings.sun_cause or disputed)
    if sensors.cells:
        measurements.unusable_cells = unusable_cells(sensors.cells)


def judge(
    health: Health, estimator: EstimatorState, attitude: Attitude, evidence: Evidence, config: FdirConfig
) -> Attitude:
    """Compare what the sensors report with what the filter expects.

    Args:
        health: of this tick, currents judged.
        estimator: after the samples of this tick.
        attitude: as estimated.
        evidence: of this tick.
        config: limits.

    Returns:
        The attitude, which is not usable while a fault may have falsified it, and not valid before it is
        proven. The estimator is corrected, eased or restarted where a fault was found.
    """
    sensors, coils, used, weights = health.sensors, health.coils, evidence.used, config.sensors.weights
    if not evidence.settled:
        pair.skip_judgement(sensors.pair, used, estimator.estimate, weights)
        discard_trace(estimator)
        return _judged(attitude, health, used, config)
    field_before, sun_before = sensors.field.fault, sensors.sun.fault
    cells_before = cell_faults(sensors.cells)
    reference = evidence.reference
    sensor_health.judge_sensors(
        sensors, evidence.findings, used, estimator.estimate, reference, config.sensors
    )
    both, of_field, of_sun = sensors.pair, sensors.field.fault, sensors.sun.fault
    isolated = bool(of_field or of_sun)
    changed = of_field != field_before or of_sun != sun_before or cell_faults(sensors.cells) != cells_before
    if changed:
        forget_isolated(estimator, cells_before, sensors.cells, config.sensors.mekf)
    if changed or both.standing is not Standing.TRUSTED:
        discard_trace(estimator)  # what a faulty sensor has shown proves nothing about a coil
    elif not sensor_health.is_suspected(sensors):
        proven = pair.is_proven(both, weights)
        retest.retest(coils, estimator, proven and not isolated, config.coils)
        believed = _believed(estimator.estimate, both, proven or isolated, config)
        doubt, tick, view = both.doubt > 1.0, evidence.tick, evidence.view
        torques.judge_effect(
            coils, view, reference, estimator, tick, believed, doubt, config.coils, evidence.wheel_nms
        )
    if changed or both.ended or both.easing:
        coils.older = coil_health.NONE_OLDER  # a faulty sensor may have shown it
    if both.ended:
        discard_estimate(estimator)
        attitude = UNKNOWN
    elif both.easing:
        ease_estimate(estimator, config.sensors.mekf)
        return attitude.doubted()
    return _judged(attitude, health, used, config)


def _judged(attitude: Attitude, health: Health, used: Used, config: FdirConfig) -> Attitude:
    """The attitude as far as it can be relied on: not to be used where a fault may have falsified it."""
    if _is_inconclusive(health, used, config):
        return attitude.invalid()
    return attitude if pair.is_valid(health.sensors.pair) else attitude.doubted()


def _is_inconclusive(health: Health, used: Used, config: FdirConfig) -> bool:
    """Whether a fault may have falsified the attitude."""
    sensors, coils = health.sensors, health.coils
    return (
        coil_health.has_unassigned_torque(coils)
        or _has_unobservable_torque(coils, used, config)
        or _has_suspected_coil(coils, sensors.pair, config)
        or is_doubtful(sensors.cells, config.sensors.weights)
        or not pair.is_usable(sensors.pair, config.sensors.weights)
    )


UNKNOWN_PART: Final = 0.5
"""A sound coil's gain seems no lower on a satellite that differs from its table: one twice as heavy."""


def _believed(estimate: Estimate | None, both: Pair, proven: bool, config: FdirConfig) -> BelievedParts:
    """Which fractions of effect count as a coil's fault: none, those of a weak coil, or of a much weaker one.

    Parameters beyond the table's bounds may come from that coil, or make a sound one seem somewhat weak; so
    may whatever misled a filter that lagged. Single pulses then show an open coil or no coil's fault.
    """
    if not proven or estimate is None:
        return BelievedParts(-inf, -inf)
    weak_part = config.coils.weak.weak_part
    if not both.proof_required and is_credible_but_coils(estimate, config.sensors.credibility):
        return BelievedParts(weak_part, weak_part)
    return BelievedParts(OPEN_PART, min(UNKNOWN_PART, weak_part))


def _has_unobservable_torque(coils: CoilHealth, used: Used, config: FdirConfig) -> bool:
    """Whether a stuck coil, which blinds the magnetometer, turns a satellite of uncertain inertia.

    Nothing measures what the coil does to it about the Sun's direction, and with a somewhat wrong inertia the
    attitude is soon wrong by degrees.
    """
    return coils.stuck and not used.field and config.coils.mekf.layout.inertia is not None


def _has_suspected_coil(coils: CoilHealth, both: Pair, config: FdirConfig) -> bool:
    """Whether over half of what isolates a coil speaks against one, or the sensor that shows it is wrong."""
    if pair.is_proven(both, config.sensors.weights):
        return False
    weak = config.coils.weak
    for coil in range(3):
        if coils.older[coil].nats(weak) > 0.5 * weak.threshold and not coils.faults[coil]:
            return True
    return False


def discard_proof(health: Health) -> None:
    """Begin a new count of ticks: faults stay, what the lost estimate had proved does not."""
    pair.discard_proof(health.sensors.pair)
