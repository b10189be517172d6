"""Why the predictive law damps: the argument (14) to (17) of Tavares et al. (ConSat), over random states.

(14) The candidate V = 1/2 Omega J Omega + 3/2 w0^2 e1 J e1 - 1/2 w0^2 e3 J e3 - w0 h e3 keeps its value
without control. (15) The chosen dipole leaves no more of it at the predicted rate than none does. (16), (17)
In the limit of a short pulse dV/dt = Omega . (m x b) <= 0, and < 0 unless no dipole can take energy away.

A sign planted in any part of the argument breaks it: the last test of each class.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.actuation.pulses import PulseConfig, PulseState, choose, impulse
from fsw.core.laws.predictive import best_impulse, free_rate_change, missing_impulse

MU_M3PS2 = 3.986004418e14
LEVELS_AM2 = (15.0, 30.0, 60.0)
PULSE_S, SHORT_S = 3.0, 1e-4
FREE = PulseState((0, 0, 0), 0)
PLANTED_RUNS = 60


class State(NamedTuple):
    """Attitude, relative rate, inertia with products, wheel, field and radius."""

    c: np.ndarray
    omega: np.ndarray
    inertia: np.ndarray
    wheel: np.ndarray
    b: np.ndarray
    radius_m: float

    @property
    def w0(self):
        return sqrt(MU_M3PS2 / self.radius_m**3)

    @property
    def inverse(self):
        return np.linalg.inv(self.inertia)


def drawn(numbers):
    """A state from 18 numbers of -1 to 1."""
    one = np.asarray(numbers)
    turn = Rotation.from_rotvec(2.0 * one[0:3]).as_matrix()
    moments = np.array([2.5, 3.0, 3.5]) + 0.4 * one[3:6]
    return State(
        Rotation.from_rotvec(3.0 * one[6:9]).as_matrix(),
        0.02 * one[9:12],
        turn @ np.diag(moments) @ turn.T,
        0.05 * one[12:15],
        4e-5 * one[15:18],
        7.1e6,
    )


STATES = st.lists(st.floats(-1.0, 1.0), min_size=18, max_size=18).map(drawn)


def planted_states():
    rng = np.random.default_rng(4)
    return [drawn(rng.uniform(-1.0, 1.0, 18)) for _ in range(PLANTED_RUNS)]


def vec(array):
    return tuple(np.asarray(array).tolist())


def rows(matrix):
    return tuple(map(tuple, np.asarray(matrix).tolist()))


def free_change(state, *, w0=None, wheel=None, radius_m=None):
    """DOmega/dt of the law; with another rate, wheel or radius to plant an error."""
    return np.array(
        free_rate_change(
            vec(state.omega),
            rows(state.c),
            state.w0 if w0 is None else w0,
            state.radius_m if radius_m is None else radius_m,
            rows(state.inertia),
            rows(state.inverse),
            vec(state.wheel if wheel is None else wheel),
        )
    )


def candidate_rate(state, change):
    """DV/dt for dOmega/dt = change: the orbital axes turn by -Omega, de/dt = e x Omega."""
    J, w0, omega = state.inertia, state.w0, state.omega
    e1, e3 = state.c[:, 0], state.c[:, 2]
    e1_rate, e3_rate = np.cross(e1, omega), np.cross(e3, omega)
    gravity = 3.0 * w0**2 * e1 @ J @ e1_rate
    return omega @ J @ change + gravity - w0**2 * e3 @ J @ e3_rate - w0 * state.wheel @ e3_rate


def scale_of(state):
    """What one term of dV/dt may be."""
    return np.linalg.norm(state.omega) * (state.w0**2 * np.trace(state.inertia) + 1e-9)


def kinetic(state, omega):
    return 0.5 * omega @ state.inertia @ omega


def predicted(state, torque, seconds):
    """The rate after a pulse with this torque, as the law expects it."""
    return state.omega + seconds * (free_change(state) + state.inverse @ torque)


def wanted(state, seconds, sign=1.0):
    """The impulse that the law misses."""
    omega, change = vec(state.omega), vec(free_change(state))
    return sign * np.array(missing_impulse(omega, change, (0.0,) * 3, seconds, rows(state.inertia)))


def closed_form(state, seconds, sign=1.0):
    """The torque of the best dipole without bounds."""
    best = best_impulse(vec(wanted(state, seconds, sign)), vec(state.b), rows(state.inertia))
    return np.array(best) / seconds


def of_19(state, seconds, sign=1.0):
    """The torque of the best of 18 pulses and none."""
    config = PulseConfig(
        3, 100, 3000, True, LEVELS_AM2, seconds, 1.0, 300.0, rows(state.inverse), rows(state.inverse)
    )
    fired = choose(FREE, vec(wanted(state, seconds, sign)), config.energy_metric, 0, vec(state.b), config)
    return np.zeros(3) if fired is None else np.array(impulse(fired, vec(state.b), config)) / seconds


CHOICES = pytest.mark.parametrize("choice", [closed_form, of_19])


class TestWithoutControlTheCandidateKeepsItsValue:
    """Equation (14)."""

    @settings(max_examples=60, deadline=None)
    @given(STATES)
    def test_its_derivative_is_zero(self, state):
        assert abs(candidate_rate(state, free_change(state))) <= 1e-12 * max(scale_of(state), 1e-9)

    @pytest.mark.parametrize(
        "planted",
        [
            lambda state: free_change(state, w0=-state.w0),
            lambda state: free_change(state, wheel=-state.wheel),
            lambda state: free_change(state, radius_m=1.01 * state.radius_m),
            lambda state: -free_change(state),
        ],
        ids=["orbital rate", "wheel", "gravity gradient", "all"],
    )
    def test_with_a_planted_error_it_is_not(self, planted):
        off = [abs(candidate_rate(state, planted(state))) / scale_of(state) for state in planted_states()]
        assert np.median(off) > 1e-3


class TestTheChosenDipoleLeavesNoMoreThanNone:
    """Equation (15)."""

    @CHOICES
    @settings(max_examples=40, deadline=None)
    @given(STATES)
    def test_of_the_energy_of_the_predicted_rate(self, choice, state):
        assume(np.linalg.norm(state.b) > 1e-6)
        none = kinetic(state, predicted(state, np.zeros(3), PULSE_S))
        chosen = kinetic(state, predicted(state, choice(state, PULSE_S), PULSE_S))
        assert chosen <= none * (1.0 + 1e-12)

    @CHOICES
    def test_with_the_sign_of_the_impulse_planted_it_leaves_more(self, choice):
        more = [
            kinetic(state, predicted(state, choice(state, PULSE_S, -1.0), PULSE_S))
            > kinetic(state, predicted(state, np.zeros(3), PULSE_S))
            for state in planted_states()
        ]
        assert np.mean(more) > 0.5


class TestInTheLimitOfAShortPulseTheCandidateFalls:
    """Equations (16) and (17)."""

    @CHOICES
    @settings(max_examples=40, deadline=None)
    @given(STATES)
    def test_its_derivative_is_the_power_of_the_coils_and_not_positive(self, choice, state):
        assume(np.linalg.norm(state.b) > 1e-6)
        torque = choice(state, SHORT_S)
        change = free_change(state) + state.inverse @ torque
        power = state.omega @ torque
        rounding = np.linalg.norm(state.omega) * np.linalg.norm(torque)
        assert abs(candidate_rate(state, change) - power) <= 1e-9 * (rounding + scale_of(state) + 1e-15)
        over_the_pulse = SHORT_S * np.linalg.norm(free_change(state)) * np.linalg.norm(torque)
        assert power <= over_the_pulse + 1e-12 * rounding + 1e-200  # below it products become zero

    @CHOICES
    def test_it_falls_wherever_a_dipole_can_take_energy_away(self, choice):
        """That is where the rate is not along the field."""
        for state in planted_states():
            across = np.linalg.norm(np.cross(state.omega, state.b))
            assert across > 1e-3 * np.linalg.norm(state.omega) * np.linalg.norm(state.b)
            assert state.omega @ choice(state, SHORT_S) < 0.0

    @CHOICES
    def test_along_the_field_nothing_can_and_nothing_is_done(self, choice):
        for state in planted_states():
            along = state._replace(inertia=3.0 * np.eye(3), omega=1e-2 * state.b / np.linalg.norm(state.b))
            assert abs(along.omega @ choice(along, SHORT_S)) < 1e-6 * kinetic(along, along.omega)

    @CHOICES
    def test_with_the_sign_of_the_impulse_planted_it_rises(self, choice):
        rising = [state.omega @ choice(state, SHORT_S, -1.0) > 0.0 for state in planted_states()]
        assert all(rising)
