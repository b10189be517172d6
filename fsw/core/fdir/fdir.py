"""Fault detection, isolation and recovery as the flight loop calls it: one state, one configuration."""

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView, unexpected
from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState, Used, anew, untraced
from fsw.core.estimation.mekf import Estimate
from fsw.core.events import Event, Happening
from fsw.core.fdir.coils import currents, retest, torques
from fsw.core.fdir.coils import health as coil_health
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig
from fsw.core.fdir.coils.torques import BelievedParts
from fsw.core.fdir.faults import OPEN_PART, Sensor
from fsw.core.fdir.sensors import health as sensor_health
from fsw.core.fdir.sensors import pair, plausibility
from fsw.core.fdir.sensors.cells import cell_changes, doubtful, faulty, unusable, without_isolated
from fsw.core.fdir.sensors.credibility import credible_but_coils
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


class Health(NamedTuple):
    """What has been found of sensors and coils so far."""

    sensors: SensorHealth = SensorHealth()
    coils: CoilHealth = CoilHealth()


class Evidence(NamedTuple):
    """What health is judged by in one tick.

    ``findings`` are of all that the sensors sent; ``view`` is that of the coil driver; ``used`` is what the
    filter took. ``settled``: the time is not in doubt; otherwise field and Sun may be those of another,
    and no sensor is judged by them.
    """

    tick: int
    findings: Findings
    view: CoilView
    reference: Reference
    used: Used
    settled: bool = True


def judge_current(
    health: Health, view: CoilView, measurements: Measurements, tick: int, config: FdirConfig
) -> Health:
    """The health after comparing what the coil driver reports with what was requested of it."""
    unasked = unexpected(view, tick, config.coils.pulses)
    found = currents.judge_current(health.coils, view, measurements, unasked, tick, config.coils)
    return health if found is health.coils else Health(health.sensors, found)


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
    memory, isolated = health.sensors.memory, faulty(health.sensors.cells)
    return plausibility.examine(memory, measurements, reference, config.plausibility, estimate, isolated)


def judge_samples(measurements: Measurements, health: Health, findings: Findings) -> None:
    """Withhold samples from the filter: of an isolated sensor, and those that something speaks against.

    The Sun too while the pair is disputed, so that no estimate begins.
    """
    found = health.sensors
    measurements.field_trusted = not (found.field.fault or findings.field_cause)
    disputed = found.pair.standing is Standing.DISPUTED
    measurements.sun_trusted = not (found.sun.fault or findings.sun_cause or disputed)
    if found.cells:
        measurements.unusable_cells = unusable(found.cells)


def judge(
    health: Health, estimator: EstimatorState, attitude: Attitude, evidence: Evidence, config: FdirConfig
) -> tuple[Health, EstimatorState, Attitude]:
    """Compare what the sensors report with what the filter expects.

    Args:
        health: of this tick, currents judged.
        estimator: after the samples of this tick.
        attitude: as estimated.
        evidence: of this tick.
        config: limits.

    Returns:
        The health, the estimator corrected or restarted where a fault was found, and the attitude, which is
        not valid while a fault may have falsified it.
    """
    reference, findings = evidence.reference, evidence.findings
    before, found, weights = health.sensors, health.coils, config.sensors.weights
    if not evidence.settled:
        both = pair.unjudged(before.pair, evidence.used, estimator.estimate, weights)
        judged = before._replace(pair=both, memory=findings.memory)
        valid = attitude.valid and not _untold(judged, found, evidence.used, config)
        return Health(judged, found), untraced(estimator), attitude._replace(valid=valid)
    judged = sensor_health.judge(
        before, findings, evidence.used, estimator.estimate, reference, config.sensors
    )
    isolated = bool(judged.field.fault or judged.sun.fault)
    changed = sensor_health.faults(judged) != sensor_health.faults(before)
    if changed:
        estimator = without_isolated(estimator, before.cells, judged.cells, config.sensors.mekf)
    if changed or judged.pair.standing is not Standing.TRUSTED:
        estimator = untraced(estimator)  # what a faulty sensor has shown proves nothing about a coil
    elif not sensor_health.suspected(judged):
        proven, doubt = pair.proven(judged.pair, weights), judged.pair.doubt > 1.0
        found, estimator = retest.retest(found, estimator, proven and not isolated, config.coils)
        sure = _believed(estimator.estimate, judged.pair, proven or isolated, config)
        found, estimator = torques.judge_effect(
            found, evidence.view, reference, estimator, evidence.tick, sure, doubt, config.coils
        )
    if changed or judged.pair.ended:
        found = found._replace(older=coil_health.NONE_OLDER)  # a faulty sensor may have shown it
    if judged.pair.ended:
        estimator, attitude = anew(estimator), UNKNOWN
    if _untold(judged, found, evidence.used, config):
        attitude = attitude._replace(valid=False)
    return Health(judged, found), estimator, attitude


def _untold(judged: SensorHealth, found: CoilHealth, used: Used, config: FdirConfig) -> bool:
    """Whether a fault may have falsified the attitude."""
    torque_untold = (
        coil_health.unattributed_torque(found)
        or _turned_unseen(found, used, config)
        or _pulses_untold(found, judged.pair, config)
    )
    return torque_untold or doubtful(judged.cells, config.sensors.weights) or not pair.valid(judged.pair)


UNKNOWN_PART = 0.5
"""A sound coil's gain seems no lower on a satellite that differs from its table: one twice as heavy."""


def _believed(estimate: Estimate | None, both: Pair, proven: bool, config: FdirConfig) -> BelievedParts:
    """Which fractions of effect count as a coil's fault: none, those of a weak coil, or of a much weaker one.

    Parameters beyond the table's bounds may come from that coil, or make a sound one seem somewhat weak; so
    may whatever misled a filter that lagged. Single pulses then show an open coil or no coil's fault.
    """
    if not proven or estimate is None:
        return BelievedParts(-inf, -inf)
    weak_part = config.coils.weak.weak_part
    known = not both.owed and credible_but_coils(estimate, config.sensors.credibility)
    return (
        BelievedParts(weak_part, weak_part)
        if known
        else BelievedParts(OPEN_PART, min(UNKNOWN_PART, weak_part))
    )


def _turned_unseen(found: CoilHealth, used: Used, config: FdirConfig) -> bool:
    """Whether a stuck coil, which blinds the magnetometer, turns a satellite of uncertain inertia.

    Nothing measures what the coil does to it about the Sun's direction, and with a somewhat wrong inertia the
    attitude is soon wrong by degrees.
    """
    return found.stuck and not used.field and config.coils.mekf.layout.inertia is not None


def _pulses_untold(found: CoilHealth, both: Pair, config: FdirConfig) -> bool:
    """Whether over half of what isolates a coil speaks against one, or the sensor that shows it is wrong."""
    weak, each = config.coils.weak, zip(found.older, found.faults, strict=True)
    suspected = any(older.nats(weak) > 0.5 * weak.threshold and not fault for older, fault in each)
    return suspected and not pair.proven(both, config.sensors.weights)


def plant_restarted(health: Health) -> Health:
    """The health under a new count of ticks: faults stay, what the lost estimate had proved does not."""
    both = health.sensors.pair
    standing = Standing.NEW if both.standing is Standing.TRUSTED else both.standing
    return health._replace(sensors=health.sensors._replace(pair=both._replace(standing=standing, proof=0.0)))


def happenings(before: Health, after: Health) -> list[Happening]:
    """An event for each fault that is new or gone."""
    found = _sensor(Sensor.MAGNETOMETER, before.sensors.field.fault, after.sensors.field.fault)
    found += _sensor(Sensor.SUN_SENSOR, before.sensors.sun.fault, after.sensors.sun.fault)
    for cell, fault, now_fault in cell_changes(before.sensors.cells, after.sensors.cells):
        found += _sensor(Sensor(Sensor.CELL_1 + cell), fault, now_fault)
    was, now = before.sensors.pair.standing, after.sensors.pair.standing
    if now is Standing.DISPUTED and was is not now:
        found.append(Happening(Event.SENSORS_DISAGREE, 0))
    if after.coils is not before.coils:
        found += _coils(before.coils.faults, after.coils.faults)
    return found


def _sensor(sensor: Sensor, before: int, after: int) -> list[Happening]:
    """A sensor whose fault has changed."""
    if before == after:
        return []
    if after:
        return [Happening(Event.SENSOR_ISOLATED, 100 * sensor + after)]
    return [Happening(Event.SENSOR_READMITTED, 100 * sensor + before)]


def _coils(before: tuple[int, int, int], after: tuple[int, int, int]) -> list[Happening]:
    """Coils whose fault is new or gone."""
    return [
        Happening(Event.COIL_FAULT if fault else Event.COIL_READMITTED, 100 * coil + (fault or was))
        for coil, (was, fault) in enumerate(zip(before, after, strict=True), start=1)
        if fault != was
    ]
