"""A spin of 60 deg/s sampled once a second: attitude, rate and covariance follow torque-free motion.

The truth is integrated by another method, with the rotation as a matrix instead of a quaternion.
"""

from dataclasses import replace
from math import inf, nan, radians
from types import MappingProxyType

import numpy as np
import pytest
from filter_steps import predict, predict_step, update_field
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import from_dcm, rotate
from fsw.core.algebra.vector import ZERO, scale, unit
from fsw.core.estimation.dynamics.error_dynamics import NOT_DRIVEN
from fsw.core.estimation.mekf import start
from fsw.core.estimation.mekf_config import MOST_PIECES, FilterStep, mekf_config, pieces_of_tick
from fsw.core.estimation.parameters import Prior

J = np.array([[0.93, 0.05, -0.03], [0.05, 1.0, 0.04], [-0.03, 0.04, 0.31]])
INERTIA_SIGMA = 0.003
SPIN = tuple(np.radians((9.0, 57.0, -14.0)).tolist())
"""58 deg/s, and nowhere near a principal axis: the rate wobbles by 20 deg/s."""
RADIUS = (0.6, 0.0, 0.8)
B_T = (2e-5, -1.4e-5, 3e-5)


def config(inertia=J, priors=MappingProxyType({}), torque_nm_rts=0.0, **changes):
    given = {
        "magnetometer_sigma_t": 4e-7,
        "sun_sigma_rad": 0.1,
        "attitude_sigma_rad": 0.05,
        "rate_sigma_radps": 0.002,
        "gate_nis": 1e9,
    } | changes
    rows = tuple(map(tuple, inertia.tolist()))
    return mekf_config(rows, 1.0, priors, torque_noise_nm_rts=torque_nm_rts, **given)


def flown(dcm, omega, seconds, inertia=J, torque_nm=(0.0, 0.0, 0.0)):
    """Rotation matrix and rate after a motion; at several times the matrices alone."""
    inverse = np.linalg.inv(inertia)

    def rates(_, state):
        w = state[9:]
        cross = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        accelerated = inverse @ (torque_nm - cross @ inertia @ w)
        return np.concatenate(((-cross @ state[:9].reshape(3, 3)).ravel(), accelerated))

    begun, times = np.concatenate((np.ravel(dcm), omega)), np.atleast_1d(seconds)
    found = solve_ivp(rates, (0.0, times[-1]), begun, "DOP853", times, rtol=1e-9, atol=1e-10).y
    matrices = found[:9].T.reshape(-1, 3, 3)
    return (matrices[0], found[9:, 0]) if np.isscalar(seconds) else matrices


def _error_rad(q_body_from_eci, dcm):
    """The rotation vector between an estimated attitude and a true one, body axes."""
    estimated = np.array([rotate(q_body_from_eci, tuple(axis)) for axis in np.eye(3).tolist()]).T
    return Rotation.from_matrix(estimated @ dcm.T).as_rotvec()


def off_deg(q_body_from_eci, dcm):
    return np.degrees(np.linalg.norm(_error_rad(q_body_from_eci, dcm)))


def coasted(estimate, filters, seconds):
    for _ in range(seconds):
        estimate = predict(estimate, RADIUS, ZERO, 0.0, ZERO, filters)
    return estimate


@pytest.mark.parametrize(("degps", "within_deg"), [(30.0, 0.003), (60.0, 0.01), (80.0, 0.02)])
def test_a_minute_of_wobbling_spin_is_predicted_as_it_is_flown(degps, within_deg):
    begun, omega = Rotation.from_rotvec((0.4, -1.1, 0.7)).as_matrix(), scale(radians(degps), unit(SPIN))
    estimate = coasted(start(from_dcm(tuple(map(tuple, begun.tolist()))), omega, config()), config(), 60)
    dcm, after = flown(begun, omega, 60.0)
    assert off_deg(estimate.q_body_from_eci, dcm) < within_deg
    np.testing.assert_allclose(np.degrees(estimate.omega_body_radps), np.degrees(after), atol=within_deg)


def test_with_the_inertia_of_another_body_it_is_not():
    """What a minute's wobble depends on, so that the test above can fail."""
    other = J + np.diag((0.02, 0.0, 0.0))
    estimate = coasted(start((1.0, 0.0, 0.0, 0.0), SPIN, config(other)), config(other), 60)
    assert off_deg(estimate.q_body_from_eci, flown(np.eye(3), SPIN, 60.0)[0]) > 10.0


def test_the_covariance_goes_where_neighbouring_motions_go():
    """P = F P0 F^T, F by differences of motions that begin a little off in attitude and rate."""
    seconds, step = 20, 1e-4
    filters = config()
    begun = np.diag(np.square((0.05, 0.002, 0.02, 0.002, 0.0001, 0.001)))
    estimate = replace(start((1.0, 0.0, 0.0, 0.0), SPIN, filters), covariance=begun)
    estimate = coasted(estimate, filters, seconds)
    dcm, omega = flown(np.eye(3), SPIN, seconds)
    columns = []
    for off in np.eye(6) * step:
        near, near_omega = flown(Rotation.from_rotvec(-off[:3]).as_matrix(), SPIN + off[3:], seconds)
        turned = -Rotation.from_matrix(near @ dcm.T).as_rotvec()
        columns.append(np.concatenate((turned, near_omega - omega)) / step)
    transition = np.array(columns).T
    expected = transition @ begun @ transition.T
    scales = np.sqrt(np.outer(expected.diagonal(), expected.diagonal()))
    np.testing.assert_allclose(estimate.covariance / scales, expected / scales, atol=0.003)


def test_without_a_torque_the_pieces_of_a_tick_add_its_noise():
    """A slow body, where the rotation in a tick changes nothing: noise of pieces and of a tick agree."""
    filters = config(torque_nm_rts=1e-3, attitude_sigma_rad=1e-9, rate_sigma_radps=1e-9)
    begun = start((1.0, 0.0, 0.0, 0.0), ZERO, filters)
    whole = predict(begun, RADIUS, ZERO, 0.0, ZERO, filters).covariance
    piece, pieces = FilterStep(filters, 5), begun
    for _ in range(5):
        pieces = predict_step(pieces, RADIUS, ZERO, 0.0, NOT_DRIVEN, filters, piece)
    np.testing.assert_allclose(pieces.covariance, whole, rtol=1e-6, atol=1e-15)


def test_a_slow_body_is_predicted_at_once_and_a_rate_that_is_no_number_too():
    rates = {0.0: 1, 0.29: 1, 0.31: 4, 1.0: 10, 3.1: 31, 1e9: MOST_PIECES, inf: MOST_PIECES, nan: 1}
    assert {rate: pieces_of_tick((0.0, rate, 0.0), 1.0) for rate in rates} == rates
    assert pieces_of_tick((0.0, 3.1, 0.0), 0.05) == 1


@pytest.mark.long
@pytest.mark.parametrize(("estimated", "known"), [(True, J), (False, J), (False, np.eye(3))])
def test_the_magnetometer_alone_holds_satellites_that_differ_from_the_table(estimated, known):
    """Every inertia and product off, a torque, noise; the field turns as along an orbit."""
    inside = np.mean([_held(estimated, known, seed) for seed in range(2, 6)])
    assert inside > 0.97 if estimated else inside < 0.9


def _held(estimated, known, seed, seconds=90):
    """The part of the last half minute in which the attitude is within 3 sigma, by axis."""
    random = np.random.default_rng(seed)
    error = INERTIA_SIGMA * random.standard_normal((3, 3))
    true = J + np.tril(error) + np.tril(error, -1).T
    priors = {"inertia_error_kgm2": Prior((INERTIA_SIGMA,) * 6, (0.0,) * 6)} if estimated else {}
    filters = config(known, priors, torque_nm_rts=1e-4)
    begun = Rotation.random(rng=random).as_matrix()
    omega = radians(60.0) * np.linalg.eigh(true)[1][:, 2] + radians(1.5) * random.standard_normal(3)
    near = Rotation.from_rotvec(0.05 * random.standard_normal(3)).as_matrix() @ begun
    guess = tuple((omega + 0.002 * random.standard_normal(3)).tolist())
    estimate = start(from_dcm(tuple(map(tuple, near.tolist()))), guess, filters)
    motion = flown(begun, omega, np.arange(1.0, seconds + 1), true, 3e-5 * random.standard_normal(3))
    inside = []
    for second, dcm in enumerate(motion, start=1):
        b = tuple((Rotation.from_rotvec((0.0, 0.002 * second, 0.0)).as_matrix() @ B_T).tolist())
        estimate = predict(estimate, RADIUS, b, 0.0, ZERO, filters)
        seen = dcm @ b + 4e-7 * random.standard_normal(3)
        estimate = update_field(estimate, tuple(seen.tolist()), b, filters) or estimate
        sigma = np.sqrt(estimate.covariance.diagonal()[:3])
        inside.append(np.abs(_error_rad(estimate.q_body_from_eci, dcm)) <= 3.0 * sigma)
    return np.mean(inside[-30:])


def test_a_bias_of_the_magnetometer_is_carried_through_the_pieces():
    """States behind attitude and rate keep their place and their covariance."""
    priors = {
        "mag_bias_t": Prior((1e-6,) * 3, (2e-8,) * 3),
        "torque_body_nm": Prior((1e-4,) * 3, (0.0,) * 3),
        "dipole_body_am2": Prior((0.1,) * 3, (0.0,) * 3),
    }
    filters = config(priors=priors, torque_nm_rts=1e-4)
    begun = start((1.0, 0.0, 0.0, 0.0), SPIN, filters)
    strong_t = (0.03, -0.02, 0.05)
    after = predict(begun, RADIUS, strong_t, 0.0, ZERO, filters).covariance
    np.testing.assert_allclose(after[6:9, 6:9], np.eye(3) * (1e-12 + 4e-16), rtol=1e-12)
    np.testing.assert_allclose(after[9:, 9:].diagonal(), [1e-8] * 3 + [1e-2] * 3, rtol=1e-12)
    felt = after[3:6, 9:] / after[9:, 9:].diagonal()
    turned = np.array(predict(begun, RADIUS, strong_t, 0.0, ZERO, filters).omega_body_radps)
    for place in range(6):
        name, push = ("torque_body_nm", "dipole_body_am2")[place // 3], (1e-6 * np.eye(3)[place % 3]).tolist()
        pushed = replace(begun, parameters=replace(begun.parameters, **{name: tuple(push)}))
        moved = np.array(predict(pushed, RADIUS, strong_t, 0.0, ZERO, filters).omega_body_radps)
        slope = (moved - turned) / 1e-6
        np.testing.assert_allclose(felt[:, place], slope, atol=0.03 * np.abs(slope).max())
