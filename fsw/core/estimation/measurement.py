"""What each sensor should measure, and how that depends on every part of the error state."""

from fsw.core.algebra.quaternion import Quaternion, rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, is_zero, scale, sub
from fsw.core.estimation.kalman import Matrix, sensitivity
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Parameters
from fsw.core.orbit.ephemeris import Reference
from fsw.core.orbit.sun import apparent_sun

Prediction = tuple[Vec3, Matrix]
"""What should be measured, and its sensitivity H, (3, n)."""


def deflected_sun(parameters: Parameters, reference: Reference, config: MekfConfig) -> tuple[Vec3, Vec3]:
    """What a Sun sensor takes for the Sun by the estimated albedo, and its derivative by that; eci.

    Cells see both lights apart: for them, as where the filter does not carry it, the albedo deflects nothing.
    """
    if config.layout.earth_light is None or config.cells is not None:
        return reference.sun_eci, ZERO
    return apparent_sun(reference.r_eci_m, reference.sun_eci, parameters.earth_light[0])


def field_prediction(
    q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, b_eci_t: Vec3, config: MekfConfig
) -> Prediction:
    """The magnetometer: z = (1 + s) o R(turn) C(t - delay) b + bias, R the misalignment; T, body axes."""
    b, age_s = _field_at_sample(q_body_from_eci, omega, parameters, b_eci_t), parameters.delay_s[0]
    rows = sensitivity(config.field_sensitivity, b, omega, (age_s,), config.field_places)
    return _field_shown(b, parameters), rows


def field_sampled(parameters: Parameters, b_eci_t: Vec3, b_rate_eci_tps: Vec3) -> Vec3:
    """The field, eci, T, where the satellite was when the sample was taken, by the estimated age.

    That this makes the age observable is left out of the sensitivity: an along-track position error looks the
    same.
    """
    age_s = parameters.delay_s[0]
    return sub(b_eci_t, scale(age_s, b_rate_eci_tps)) if age_s else b_eci_t


def sun_prediction(
    q_body_from_eci: Quaternion,
    omega: Vec3,
    parameters: Parameters,
    s_eci: Vec3,
    config: MekfConfig,
    slope_eci: Vec3 = ZERO,
) -> Prediction:
    """The Sun sensor: z = R(turn) C(t - delay) s, R the misalignment; body axes.

    ``slope_eci``: the derivative of s by the Earth's light.
    """
    s, age_s = _sun_at_sample(q_body_from_eci, omega, parameters, s_eci), parameters.delay_s[1]
    rows = sensitivity(config.sun_sensitivity, s, omega, (age_s,), config.sun_places)
    _fill_slope(rows, 0, q_body_from_eci, slope_eci, config)
    return s, rows


def both_prediction(
    q_body_from_eci: Quaternion,
    omega: Vec3,
    parameters: Parameters,
    b_eci_t: Vec3,
    s_eci: Vec3,
    config: MekfConfig,
    slope_eci: Vec3 = ZERO,
) -> tuple[Vec3, Vec3, Matrix]:
    """Magnetometer and Sun sensor, as above; the sensitivity of both is (6, n)."""
    b = _field_at_sample(q_body_from_eci, omega, parameters, b_eci_t)
    s = _sun_at_sample(q_body_from_eci, omega, parameters, s_eci)
    rows = sensitivity(config.both_sensitivity, (b, s), omega, parameters.delay_s, config.both_places)
    _fill_slope(rows, 3, q_body_from_eci, slope_eci, config)
    return _field_shown(b, parameters), s, rows


def _fill_slope(
    rows: Matrix, first: int, q_body_from_eci: Quaternion, slope_eci: Vec3, config: MekfConfig
) -> None:
    """Fill in how the Sun's direction, from row ``first`` on, depends on the Earth's light."""
    place = config.layout.earth_light
    if place is not None and not is_zero(slope_eci):
        rows[first : first + 3, place.start] = rotate(q_body_from_eci, slope_eci)


def _field_at_sample(q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, b_eci_t: Vec3) -> Vec3:
    """The field in the axes of the magnetometer when the sample was taken."""
    b = _late(rotate(q_body_from_eci, b_eci_t), omega, parameters.delay_s[0])
    return _turned(b, parameters.mag_turn_rad)


def _field_shown(b: Vec3, parameters: Parameters) -> Vec3:
    return add(_scaled(b, parameters.mag_scale), parameters.mag_bias_t)


def _sun_at_sample(q_body_from_eci: Quaternion, omega: Vec3, parameters: Parameters, s_eci: Vec3) -> Vec3:
    """The Sun in the axes of its sensor when the sample was taken."""
    s = _late(rotate(q_body_from_eci, s_eci), omega, parameters.delay_s[1])
    return _turned(s, parameters.sun_turn_rad)


def _late(v_body: Vec3, omega: Vec3, delay_s: float) -> Vec3:
    """A direction fixed in space as it stood ``delay_s`` ago, body axes."""
    return _turned(v_body, scale(-delay_s, omega))


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
