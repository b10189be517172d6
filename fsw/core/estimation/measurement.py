"""What each sensor should measure, and how that depends on every part of the error state."""

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale, skew, sub
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Parameters

Prediction = tuple[Vec3, Matrix]
"""What should be measured, and its sensitivity H, (3, n)."""


def field_prediction(
    q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, b_eci_t: Vec3, config: MekfConfig
) -> Prediction:
    """The magnetometer: z = (1 + s) o R(turn) C(t - delay) b + bias, R a small turn; T, body axes."""
    parts, sensitivity = config.layout, config.field_sensitivity.copy()
    b = _late(rotate(q_body_from_eci, b_eci_t), omega, parameters.delay_s[0])
    b = _turned(b, parameters.mag_turn_rad)
    turning = np.array(skew(b))
    sensitivity[:, 0:3] = _since(turning, omega, parameters.delay_s[0])
    if parts.delay is not None:
        sensitivity[:, parts.delay.start] = cross(omega, b)
        sensitivity[:, 3:6] = skew(scale(-parameters.delay_s[0], b))
    if parts.mag_turn is not None:
        sensitivity[:, parts.mag_turn] = turning
    if parts.mag_scale is not None:
        first = parts.mag_scale.start
        sensitivity[0, first], sensitivity[1, first + 1], sensitivity[2, first + 2] = b
    return add(_scaled(b, parameters.mag_scale), parameters.mag_bias_t), sensitivity


def field_sampled(parameters: Parameters, b_eci_t: Vec3, b_rate_eci_tps: Vec3) -> Vec3:
    """The field, eci, T, where the satellite was when the sample was taken, by the age as estimated.

    That the field tells the age by this is left out of the sensitivity: an error of the place along the track
    looks the same.
    """
    age_s = parameters.delay_s[0]
    return sub(b_eci_t, scale(age_s, b_rate_eci_tps)) if age_s else b_eci_t


def sun_prediction(
    q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, s_eci: Vec3, config: MekfConfig
) -> Prediction:
    """The Sun sensor: z = R(turn) C(t - delay) s, R a small turn; body axes."""
    parts, sensitivity = config.layout, config.sun_sensitivity.copy()
    s = _late(rotate(q_body_from_eci, s_eci), omega, parameters.delay_s[1])
    s = _turned(s, parameters.sun_turn_rad)
    turning = np.array(skew(s))
    sensitivity[:, 0:3] = _since(turning, omega, parameters.delay_s[1])
    if parts.delay is not None:
        sensitivity[:, parts.delay.start + 1] = cross(omega, s)
        sensitivity[:, 3:6] = skew(scale(-parameters.delay_s[1], s))
    if parts.sun_turn is not None:
        sensitivity[:, parts.sun_turn] = turning
    return s, sensitivity


def _late(v_body: Vec3, omega: Vec3, delay_s: float) -> Vec3:
    """A direction fixed in space as it stood ``delay_s`` ago, body axes."""
    return _turned(v_body, scale(-delay_s, omega))


def _since(turning: Matrix, omega: Vec3, delay_s: float) -> Matrix:
    """The derivative by the attitude now, of one by the attitude ``delay_s`` ago; to first order.

    Along the rate it is that of the age with the other sign, exactly: no sample tells the two apart.
    """
    return turning if delay_s == 0.0 else turning + turning.dot(skew(scale(delay_s, omega)))


def _turned(v: Vec3, turn_rad: Vec3) -> Vec3:
    """As seen in axes turned by a small angle, to second order: to first it would grow longer."""
    if turn_rad == ZERO:
        return v
    first = cross(v, turn_rad)
    return add(add(v, first), scale(0.5, cross(first, turn_rad)))


def _scaled(v: Vec3, errors: Vec3) -> Vec3:
    (x, y, z), (s1, s2, s3) = v, errors
    return v if errors == ZERO else (x + s1 * x, y + s2 * y, z + s3 * z)
