"""What each sensor should measure, and how that depends on every part of the error state."""

from fsw.core.algebra.quaternion import Quaternion, rotate
from fsw.core.algebra.vector import Vec3, add, cross, dot, is_zero, scale, sub
from fsw.core.estimation.kalman import Matrix, linear
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Matrix3x3, Parameters

Prediction = tuple[Vec3, Matrix]
"""What should be measured, and its sensitivity H, (3, n)."""


def field_prediction(
    q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, b_eci_t: Vec3, config: MekfConfig
) -> Prediction:
    """The magnetometer: z = (1 + s) o R(turn) C(t - delay) b + bias, R the misalignment; T, body axes."""
    delay_s = parameters.delay_s[0]
    b = _turned(_late(rotate(q_body_from_eci, b_eci_t), omega, delay_s), parameters.mag_turn_rad)
    sensitivity = _sensitivity(b, omega, delay_s, config.field_sensitivity, config.field_map)
    return add(_scaled(b, parameters.mag_scale), parameters.mag_bias_t), sensitivity


def field_sampled(parameters: Parameters, b_eci_t: Vec3, b_rate_eci_tps: Vec3) -> Vec3:
    """The field, eci, T, where the satellite was when the sample was taken, by the estimated age.

    That this makes the age observable is left out of the sensitivity: an along-track position error looks the
    same.
    """
    age_s = parameters.delay_s[0]
    return sub(b_eci_t, scale(age_s, b_rate_eci_tps)) if age_s else b_eci_t


def sun_prediction(
    q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, s_eci: Vec3, config: MekfConfig
) -> Prediction:
    """The Sun sensor: z = R(turn) C(t - delay) s, R the misalignment; body axes."""
    delay_s = parameters.delay_s[1]
    s = _turned(_late(rotate(q_body_from_eci, s_eci), omega, delay_s), parameters.sun_turn_rad)
    return s, _sensitivity(s, omega, delay_s, config.sun_sensitivity, config.sun_map)


def _sensitivity(u: Vec3, omega: Vec3, delay_s: float, constant: Matrix, by_direction: Matrix) -> Matrix:
    """H, (3, n), of a sensor that sees the direction u; body axes."""
    numbers = (_since(u, omega, delay_s), u, cross(omega, u), scale(-delay_s, u))
    return linear(constant, numbers, by_direction)


def _late(v_body: Vec3, omega: Vec3, delay_s: float) -> Vec3:
    """A direction fixed in space as it stood ``delay_s`` ago, body axes."""
    return _turned(v_body, scale(-delay_s, omega))


def _since(u: Vec3, omega: Vec3, delay_s: float) -> Matrix3x3:
    """The derivative by the attitude now, from that by the attitude ``delay_s`` ago; to first order, by rows.

    [u x] (1 + [w x]) = [u x] + w u^T - (u . w) 1, w being the rotation since. Along the rate it is exactly
    minus the derivative by the age: no sample can tell the two apart.
    """
    u1, u2, u3 = u
    w1, w2, w3 = w = scale(delay_s, omega)
    along = dot(u, w)
    return (
        w1 * u1 - along,
        w1 * u2 - u3,
        w1 * u3 + u2,
        w2 * u1 + u3,
        w2 * u2 - along,
        w2 * u3 - u1,
        w3 * u1 - u2,
        w3 * u2 + u1,
        w3 * u3 - along,
    )


def _turned(v: Vec3, turn_rad: Vec3) -> Vec3:
    """The vector in axes rotated by a small angle, to second order: to first order it would grow longer."""
    if is_zero(turn_rad):
        return v
    x, y, z = v
    x1, y1, z1 = first = cross(v, turn_rad)
    x2, y2, z2 = cross(first, turn_rad)
    return (x + x1 + 0.5 * x2, y + y1 + 0.5 * y2, z + z1 + 0.5 * z2)


def _scaled(v: Vec3, errors: Vec3) -> Vec3:
    if is_zero(errors):
        return v
    x, y, z = v
    s1, s2, s3 = errors
    return (x + s1 * x, y + s2 * y, z + s3 * z)
