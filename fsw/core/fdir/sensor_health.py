"""Which sensor is wrong, and when it may be believed again.

Five checks need no attitude: the field's strength against the model, the Sun's unit norm, a Sun that is seen
in the Earth's shadow, the angle between field and Sun against the model, and a reading that stands still. The
sixth is the filter's: it refuses one sensor tick after tick while it takes the other, or while there is no
other. Each bad tick raises the suspicion against a sensor and each good one lowers it, so that noise and the
filter's transients name nobody.
What the filter refuses counts in full where field and Sun contradict each other, and less where the filter
itself may be what is wrong. That it is, its other states tell: a filter that began with a wrong sensor can
explain it for minutes, by a bias or a disturbance that cannot be. That proves nothing.

A sensor that is named is left out of the filter until it has been consistent for a time.
"""

from math import acos
from typing import NamedTuple

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, add, dot, norm
from fsw.core.estimation.estimator import Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.sensor_pair import Compared, Pair, judge_pair, proven
from fsw.core.fdir.sensor_watch import (
    DARK,
    FULL,
    SLIGHT,
    STILL,
    SensorFault,
    SensorHealthConfig,
    Watch,
    as_foretold,
    probed,
    watched,
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

    ``doubted``: the estimate is to begin anew in this tick. Both sensors agree for long, but not with it; or
    they contradict each other before it has proved itself.
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
    """The readings without those of a sensor that is left out, and without a Sun where none can be.

    Without the Sun too while the pair has to agree: no estimate begins then.
    """
    if health.field.fault:
        readings = readings._replace(field=None)
    sun = readings.sun
    if sun is not None and (health.sun.fault or health.pair.proof < 0 or (sun.valid and _unlit(reference))):
        readings = readings._replace(sun=None)
    return readings


def in_doubt(health: SensorHealth, config: SensorHealthConfig) -> bool:
    """Whether what the filter did not expect may be a sensor's doing.

    One is left out, or stands still, or the estimate has not yet proved that it is right about both.
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
    known: Estimate | None,
    sigma3_rad: float,
    config: SensorHealthConfig,
) -> SensorHealth:
    """Judge the samples of this tick.

    Args:
        health: of the tick before.
        readings: all that the boards said, of sensors left out too.
        field: the sample while no coil drives, T, body axes.
        sun: the sample, body axes.
        reference: field and Sun as modelled.
        used: what the filter took.
        known: the estimate of this tick.
        sigma3_rad: three standard deviations of its attitude.
        config: limits.
    """
    lamp = sun  # what is called the Sun
    if sun is not None and _unlit(reference):
        sun = None
    b_cause, s_cause, apart = _plain_checks(field, sun, reference, config)
    if lamp is not sun:
        s_cause = SensorFault.UNLIT
    if readings.field is not None and not readings.field.valid and _idle(readings):
        b_cause = SensorFault.SATURATED
    b_before, s_before = health.field, health.sun
    b_refused = field is not None and not (used.field or b_cause or b_before.fault) and known is not None
    s_refused = sun is not None and not (used.sun or s_cause or s_before.fault) and known is not None
    refused, seen = b_refused or s_refused, field is not None and sun is not None
    pair, sure = health.pair, proven(health.pair, config.pair)
    if not sure or known is None or pair.apart:
        flawed = bool(b_cause or s_cause)
        credible = _credible(known, config)
        wrong = apart or (refused and not credible)
        compared = Compared(
            seen=seen,
            agree=not (apart or flawed),
            unexplained=wrong and not (flawed or b_before.fault or s_before.fault),
            known=known is not None,
            took_both=used.field and used.sun and credible,
            refused=refused,
        )
        pair = judge_pair(pair, compared, config.pair)
    b_weight = s_weight = FULL
    if sure and refused:
        doubt = FULL if apart else SLIGHT
        if b_refused and (used.sun or sun is None):
            b_cause, b_weight = SensorFault.REFUSED, doubt
        elif s_refused and used.field and not b_cause:
            s_cause, s_weight = SensorFault.REFUSED, doubt
        elif b_refused and s_refused:  # which of them is wrong this tick does not tell: all stays as it was
            (b_cause, b_weight), (s_cause, s_weight) = (b_before.cause, 0), (s_before.cause, 0)
    b_watch = watched(b_before, _of_field(readings.field), s_before, b_cause, b_weight, config)
    s_watch = watched(s_before, _of_sun(readings.sun), b_before, s_cause, s_weight, config)
    doubted = known is not None and pair.contradictory and not health.pair.contradictory
    if b_watch.fault or s_watch.fault:
        agree = seen and not (apart or b_cause or s_cause)
        if b_watch.fault and field is not None:
            foretold = (
                None
                if known is None
                else add(rotate(known.q_body_from_eci, reference.b_eci_t), known.mag_bias_t)
            )
            fits = not b_cause and as_foretold(field, agree, foretold, config.field_noise_t, sigma3_rad)
            b_watch, b_doubted = probed(b_watch, fits, agree, config)
            doubted = doubted or b_doubted
        if s_watch.fault and lamp is not None:
            foretold = None if known is None else rotate(known.q_body_from_eci, reference.sun_eci)
            fits = not s_cause and as_foretold(lamp, agree, foretold, config.sun_noise_rad, sigma3_rad)
            s_watch, s_doubted = probed(s_watch, fits, agree, config)
            doubted = doubted or s_doubted
    return SensorHealth(b_watch, s_watch, pair, doubted)


def _unlit(reference: Reference) -> bool:
    """Whether no Sun can be seen, whatever the model does not know."""
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
    seen = dot(field, sun) / (strength * size)
    expected = dot(reference.b_eci_t, reference.sun_eci) / modelled
    return b_cause, s_cause, abs(_angle(seen) - _angle(expected)) > config.max_angle_error_rad


def _credible(known: Estimate | None, config: SensorHealthConfig) -> bool:
    """Whether the estimate, if there is one, needs no bias or disturbance that cannot be."""
    if known is None:
        return True
    return norm(known.mag_bias_t) <= config.max_bias_t and norm(known.torque_body_nm) <= config.max_torque_nm


def _of_field(said: MagField | None) -> Vec3 | None:
    return None if said is None else (said.b_x, said.b_y, said.b_z)


def _of_sun(said: SunVector | None) -> Vec3 | None:
    if said is None:
        return None
    return (said.s_x, said.s_y, said.s_z) if said.valid else DARK


def _angle(cosine: float) -> float:
    return acos(max(-1.0, min(1.0, cosine)))


def _idle(readings: Readings) -> bool:
    """Whether no coil adds its own field to what the magnetometer senses."""
    coil = readings.coil
    return coil is not None and coil.level == 0 and coil.current_ma == 0
