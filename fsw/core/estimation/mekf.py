"""Multiplicative extended Kalman filter for attitude, rate, and what the table knows only within bounds.

The attitude lives outside the filter as a unit quaternion. The filter carries the error state
(dtheta, domega, then those of the ``Parameters`` that are uncertain); after each update the
error is folded into the estimate, q <- q (x) (1, dtheta / 2), and reset to zero. With e1 the radius
direction, b the field, h the momentum of a wheel, d the residual dipole and m = (1 + G) m_driven + d, all in
body axes:

    d(dtheta)/dt = -omega x dtheta + domega
    J d(domega)/dt = ([(J omega + h) x] - [omega x] J) domega
                   + (3 mu/r^3 ([e1 x] J - [J e1 x]) [e1 x] + [m x][b x]) dtheta + dtorque
                   + dd x b + (dG m_driven) x b
                   + 3 mu/r^3 e1 x dJ e1 - omega x dJ omega - dJ domega/dt

The parameters are constants or slow random walks. What no sample can show keeps its prior (``unobservable``).

Source: Lefferts, Markley, Shuster 1982; dynamics: Ovchinnikov, Roldugin, Ivanov, Penkov 2015; priors:
Schmidt 1966.
"""

from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import Final, final

from fsw.core.algebra.quaternion import Quaternion, from_small_rotation, multiply, normalise
from fsw.core.algebra.vector import ZERO, Vec3, add, dot, is_zero, sub
from fsw.core.estimation.dynamics.error_dynamics import (
    FAST_SQUARE,
    Driven,
    free_acceleration,
    kicks,
    transition_matrix,
    with_age_along,
)
from fsw.core.estimation.dynamics.motion import Acting, advanced, middle, turn
from fsw.core.estimation.kalman import (
    Matrix,
    Trace,
    carry_trace,
    largest_variance,
    total_variance,
    unexplained,
)
from fsw.core.estimation.kalman import predict as predict_covariance
from fsw.core.estimation.kalman import update as update_error
from fsw.core.estimation.measurement import both_prediction, field_prediction, sun_prediction
from fsw.core.estimation.mekf_config import FilterStep, MekfConfig, WheelMotion, open_noise, pieces_of_tick
from fsw.core.estimation.parameters import (
    ATTITUDE_AND_RATE,
    Parameters,
    correct_parameters,
    estimated_dipole,
    estimated_rotor,
    with_momentum,
)
from fsw.core.estimation.unobservable import turned_along

LAG_S: Final = 60.0
"""Time over which innovations are averaged."""
Lag = tuple[float, float, float, float, float, float]
NO_LAG: Lag = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
DOUBT_OF_LIGHT: Final = 0.3
"""Part of the variance of the Sun's deflection that counts as noise too."""
MAX_VARIANCE: Final = 1e6
"""Beyond it (1000 rad) an estimate is worthless, and the algebra nears overflow."""


@final
@dataclass(slots=True)
class Estimate:
    """Attitude, inertial rate, parameters, and the covariance of the error state.

    The covariance is (n, n), n being 6 and the parameters that are carried, laid out as in ``Layout``; units
    rad, rad/s and those of ``Parameters``. ``nis``: the normalised innovation squared of this tick, less what
    the traced deviations explain; ``numbers``: how many were measured. ``lag``: the mean innovations of field
    and Sun over ``LAG_S``, each component in its standard deviations.
    """

    q_body_from_eci: Quaternion
    omega_body_radps: Vec3
    parameters: Parameters
    covariance: Matrix
    trace: Trace | None = None
    nis: float = 0.0
    numbers: int = 0
    lag: Lag = NO_LAG

    def copy(self) -> "Estimate":
        """An estimate that goes on by itself from here; the arrays are shared, since none is changed."""
        return Estimate(
            self.q_body_from_eci,
            self.omega_body_radps,
            self.parameters.copy(),
            self.covariance,
            None if self.trace is None else self.trace.copy(),
            self.nis,
            self.numbers,
            self.lag,
        )


def start(q_body_from_eci: Quaternion, omega_body_radps: Vec3, config: MekfConfig) -> Estimate:
    """The estimate at start-up: a known attitude, everything else at its prior."""
    parameters = config.initial_parameters.copy()
    return Estimate(q_body_from_eci, omega_body_radps, parameters, config.initial_covariance)


def correct(
    estimate: Estimate, error: Matrix, uncertainty: Matrix, config: MekfConfig, wheel_nms: Vec3 = ZERO
) -> None:
    """Correct the estimate by something other than a measurement.

    Args:
        estimate: to be corrected.
        error: what is to be added, (n), laid out as the error state.
        uncertainty: covariance that this adds, (n, n).
        config: the filter.
        wheel_nms: momentum of a driven wheel, body axes.
    """
    _fold(estimate, tuple(error.tolist()), estimate.covariance + uncertainty, config, wheel_nms)


def healthy(estimate: Estimate) -> bool:
    """Whether every number is finite and every variance positive and below ``MAX_VARIANCE``.

    Only a component of a parameter may be exact, with zero variance. To be checked after a prediction, which
    moves a bad number onto the diagonal of the covariance.
    """
    q0, q1, q2, q3 = estimate.q_body_from_eci
    w1, w2, w3 = estimate.omega_body_radps
    b1, b2, b3, s1, s2, s3 = estimate.lag
    numbers = q0 + q1 + q2 + q3 + w1 + w2 + w3 + b1 + b2 + b3 + s1 + s2 + s3 + estimate.nis
    total = total_variance(estimate.covariance, ATTITUDE_AND_RATE)
    return total < MAX_VARIANCE and isfinite(numbers + estimate.parameters.total())


def predict(
    estimate: Estimate,
    e1_eci: Vec3,
    b_eci_t: Vec3,
    gravity_per_s2: float,
    m_body_am2: Vec3,
    config: MekfConfig,
    doubted_am2: Vec3 = ZERO,
    wheel: WheelMotion | None = None,
) -> None:
    """Carry estimate and covariance over one tick.

    Args:
        estimate: at the tick before.
        e1_eci: radius direction, inertial axes, unit.
        b_eci_t: field, inertial axes, T.
        gravity_per_s2: 3 mu / r^3, 1/s^2.
        m_body_am2: dipole driven over the tick, body axes, A m^2.
        config: the filter.
        doubted_am2: standard deviation of that dipole's error, as in ``Driven``.
        wheel: how a driven wheel moves, if there is one.
    """
    count = pieces_of_tick(estimate.omega_body_radps, config.tick_s)
    step, driven = FilterStep(config, count, wheel), Driven(m_body_am2, doubted_am2)
    for _ in range(count):
        predict_step(estimate, e1_eci, b_eci_t, gravity_per_s2, driven, config, step)


def predict_step(
    estimate: Estimate,
    e1_eci: Vec3,
    b_eci_t: Vec3,
    gravity_per_s2: float,
    driven: Driven,
    config: MekfConfig,
    step: FilterStep,
) -> None:
    """Carry estimate and covariance over a tick, or a piece of one."""
    h, parts = step.tick_s, config.layout
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    m, rotor = driven.m_body_am2, step.rotor
    if parts.dipole is not None or parts.coils is not None:
        m = estimated_dipole(m, parameters)
    if parts.inertia is not None:
        rotor = estimated_rotor(rotor, parameters)
    torque = parameters.torque_body_nm
    if not is_zero(step.reaction_body_nm):
        torque = add(torque, step.reaction_body_nm)
    acting = Acting(e1_eci, b_eci_t, gravity_per_s2, m, torque, rotor)
    around_mid, motion = middle(q, omega, acting, h)
    rotation, omega_after = advanced(q, omega, motion, acting, h)
    transition = transition_matrix(motion, around_mid, driven.m_body_am2, rotor, config, step)
    kicked = kicks(driven, around_mid.b_t, config, step)
    estimate.q_body_from_eci = normalise(multiply(q, turn(rotation)))
    estimate.omega_body_radps = omega_after
    estimate.covariance = predict_covariance(
        estimate.covariance, transition, step.process_noise, kicked, config.algebra
    )
    if estimate.trace is not None:
        carry_trace(estimate.trace, transition)
    estimate.nis, estimate.numbers = 0.0, 0
    left = 1.0 - h / LAG_S
    b1, b2, b3, s1, s2, s3 = estimate.lag
    estimate.lag = (left * b1, left * b2, left * b3, left * s1, left * s2, left * s3)


def update_field(
    estimate: Estimate,
    b_body_t: Vec3,
    b_eci_t: Vec3,
    config: MekfConfig,
    open_body: Vec3 | None = None,
    frozen: bool = False,
    wheel_nms: Vec3 = ZERO,
) -> bool:
    """Take a magnetometer sample; False when the gate rejects it.

    Args:
        estimate: predicted to this tick; unchanged where the sample is rejected.
        b_body_t: sample.
        b_eci_t: field as modelled.
        config: the filter.
        open_body: the direction along which the sample shows nothing, if there is one.
        frozen: whether the parameters keep their values.
        wheel_nms: momentum of a driven wheel, body axes.
    """
    predicted, sensitivity = field_prediction(
        estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters, b_eci_t, config
    )
    noise = config.field_noise
    if open_body is not None:
        noise = noise + open_noise(open_body)
    innovation = sub(b_body_t, predicted)
    return take(estimate, innovation, sensitivity, noise, config, config.gate_nis, 0, frozen, wheel_nms)


def update_sun(
    estimate: Estimate,
    s_body: Vec3,
    s_eci: Vec3,
    config: MekfConfig,
    frozen: bool = False,
    wheel_nms: Vec3 = ZERO,
    slope_eci: Vec3 = ZERO,
) -> bool:
    """Take a Sun direction; False when the gate rejects it.

    ``slope_eci``: as for ``sun_prediction``.
    """
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    predicted, sensitivity = sun_prediction(q, omega, parameters, s_eci, config, slope_eci)
    innovation, noise = sub(s_body, predicted), config.sun_noise
    doubt = _doubt_of_light(estimate, slope_eci, config)
    if doubt > 0.0:
        noise = _with_doubt(noise, 0, doubt)
    return take(estimate, innovation, sensitivity, noise, config, config.gate_nis, 3, frozen, wheel_nms)


def update_both(
    estimate: Estimate,
    b_body_t: Vec3,
    b_eci_t: Vec3,
    s_body: Vec3,
    s_eci: Vec3,
    config: MekfConfig,
    open_body: Vec3 | None = None,
    frozen: bool = False,
    wheel_nms: Vec3 = ZERO,
    slope_eci: Vec3 = ZERO,
) -> bool:
    """Take field and Sun in one update; False when it is uncertain that each would pass the gate by itself.

    The NIS of a part never exceeds that of the whole, so the gate for one, applied to both, is stricter.
    """
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    b_predicted, s_predicted, sensitivity = both_prediction(
        q, omega, parameters, b_eci_t, s_eci, config, slope_eci
    )
    b1, b2, b3 = sub(b_body_t, b_predicted)
    s1, s2, s3 = sub(s_body, s_predicted)
    innovation = (b1, b2, b3, s1, s2, s3)
    noise = config.both_noise
    if open_body is not None:
        noise = noise.copy()
        noise[0:3, 0:3] += open_noise(open_body)
    doubt = _doubt_of_light(estimate, slope_eci, config)
    if doubt > 0.0:
        noise = _with_doubt(noise, 3, doubt)
    return take(estimate, innovation, sensitivity, noise, config, config.gate_nis, 0, frozen, wheel_nms)


def _doubt_of_light(estimate: Estimate, slope_eci: Vec3, config: MekfConfig) -> float:
    """Variance by which the Sun's direction counts as noisier while the Earth's light is uncertain, rad^2.

    To first order its error is in the error state; what that leaves out does not average out as noise does.
    """
    place = config.layout.earth_light
    if place is None or is_zero(slope_eci):
        return 0.0
    variance = dot(slope_eci, slope_eci) * largest_variance(estimate.covariance, place.start, place.stop)
    return DOUBT_OF_LIGHT * variance


def _with_doubt(noise: Matrix, first: int, variance: float) -> Matrix:
    """The noise with this variance added to the Sun's components, from number ``first`` on."""
    more = noise.copy()
    for place in range(first, first + 3):
        more[place, place] += variance
    return more


def take(
    estimate: Estimate,
    innovation: tuple[float, ...],
    sensitivity: Matrix,
    noise: Matrix,
    config: MekfConfig,
    gate_nis: float,
    first: int = 0,
    frozen: bool = False,
    wheel_nms: Vec3 = ZERO,
) -> bool:
    """Update the estimate, gated by its NIS; beyond the gate False, and nothing is changed.

    ``first``: place of the innovation in the ``lag``; that of a single number is left out of it. ``frozen``:
    the parameters keep their values, and their errors count as they are. ``wheel_nms``: momentum of a driven
    wheel, body axes.
    """
    considered = slice(ATTITUDE_AND_RATE, config.layout.size) if frozen else None
    trace, measured = estimate.trace, len(innovation)
    found = update_error(
        estimate.covariance, innovation, noise, sensitivity, considered, config.algebra, trace
    )
    if found is None:
        return False
    nis, effect, sums = found.nis, found.effect, found.sums
    if trace is not None and sums is not None and nis > 2.0 * measured:  # otherwise nothing to explain
        nis = unexplained(sums) - unexplained(trace.sums)
    if not 0.0 <= nis <= gate_nis:  # overflow can make it -inf
        return False
    if trace is not None and effect is not None and sums is not None:
        trace.effect, trace.sums = effect, sums
        trace.measured += measured
    estimate.nis += nis
    estimate.numbers += measured
    if measured > 1:
        estimate.lag = _lagging(estimate.lag, innovation, found.variances, first, config.tick_s / LAG_S)
    _fold(estimate, found.error, found.covariance, config, wheel_nms)
    return True


def _lagging(
    lag: Lag, innovation: tuple[float, ...], variances: tuple[float, ...], first: int, part: float
) -> Lag:
    """The means with this fraction of the new innovations added, from place ``first`` on (0 or 3)."""
    b1, b2, b3, s1, s2, s3 = lag
    y, v = innovation, variances
    if first == 0:
        b1 += _weighed(part * y[0], v[0])
        b2 += _weighed(part * y[1], v[1])
        b3 += _weighed(part * y[2], v[2])
    if first == 3 or len(y) == 6:
        s1 += _weighed(part * y[3 - first], v[3 - first])
        s2 += _weighed(part * y[4 - first], v[4 - first])
        s3 += _weighed(part * y[5 - first], v[5 - first])
    return (b1, b2, b3, s1, s2, s3)


def _weighed(innovation: float, variance: float) -> float:
    """An innovation in its standard deviations."""
    return innovation / sqrt(variance) if variance > 0.0 else inf


def _fold(
    estimate: Estimate, error: tuple[float, ...], covariance: Matrix, config: MekfConfig, wheel_nms: Vec3
) -> None:
    """Fold an error state into attitude, rate and parameters; the covariance of their errors follows them."""
    parts, parameters, before = config.layout, estimate.parameters, estimate.omega_body_radps
    omega = add(before, (error[3], error[4], error[5]))
    turning = parts.delay is not None and dot(omega, omega) >= FAST_SQUARE
    rotor, acceleration = config.rotor, ZERO
    if turning:
        rotor = with_momentum(rotor, wheel_nms)
        acceleration = free_acceleration(before, parameters, rotor)
    inertia_error = parameters.inertia_error_kgm2
    turned = from_small_rotation((error[0], error[1], error[2]))
    estimate.q_body_from_eci = normalise(multiply(estimate.q_body_from_eci, turned))
    estimate.omega_body_radps = omega
    correct_parameters(parameters, error, parts)
    if turning and parts.delay is not None:
        shift = (sub(omega, before), sub(free_acceleration(omega, parameters, rotor), acceleration))
        covariance = with_age_along(shift, covariance, parts.delay)
    if config.unobservable is not None:
        covariance = turned_along(covariance, error, inertia_error, config.unobservable)
    estimate.covariance = covariance
