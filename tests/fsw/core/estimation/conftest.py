"""A satellite for the filter: what it carries by layout, and its measurements and motion written out again.

The numbers are chosen so that no term can hide behind another: an inertia tensor with products, rates about
all axes, parameters that are all nonzero and unequal. Rotations are exact here, of first order in the filter.
"""

from dataclasses import dataclass, replace
from math import radians
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from estimator_samples import seen_from, step
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import normalise
from fsw.core.algebra.vector import unit
from fsw.core.estimation.estimator import EstimatorState, Used
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import NAMES, OF_CELLS, SIZES, Parameters, Prior

LAYOUTS = {
    "none": (),
    "bias": ("mag_bias_t",),
    "torque": ("torque_body_nm",),
    "both": ("mag_bias_t", "torque_body_nm"),
    "all": NAMES,
}
PRIORS = SimpleNamespace(
    mag_bias_t=Prior((3e-7, 4e-7, 5e-7), (1e-10, 2e-10, 3e-10)),
    torque_body_nm=Prior((1e-7, 8e-8, 9e-8), (3e-10, 4e-10, 5e-10)),
    dipole_body_am2=Prior((0.02, 0.03, 0.025), (1e-6, 2e-6, 3e-6)),
    coil_error=Prior(
        (0.03, 0.006, 0.007, 0.008, 0.025, 0.005, 0.004, 0.009, 0.02), tuple(1e-5 * n for n in range(1, 10))
    ),
    inertia_error_kgm2=Prior((0.06, 0.1, 0.08, 0.018, 0.016, 0.02), (0.0,) * 6),
    mag_turn_rad=Prior((0.006, 0.007, 0.008), (0.0,) * 3),
    mag_scale=Prior((0.003, 0.004, 0.002), (0.0,) * 3),
    sun_turn_rad=Prior((0.004, 0.003, 0.005), (0.0,) * 3),
    delay_s=Prior((0.5, 0.6), (0.0, 0.0)),
    cell_excess=Prior((0.1, 0.12, 0.08, 0.09, 0.11, 0.07), (0.0,) * 6),
    cell_gain=Prior((0.05, 0.06, 0.04, 0.045, 0.055, 0.035), (0.0,) * 6),
    earth_light=Prior((0.08,), (0.0,)),
)
TRUE = Parameters(
    mag_bias_t=(3e-7, -5e-7, 2e-7),
    torque_body_nm=(4e-8, -2e-8, 3e-8),
    dipole_body_am2=(0.015, -0.025, 0.02),
    coil_error=(0.02, -0.004, 0.005, 0.006, -0.018, 0.003, -0.002, 0.007, 0.014),
    inertia_error_kgm2=(0.05, -0.08, 0.06, 0.011, -0.009, 0.013),
    mag_turn_rad=(0.005, -0.004, 0.006),
    mag_scale=(0.002, -0.003, 0.0015),
    sun_turn_rad=(-0.003, 0.002, 0.004),
    delay_s=(0.4, 0.7),
    cell_excess=(0.05, -0.08, 0.03, 0.09, -0.04, 0.06),
    cell_gain=(0.04, -0.05, 0.03, -0.02, 0.06, -0.03),
    earth_light=(0.07,),
)
"""How a satellite differs from its table: about as much as the priors expect."""


@dataclass(frozen=True)
class Satellite:
    """A filter that carries some of the parameters, and the satellite that it knows; SI units, body axes."""

    carried: tuple[str, ...]
    wheel_body_nms: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia_kgm2 = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
    q = normalise((0.6, -0.4, 0.5, 0.3))
    omega = (0.021, -0.034, 0.027)
    e1_eci = unit((0.3, 0.7, -0.5))
    b_eci_t = (1.7e-5, -2.3e-5, 3.1e-5)
    s_eci = unit((-0.8, 0.35, 0.4))
    gravity_ps2 = 3.3e-6
    driven_am2 = (0.0, -8.0, 2.0)
    sigma: ClassVar = {"field": np.full(3, 2e-7), "sun": np.full(3, radians(0.5))}
    sigma["both"] = np.concatenate((sigma["field"], sigma["sun"]))

    @property
    def parameters(self):
        """What is true of those carried; the others are as the table says."""
        return Parameters(**{name: getattr(TRUE, name) for name in self.carried})

    def config(self, *, noiseless=False, **changes):
        """The filter's tuning; ``noiseless``: without any process noise."""
        values = {
            "tick_s": 1.0,
            "wheel_body_nms": self.wheel_body_nms,
            "magnetometer_sigma_t": 2e-7,
            "sun_sigma_rad": radians(0.5),
            "attitude_sigma_rad": radians(5.0),
            "rate_sigma_radps": radians(2.0),
            "torque_noise_nm_rts": 0.0 if noiseless else 1e-7,
            "gate_nis": 16.27,
        }
        priors = {name: getattr(PRIORS, name) for name in self.carried}
        if noiseless:
            priors = {name: Prior(prior.sigma, (0.0,) * len(prior.walk)) for name, prior in priors.items()}
        return mekf_config(self.inertia_kgm2, priors=priors, **(values | changes))

    def size(self):
        return 6 + sum(SIZES[name] for name in self.carried)

    def place(self, name):
        """Where a parameter stands in the error state: behind attitude and rate, in the order of names."""
        before = sum(SIZES[other] for other in NAMES[: NAMES.index(name)] if other in self.carried)
        return slice(6 + before, 6 + before + SIZES[name])

    def scales(self):
        """A typical deviation of each part of the error state of a filter that has settled."""
        known = [0.4 * np.array(getattr(PRIORS, name).sigma) for name in NAMES if name in self.carried]
        return np.concatenate((np.full(3, 1e-3), np.full(3, 1e-4), *known))

    def covariance(self):
        """Full, positive definite, in the units of each state."""
        size, scales = self.size(), self.scales()
        root = np.random.default_rng(size).normal(size=(size, size))
        return np.outer(scales, scales) * (root @ root.T / size + 0.1 * np.eye(size))

    def estimate(self, covariance=None, parameters=None):
        """An estimate with everything carried nonzero."""
        covariance = self.covariance() if covariance is None else covariance
        parameters = self.parameters if parameters is None else parameters
        lacking = [name for name in OF_CELLS if name in self.carried and not getattr(parameters, name)]
        parameters = replace(parameters, **{name: (0.0,) * OF_CELLS[name] for name in lacking})
        return Estimate(self.q, self.omega, parameters, covariance)

    def moved(self, estimate, error):
        """The estimate plus an error state; the attitude by an exact rotation."""
        q = quaternion_of(matrix_of(estimate.q_body_from_eci, error[0:3]))
        parts = {
            name: tuple(map(float, np.add(getattr(estimate.parameters, name), error[self.place(name)])))
            for name in self.carried
        }
        rate = tuple(map(float, np.add(estimate.omega_body_radps, error[3:6])))
        return replace(
            estimate,
            q_body_from_eci=q,
            omega_body_radps=rate,
            parameters=replace(estimate.parameters, **parts),
        )

    def error(self, before, after):
        """The error state that leads from one estimate to the other."""
        turn = matrix_of(after.q_body_from_eci) @ matrix_of(before.q_body_from_eci).T
        known = [
            np.subtract(getattr(after.parameters, name), getattr(before.parameters, name))
            for name in NAMES
            if name in self.carried
        ]
        rate = np.subtract(after.omega_body_radps, before.omega_body_radps)
        return np.concatenate((-Rotation.from_matrix(turn).as_rotvec(), rate, *known))

    def measured(self, kind, estimate, b_eci_t=b_eci_t):
        """What ideal sensors say of such a satellite: field, Sun, or both.

        Field (1 + s) o R(turn) C(t - delay) b + bias, Sun R(turn) C(t - delay) s.
        """
        parameters, rate = estimate.parameters, np.array(estimate.omega_body_radps)
        late = [matrix_of(estimate.q_body_from_eci, -rate * delay) for delay in parameters.delay_s]
        turns = [
            Rotation.from_rotvec(turn).as_matrix().T
            for turn in (parameters.mag_turn_rad, parameters.sun_turn_rad)
        ]
        field = (1.0 + np.array(parameters.mag_scale)) * (turns[0] @ late[0] @ b_eci_t)
        said = {"field": field + parameters.mag_bias_t, "sun": turns[1] @ late[1] @ self.s_eci}
        return np.concatenate((said["field"], said["sun"])) if kind == "both" else said[kind]

    def sensitivity(self, kind, estimate, step=1e-2):
        """d(measured) / d(error state), (3 or 6, n), by central differences of ``step`` deviations."""
        columns = []
        for index, scale in enumerate(self.scales()):
            error = np.zeros(self.size())
            error[index] = step * scale
            up, down = (self.measured(kind, self.moved(estimate, sign * error)) for sign in (1.0, -1.0))
            columns.append((up - down) / (2.0 * error[index]))
        return np.array(columns).T


def matrix_of(q, turn_rad=(0.0, 0.0, 0.0)):
    """C(q), after which the body has turned further by a rotation vector, body axes."""
    return (Rotation.from_quat((*q[1:], q[0])) * Rotation.from_rotvec(turn_rad)).as_matrix().T


def quaternion_of(matrix):
    x, y, z, w = map(float, Rotation.from_matrix(matrix.T).as_quat())
    return (w, x, y, z)


def flow(estimate, satellite, driven_am2, b_eci_t, gravity_ps2, duration_s):
    """The nonlinear motion by the parameters of the estimate, integrated to 1e-13.

    J dw/dt = m x b + g e x J e + T - w x (J w + h), with J = J0 + dJ and m = (1 + G) m_driven + d.
    """
    parameters = estimate.parameters
    xx, yy, zz, xy, xz, yz = parameters.inertia_error_kgm2
    inertia = np.add(satellite.inertia_kgm2, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    coils = np.eye(3) + np.reshape(parameters.coil_error, (3, 3))
    dipole = coils @ driven_am2 + parameters.dipole_body_am2

    def rates(_, state):
        c, w = matrix_of(state[:4]), state[4:]
        e, b = c @ satellite.e1_eci, c @ b_eci_t
        torque = np.cross(dipole, b) + gravity_ps2 * np.cross(e, inertia @ e) + parameters.torque_body_nm
        q0, q = state[0], state[1:4]
        turning = 0.5 * np.array([-q @ w, *(q0 * w + np.cross(q, w))])
        return np.concatenate(
            (turning, np.linalg.solve(inertia, torque - np.cross(w, inertia @ w + satellite.wheel_body_nms)))
        )

    begin = (*estimate.q_body_from_eci, *estimate.omega_body_radps)
    end = solve_ivp(rates, (0.0, duration_s), begin, method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    q = tuple(map(float, end[:4] / np.linalg.norm(end[:4])))
    return replace(estimate, q_body_from_eci=q, omega_body_radps=tuple(map(float, end[4:])))


@pytest.fixture(scope="session", params=LAYOUTS)
def satellite(request):
    """One whose filter carries nothing, the bias, the torque, both, or all."""
    return Satellite(LAYOUTS[request.param])


@pytest.fixture(scope="session")
def carrying():
    """Makes a satellite whose filter carries these parameters."""
    return lambda *names: Satellite(names)


@pytest.fixture(scope="session")
def full():
    """One whose filter carries all."""
    return Satellite(NAMES)


@pytest.fixture(scope="session")
def nonlinear_flow():
    """Integrates the motion of a satellite."""
    return flow


@pytest.fixture(scope="module")
def settled():
    """A filter that has seen a body at rest for two minutes."""
    state = EstimatorState()
    for _ in range(120):
        state, used = step(state, seen_from())
    assert used == Used(True, True, False)
    assert (state.rejected_total, state.restarts) == (0, 0)
    return state
