"""The error dynamics: the transition is the derivative of the flow, and the noise that of its causes."""

from dataclasses import replace

import numpy as np
import pytest
from filter_steps import predict

from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.dynamics.error_dynamics import free_acceleration, with_age_along
from fsw.core.estimation.dynamics.motion import turn
from fsw.core.estimation.parameters import NAMES, UNCHANGED_COILS, UNCHANGED_INERTIA

TICK_S = 0.01
RATE = (0.21, -0.34, 0.27)
DRIVEN_AM2 = (0.5, -0.7, 0.3)
B_ECI_T = (0.3, -0.2, 0.5)
GRAVITY_PS2 = 0.4
"""Of order one, as are torque and dipole: what they do weighs as much as the rates' terms."""
STRONG = {"torque_body_nm": (0.05, -0.03, 0.04), "dipole_body_am2": (0.4, 0.25, -0.35)}
COUPLED = [("attitude", "attitude"), ("attitude", "rate"), ("rate", "attitude"), ("rate", "rate")]
TURNING = ["torque_body_nm", "dipole_body_am2", "coil_error", "inertia_error_kgm2"]
"""Parameters that act on the rate."""


def strong(satellite, **changes):
    """An estimate whose every term is of order one; the inertia as in the table."""
    given = {"inertia_error_kgm2": UNCHANGED_INERTIA, **STRONG, **changes}
    parameters = replace(
        satellite.parameters, **{name: value for name, value in given.items() if name in satellite.carried}
    )
    return replace(satellite.estimate(parameters=parameters), omega_body_radps=RATE)


def transition(satellite, estimate, driven_am2=DRIVEN_AM2):
    """One error direction e as covariance e e^T comes out of a noiseless prediction as (F e)(F e)^T."""
    config, columns = satellite.config(tick_s=TICK_S, noiseless=True), []
    for index in range(satellite.size()):
        direction = np.zeros(satellite.size())
        direction[index] = 1.0
        before = replace(estimate, covariance=np.outer(direction, direction))
        after = predict(before, satellite.e1_eci, B_ECI_T, GRAVITY_PS2, driven_am2, config).covariance
        columns.append(after[:, index] / np.sqrt(after[index, index]))
    return np.array(columns).T


def by_differences(satellite, estimate, flow, driven_am2=DRIVEN_AM2, step=1e-4):
    """d(error after the tick) / d(error before it), by central differences of the nonlinear motion."""

    def after(error):
        begun = satellite.moved(estimate, error)
        return flow(begun, satellite, driven_am2, B_ECI_T, GRAVITY_PS2, TICK_S)

    nominal, columns = after(np.zeros(satellite.size())), []
    for index in range(satellite.size()):
        error = np.zeros(satellite.size())
        error[index] = step
        up, down = (satellite.error(nominal, after(sign * error)) for sign in (1.0, -1.0))
        columns.append((up - down) / (2.0 * step))
    return np.array(columns).T


class TestTransition:
    @pytest.mark.long
    def test_is_the_derivative_of_the_flow(self, satellite, nonlinear_flow):
        estimate = strong(satellite)
        expected = by_differences(satellite, estimate, nonlinear_flow)
        np.testing.assert_allclose(transition(satellite, estimate), expected, rtol=0.0, atol=1e-7)

    @pytest.mark.long
    def test_is_it_while_no_coil_is_driven(self, full, nonlinear_flow):
        """The residual dipole turns the satellite all the same, and more as the field turns in its axes."""
        estimate = strong(full)
        expected = by_differences(full, estimate, nonlinear_flow, ZERO)
        np.testing.assert_allclose(transition(full, estimate, ZERO), expected, rtol=0.0, atol=1e-7)
        undriven = transition(full, strong(full, dipole_body_am2=ZERO), ZERO)
        assert np.abs(transition(full, estimate, ZERO) - undriven)[3:6, 0:3].max() > 1e-3

    @pytest.mark.long
    @pytest.mark.parametrize("wheel_body_nms", [ZERO, (0.3, -0.2, 0.4)], ids=["no wheel", "wheel"])
    def test_is_it_with_another_inertia_than_the_table_s(self, wheel_body_nms, full, nonlinear_flow):
        satellite = replace(full, wheel_body_nms=wheel_body_nms)
        inertia_error = full.parameters.inertia_error_kgm2
        estimate = strong(satellite, inertia_error_kgm2=inertia_error)
        found = transition(satellite, estimate)
        expected = by_differences(satellite, estimate, nonlinear_flow)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7)
        as_in_table = transition(satellite, strong(satellite))
        for name in ("torque_body_nm", "dipole_body_am2", "coil_error"):
            columns = satellite.place(name)
            assert np.abs(found - as_in_table)[3:6, columns].max() > 5e-5

    def test_is_it_with_a_wheel(self, carrying, nonlinear_flow):
        satellite = replace(carrying("torque_body_nm"), wheel_body_nms=(0.3, -0.2, 0.4))
        estimate = strong(satellite)
        expected = by_differences(satellite, estimate, nonlinear_flow)
        np.testing.assert_allclose(transition(satellite, estimate), expected, rtol=0.0, atol=1e-7)

    @pytest.mark.parametrize("name", TURNING)
    def test_what_turns_the_satellite_acts_on_rate_and_attitude(self, name, full):
        """Terms of first order are 5e-4 and more: far above the tolerance that they are held to."""
        f = transition(full, strong(full)) - np.eye(full.size())
        for column in range(full.size())[full.place(name)]:
            assert np.abs(f[3:6, column]).max() > 5e-4
            assert 0.0 < np.abs(f[0:3, column]).max() < 5e-4

    def test_attitude_and_rate_act_on_each_other(self, full):
        f = transition(full, strong(full)) - np.eye(full.size())
        for rows in (0, 3):
            for columns in (0, 3):
                assert np.abs(f[rows : rows + 3, columns : columns + 3]).max() > 5e-4

    def test_nothing_acts_on_a_parameter_and_what_only_the_sensors_have_acts_on_nothing(self, full):
        f = transition(full, strong(full)) - np.eye(full.size())
        assert not f[6:, :].any()
        for name in set(NAMES) - set(TURNING):
            assert not f[:, full.place(name)].any()

    def test_coil_errors_act_while_a_coil_is_driven_alone(self, full):
        f = transition(full, strong(full), ZERO)
        assert not f[0:6, full.place("coil_error")].any()
        assert f[3:6, full.place("dipole_body_am2")].any()

    def test_each_coil_s_errors_act_by_its_own_dipole(self, full):
        """G_ij is what coil j adds along axis i."""
        coils = full.place("coil_error")
        for driven in range(3):
            only = tuple(0.7 if axis == driven else 0.0 for axis in range(3))
            by_entry = np.abs(transition(full, strong(full), only)[3:6, coils]).max(axis=0).reshape(3, 3)
            assert (by_entry[:, driven] > 5e-4).all()
            assert not np.delete(by_entry, driven, axis=1).any()


class TestProcessNoise:
    def still(self, satellite):
        parameters = replace(
            satellite.parameters, torque_body_nm=ZERO, dipole_body_am2=ZERO, coil_error=UNCHANGED_COILS
        )
        size = satellite.size()
        still = satellite.estimate(np.zeros((size, size)), parameters)
        return replace(still, q_body_from_eci=(1.0, 0.0, 0.0, 0.0), omega_body_radps=ZERO)

    def test_is_white_torque_through_the_inertia_and_random_walks(self, satellite):
        """Q = N [[h^3/3, h^2/2], [h^2/2, h]] with N = sigma^2 J^-1 J^-T; of a parameter walk^2 h."""
        h, config = 0.5, satellite.config(tick_s=0.5)
        noise = predict(self.still(satellite), satellite.e1_eci, ZERO, 0.0, ZERO, config).covariance
        inverse = np.linalg.inv(satellite.inertia_kgm2)
        rate = 1e-7**2 * inverse @ inverse.T
        expected = np.zeros((satellite.size(), satellite.size()))
        expected[0:3, 0:3] = rate * h**3 / 3.0
        expected[0:3, 3:6] = expected[3:6, 0:3] = rate * h**2 / 2.0
        expected[3:6, 3:6] = rate * h
        walks = {
            "mag_bias_t": (1e-10, 2e-10, 3e-10),
            "torque_body_nm": (3e-10, 4e-10, 5e-10),
            "dipole_body_am2": (1e-6, 2e-6, 3e-6),
            "coil_error": [1e-5 * n for n in range(1, 10)],
        }
        for name in set(satellite.carried) & set(walks):
            place = satellite.place(name)
            expected[place, place] = np.diag(np.square(walks[name]) * h)
        np.testing.assert_allclose(noise, expected, rtol=1e-12, atol=0.0)

    def test_a_driven_dipole_adds_its_own_along_the_kick_it_gives(self, satellite):
        """Q_rate += (J^-1 (m x b) sigma h)(...)^T, at the attitude of the middle of the tick."""
        sigma, h = 0.05, 0.5
        exact, unsure = (satellite.config(tick_s=h, dipole_sigma=given) for given in (0.0, sigma))
        driven_am2, b_eci_t = satellite.driven_am2, satellite.b_eci_t
        with_it, without = (
            predict(self.still(satellite), satellite.e1_eci, b_eci_t, 0.0, driven_am2, config).covariance
            for config in (unsure, exact)
        )
        kick = sigma * h * np.linalg.solve(satellite.inertia_kgm2, np.cross(driven_am2, b_eci_t))
        expected = np.zeros_like(with_it)
        expected[3:6, 3:6] = np.outer(kick, kick)
        np.testing.assert_allclose(with_it - without, expected, rtol=0.0, atol=1e-6 * kick @ kick)

    def test_a_doubted_dipole_adds_the_kick_it_may_have_given(self, satellite):
        """Whether or not the coil is taken to be driven."""
        h, config = 0.5, satellite.config(tick_s=0.5)
        doubted_am2, b_eci_t = (0.0, 5.0, -1.0), satellite.b_eci_t
        kick = h * np.linalg.solve(satellite.inertia_kgm2, np.cross(doubted_am2, b_eci_t))
        expected = np.zeros((satellite.size(), satellite.size()))
        expected[3:6, 3:6] = np.outer(kick, kick)
        for driven_am2 in (ZERO, satellite.driven_am2):
            flight = (self.still(satellite), satellite.e1_eci, b_eci_t, 0.0, driven_am2, config)
            added = predict(*flight, doubted_am2).covariance - predict(*flight).covariance
            np.testing.assert_allclose(added, expected, rtol=0.0, atol=1e-6 * kick @ kick)

    def test_an_unsure_dipole_that_is_not_driven_adds_nothing(self, satellite):
        unsure, exact = (
            predict(
                satellite.estimate(),
                satellite.e1_eci,
                satellite.b_eci_t,
                satellite.gravity_ps2,
                ZERO,
                satellite.config(dipole_sigma=sigma),
            ).covariance
            for sigma in (0.05, 0.0)
        )
        assert np.array_equal(unsure, exact)


class TestAgeAlongTheMotion:
    CHANGE = (2e-3, -3e-3, 1e-3, 4e-5, 5e-5, -6e-5)

    def test_the_free_motion_is_that_of_a_body_without_torque(self, full, nonlinear_flow):
        """With its own inertia, and a wheel: d(rotation, rate)/dt by differences of the motion."""
        satellite = replace(full, wheel_body_nms=(0.03, -0.02, 0.04))
        kept = {"torque_body_nm": ZERO, "dipole_body_am2": ZERO, "coil_error": UNCHANGED_COILS}
        estimate = satellite.estimate(parameters=replace(full.parameters, **kept))
        ahead, behind = (nonlinear_flow(estimate, satellite, ZERO, ZERO, 0.0, dt) for dt in (1e-3, -1e-3))
        omega = estimate.omega_body_radps
        found = (*omega, *free_acceleration(omega, estimate.parameters, satellite.config().rotor))
        by_differences = (satellite.error(estimate, ahead) - satellite.error(estimate, behind))[:6] / 2e-3
        np.testing.assert_allclose(found, by_differences, rtol=1e-6, atol=1e-10)
        assert np.abs(found[3:]).min() > 1e-5

    def test_an_error_of_the_age_stays_along_the_motion(self, full):
        """Errors of rank one, (motion, common age) dtau, are so about the changed motion too."""
        delay, motion = full.place("delay_s"), np.array([0.02, -0.03, 0.04, 1e-4, 2e-4, -3e-4])
        before, after = np.zeros(full.size()), np.zeros(full.size())
        before[delay] = after[delay] = 0.3
        before[0:6], after[0:6] = 0.3 * motion, 0.3 * (motion + np.array(self.CHANGE))
        found = with_age_along(self.CHANGE, np.outer(before, before), delay)
        np.testing.assert_allclose(found, np.outer(after, after), rtol=0.0, atol=1e-15)

    def test_all_else_stays_and_the_covariance_given_too(self, full):
        """What has nothing to do with the ages, or with their difference only."""
        delay = full.place("delay_s")
        alone = full.covariance()
        alone[delay, :] = alone[:, delay] = 0.0
        alone[delay, delay] = [[0.09, -0.09], [-0.09, 0.09]]
        given = alone.copy()
        np.testing.assert_allclose(with_age_along(self.CHANGE, given, delay), alone, rtol=1e-15, atol=1e-19)
        full_one = full.covariance()
        kept = full_one.copy()
        assert not np.array_equal(with_age_along(self.CHANGE, full_one, delay), kept)
        np.testing.assert_array_equal(full_one, kept)

    def test_it_stays_symmetric_and_positive(self, full):
        found = with_age_along(self.CHANGE, full.covariance(), full.place("delay_s"))
        scaled = found / np.outer(full.scales(), full.scales())
        np.testing.assert_allclose(scaled, scaled.T, rtol=0.0, atol=1e-12)
        assert np.linalg.eigvalsh(scaled).min() > 1e-3


@pytest.mark.parametrize("angle_rad", [0.0, 1e-9, 0.02, 0.5])
def test_a_turn_is_that_of_sine_and_cosine(angle_rad):
    axis = np.array([0.48, -0.64, 0.6])
    expected = (np.cos(0.5 * angle_rad), *(np.sin(0.5 * angle_rad) * axis))
    np.testing.assert_allclose(turn(tuple((angle_rad * axis).tolist())), expected, rtol=0.0, atol=1e-8)
