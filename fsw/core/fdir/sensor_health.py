"""Which sensor is faulty, and when it is readmitted.

Five checks need no attitude: the field's strength against the model, the Sun's unit norm, a Sun that is
reported in the Earth's shadow, the angle between field and Sun against the model, and a reading that stands
still. The sixth is the filter's: it refuses one sensor tick after tick while it takes the other, or while
there is no other. Each bad tick raises the suspicion against a sensor and each good one lowers it, so that
noise and the filter's transients isolate nothing.
What the filter refuses counts in full where field and Sun contradict each other, and less where the filter
itself may be wrong. Its other states show that: a filter that began with a faulty sensor can explain it for
minutes, by a bias or a disturbance beyond what is possible. That proves nothing.

An isolated sensor does not update the filter until it has been consistent for a time.
"""

from math import acos
from typing import NamedTuple

from fsw.core.algebra.vector import Vec3, dot, norm
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.measurement import expected_field, expected_sun
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.samples import coils_idle
from fsw.core.fdir.sensor_pair import Comparison, Pair, judge_pair, proven
from fsw.core.fdir.sensor_watch import (
    DARK,
    FULL,
    SLIGHT,
    STILL,
    SensorFault,
    SensorHealthConfig,
    Watch,
    as_predicted,
    judge_sample,
    probe,
)
from fsw.core.gate.readings import Readings
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import Reference
from fsw.core.orbit.sun import lit
from fsw.wire.messages import MagField, SunVector

SHADOW_M = RADIUS_M - 100e3
"""Radius of what is shadow for certain: the Earth is flattened by 21 km, half the penumbra of a low orbit is
15 km wide, and the position may be off by tens of km."""


class SensorHealth(NamedTuple):
    """Both sensors, by themselves and as a pair.

    ``doubted``: the filter is to restart in this tick. Both sensors have agreed for long, but not with the
    estimate; or they contradict each other before it has proved itself.
    """

    field: Watch = Watch()
    sun: Watch = Watch()
    pair: Pair = Pair()
    doubted: bool = False

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*self.field.integers(), *self.sun.integers(), *self.pair, self.doubted)

    def floats(self) -> tuple[float, ...]:
        """For the checksum of the state."""
        return (*self.field.sample, *self.sun.sample)


def trusted(readings: Readings, health: SensorHealth, reference: Reference) -> Readings:
    """The readings without those of an isolated sensor, and without a Sun where none can be.

    Without the Sun too while the pair has to agree: no estimate begins then.
    """
    if health.field.fault:
        readings = readings._replace(field=None)
    sun = readings.sun
    if sun is not None and (
        health.sun.fault or health.pair.proof < 0 or (sun.valid and _in_shadow(reference))
    ):
        readings = readings._replace(sun=None)
    return readings


def in_doubt(health: SensorHealth, config: SensorHealthConfig) -> bool:
    """Whether a sensor may be the cause of what the filter did not expect.

    One is isolated, or stands still, or the estimate has not yet proved that it is right about both.
    """
    still = STILL * max(health.field.same, health.sun.same) >= config.frozen_ticks
    return still or bool(health.field.fault or health.sun.fault) or not proven(health.pair, config.pair)


def judge(
    health: SensorHealth,
    readings: Readings,
    field: Vec3 | None,
    sun: Vec3 | None,
    reference: Reference,
    used: Used,
    estimate: Estimate | None,
    sigma3_rad: float,
    config: SensorHealthConfig,
) -> SensorHealth:
    """Judge the samples of this tick.

    Args:
        health: of the tick before.
        readings: all that the boards sent, of isolated sensors too.
        field: the sample while no coil drives, T, body axes.
        sun: the sample, body axes.
        reference: field and Sun as modelled.
        used: what the filter took.
        estimate: of this tick.
        sigma3_rad: three standard deviations of its attitude.
        config: limits.
    """
    sun_claimed = sun
    if sun is not None and _in_shadow(reference):
        sun = None
    b_cause, s_cause, apart = _plain_checks(field, sun, reference, config)
    if sun_claimed is not sun:
        s_cause = SensorFault.UNLIT
    if readings.field is not None and not readings.field.valid and coils_idle(readings):
        b_cause = SensorFault.SATURATED
    b_before, s_before = health.field, health.sun
    b_refused = field is not None and not (used.field or b_cause or b_before.fault) and estimate is not None
    s_refused = sun is not None and not (used.sun or s_cause or s_before.fault) and estimate is not None
    refused, both = b_refused or s_refused, field is not None and sun is not None
    pair, sure = health.pair, proven(health.pair, config.pair)
    if not sure or estimate is None or pair.apart:
        flawed = bool(b_cause or s_cause)
        credible = _credible(estimate, config)
        wrong = apart or (refused and not credible)
        comparison = Comparison(
            both=both,
            agree=not (apart or flawed),
            unexplained=wrong and not (flawed or b_before.fault or s_before.fault),
            estimated=estimate is not None,
            took_both=used.field and used.sun and credible,
            refused=refused,
        )
        pair = judge_pair(pair, comparison, config.pair)
    b_weight = s_weight = FULL
    if sure and refused:
        doubt = FULL if apart else SLIGHT
        if b_refused and (used.sun or sun is None):
            b_cause, b_weight = SensorFault.REFUSED, doubt
        elif s_refused and used.field and not b_cause:
            s_cause, s_weight = SensorFault.REFUSED, doubt
        elif b_refused and s_refused:  # this tick does not show which is faulty: both stay as they were
            (b_cause, b_weight), (s_cause, s_weight) = (b_before.cause, 0), (s_before.cause, 0)
    b_watch = judge_sample(b_before, _field_sample(readings.field), s_before, b_cause, b_weight, config)
    s_watch = judge_sample(s_before, _sun_sample(readings.sun), b_before, s_cause, s_weight, config)
    doubted = estimate is not None and pair.contradictory and not health.pair.contradictory
    if b_watch.fault or s_watch.fault:
        agree = both and not (apart or b_cause or s_cause)
        if b_watch.fault and field is not None:
            predicted = None if estimate is None else expected_field(*estimate[:3], reference.b_eci_t)
            fits = not b_cause and as_predicted(field, agree, predicted, config.field_noise_t, sigma3_rad)
            b_watch, b_doubted = probe(b_watch, fits, agree, config)
            doubted = doubted or b_doubted
        if s_watch.fault and sun_claimed is not None:
            predicted = None if estimate is None else expected_sun(*estimate[:3], reference.sun_eci)
            fits = not s_cause and as_predicted(
                sun_claimed, agree, predicted, config.sun_noise_rad, sigma3_rad
            )
            s_watch, s_doubted = probe(s_watch, fits, agree, config)
            doubted = doubted or s_doubted
    return SensorHealth(b_watch, s_watch, pair, doubted)


def _in_shadow(reference: Reference) -> bool:
    """Whether the satellite is in shadow with certainty, beyond all errors of the model."""
    return not (reference.lit or lit(reference.r_eci_m, reference.sun_eci, SHADOW_M))


def _plain_checks(
    field: Vec3 | None, sun: Vec3 | None, reference: Reference, config: SensorHealthConfig
) -> tuple[int, int, bool]:
    """What speaks against field and Sun by themselves, and whether their angle is not the modelled one."""
    b_cause = s_cause = 0
    if field is not None:
        strength, modelled = norm(field), norm(reference.b_eci_t)
        if not abs(strength - modelled) <= config.max_field_error_t:
            b_cause = SensorFault.STRENGTH
    if sun is None:
        return b_cause, s_cause, False
    size = norm(sun)
    if not abs(size - 1.0) <= config.max_norm_error:
        s_cause = SensorFault.STRENGTH
    if field is None or strength * size == 0.0:
        return b_cause, s_cause, False
    measured = dot(field, sun) / (strength * size)
    expected = dot(reference.b_eci_t, reference.sun_eci) / modelled
    return b_cause, s_cause, abs(_angle(measured) - _angle(expected)) > config.max_angle_error_rad


def _credible(estimate: Estimate | None, config: SensorHealthConfig) -> bool:
    """Whether the estimate, if there is one, needs no bias or disturbance beyond what is possible."""
    if estimate is None:
        return True
    return (
        norm(estimate.parameters.mag_bias_t) <= config.max_bias_t
        and norm(estimate.parameters.torque_body_nm) <= config.max_torque_nm
    )


def _field_sample(message: MagField | None) -> Vec3 | None:
    return None if message is None else (message.b_x, message.b_y, message.b_z)


def _sun_sample(message: SunVector | None) -> Vec3 | None:
    if message is None:
        return None
    return (message.s_x, message.s_y, message.s_z) if message.valid else DARK


def _angle(cosine: float) -> float:
    return acos(max(-1.0, min(1.0, cosine)))
