"""Fault detection, isolation and recovery as the flight loop calls it: one state, one configuration."""

from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.actuation.actuator import CoilView, unexpected
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.estimator import EstimatorState, Used, restart, untraced
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.samples import usable_field, usable_sun
from fsw.core.events import Event, Happening
from fsw.core.fdir import coil_health, sensor_health
from fsw.core.fdir.coil_health import CoilHealth, CoilHealthConfig
from fsw.core.fdir.sensor_health import SensorHealth
from fsw.core.fdir.sensor_watch import Sensor, SensorHealthConfig
from fsw.core.gate.readings import Readings
from fsw.core.orbit.ephemeris import Reference


@dataclass(frozen=True, slots=True)
class FdirConfig:
    """Limits for sensors and coils, and what the coils and the filter are set to."""

    sensors: SensorHealthConfig
    coils: CoilHealthConfig
    pulses: PulseConfig
    mekf: MekfConfig


class Health(NamedTuple):
    """What is found of sensors and coils so far."""

    sensors: SensorHealth = SensorHealth()
    coils: CoilHealth = CoilHealth()

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state, as is ``floats``."""
        return (*self.sensors.integers(), *self.coils.integers())

    def floats(self) -> tuple[float, ...]:
        """Those of the sensors: the coils have none."""
        return self.sensors.floats()


class Evidence(NamedTuple):
    """What health is judged by in one tick.

    ``readings`` are all that the boards sent, of isolated sensors too; ``view`` is that of the coil driver;
    ``used`` is what the filter took.
    """

    tick: int
    readings: Readings
    view: CoilView
    reference: Reference
    used: Used


def judge_current(
    health: Health, view: CoilView, readings: Readings, tick: int, config: FdirConfig
) -> Health:
    """The health after comparing what the coil driver reports with what was asked of it."""
    unasked = unexpected(view, tick, config.pulses)
    coils = coil_health.judge_current(
        health.coils, view, readings, unasked, tick, config.pulses, config.coils
    )
    return Health(health.sensors, coils)


def driven_am2(health: Health, view: CoilView, config: FdirConfig) -> Vec3:
    """Dipole over the tick that has ended, body axes, that of a stuck coil included."""
    return coil_health.driven_am2(health.coils, view, config.pulses, config.coils)


def trusted(readings: Readings, health: Health, reference: Reference) -> Readings:
    """The readings from which the filter may be updated."""
    return sensor_health.trusted(readings, health.sensors, reference)


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
        not valid while a fault may be what it shows.
    """
    readings, reference = evidence.readings, evidence.reference
    sensors = sensor_health.judge(
        health.sensors,
        readings,
        usable_field(readings),
        usable_sun(readings),
        reference,
        evidence.used,
        estimator.estimate,
        attitude.sigma3_attitude_rad,
        config.sensors,
    )
    coils = health.coils
    if sensor_health.in_doubt(sensors, config.sensors):
        estimator = untraced(estimator)
    else:
        coils, estimator = coil_health.judge_rate(
            coils,
            evidence.view,
            reference.b_eci_t,
            estimator,
            evidence.tick,
            config.pulses,
            config.coils,
            config.mekf,
        )
    if sensors.doubted:
        estimator, attitude = restart(estimator), UNKNOWN
    if coil_health.unattributed_torque(coils):
        attitude = attitude._replace(valid=False)
    return Health(sensors, coils), estimator, attitude


def plant_restarted(health: Health) -> Health:
    """The health under a new count of ticks: faults stay, what the lost estimate had proved does not."""
    pair = health.sensors.pair
    pair = pair._replace(proof=min(pair.proof, 0))
    return Health(health.sensors._replace(pair=pair), health.coils)


def happenings(before: Health, after: Health) -> list[Happening]:
    """An event for each fault that is new or gone."""
    found = _sensor(Sensor.MAGNETOMETER, before.sensors.field.fault, after.sensors.field.fault)
    found += _sensor(Sensor.SUN_SENSOR, before.sensors.sun.fault, after.sensors.sun.fault)
    if after.sensors.pair.contradictory and not before.sensors.pair.contradictory:
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
    """Coils whose fault is new."""
    return [
        Happening(Event.COIL_FAULT, 100 * coil + fault)
        for coil, (was, fault) in enumerate(zip(before, after, strict=True), start=1)
        if fault and fault != was
    ]
