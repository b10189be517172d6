"""What the predictive law expects of a pulse, against the plant's rigid body with a wheel and any inertia."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsw.core.actuation.pulses import PulseConfig, PulseState, choose, dipole_am2
from fsw.core.laws.predictive import best_impulse, free_rate_change, missing_impulse
from sim.campaign.claim import Claim, ClaimOutcome, Study, Threshold
from sim.campaign.study import spread_of
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.orbit import EARTH_RADIUS_M, MU_M3PS2
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, Mat3, Quaternion, Vec3, matrix, normalise, transform
from sim.validate.consat.posat1 import SOURCE
from sim.value_types import Array

STATES = 200
RADIUS_M = EARTH_RADIUS_M + 800e3
RATE_RADPS = sqrt(MU_M3PS2 / RADIUS_M**3)
MOST_RADPS, MOST_WHEEL_NMS, FIELD_T = 2e-3, 0.1, 4e-5
LEVELS_AM2 = (15.0, 30.0, 60.0)
PULSE_S, MOMENT_S = 3.0, 0.001
"""The pulse, and a time so short that the rate changes in proportion to it."""
FREE = PulseState((0, 0, 0), 0)
NORMAL: Vec3 = (0.0, 0.0, 1.0)
NO_RATE: Vec3 = (0.0, 0.0, 0.0)

Dipole = Callable[["State"], Vec3]


@dataclass(frozen=True, slots=True)
class State:
    """A satellite in the orbital frame, which is the inertial one at that moment."""

    inertia_kgm2: Array
    wheel_body_nms: Vec3
    q_body_from_orbit: Quaternion
    omega_body_orbit_radps: Vec3
    b_orbit_t: Vec3

    @property
    def b_body_t(self) -> Vec3:
        """The field in body axes."""
        return transform(matrix(self.q_body_from_orbit), self.b_orbit_t)

    def change(self) -> Vec3:
        """dOmega/dt without control, as the law has it."""
        return free_rate_change(
            self.omega_body_orbit_radps,
            matrix(self.q_body_from_orbit),
            RATE_RADPS,
            RADIUS_M,
            rows(self.inertia_kgm2),
            rows(np.linalg.inv(self.inertia_kgm2)),
            self.wheel_body_nms,
        )

    def missing(self) -> Vec3:
        """The impulse that the law demands."""
        omega, inertia = self.omega_body_orbit_radps, rows(self.inertia_kgm2)
        return missing_impulse(omega, self.change(), NO_RATE, PULSE_S, inertia)

    def omega_after(self, m_body_am2: Vec3, seconds: float) -> Array:
        """Omega in the plant after a dipole has acted so long."""
        inertia, start = rows(self.inertia_kgm2), matrix(self.q_body_from_orbit)
        around = Surroundings((1.0, 0.0, 0.0), 3.0 * RATE_RADPS**2, self.b_orbit_t)
        omega = np.array(self.omega_body_orbit_radps) + RATE_RADPS * np.array(transform(start, NORMAL))

        body, torque = RigidBody(inertia, self.wheel_body_nms), BodyTorque(inertia, m_body_am2)
        motion = Motion(self.q_body_from_orbit, vec3(omega))
        end = body.step(motion, torque, seconds, around, around, around)
        normal = transform(matrix(end.q_body_from_eci), NORMAL)
        after: Array = np.array(end.omega_body_radps) - RATE_RADPS * np.array(normal)
        return after

    def energy(self, omega_radps: Array) -> float:
        """The cost (5), 1/2 Omega J Omega."""
        return float(0.5 * omega_radps @ self.inertia_kgm2 @ omega_radps)


def studies() -> list[Study]:
    """The rate that the law expects, and the energy that its dipole leaves."""
    return [prediction()]


def prediction() -> Study:
    """The expected change of the rate, and that both choices leave less energy than none, in the plant."""
    text = "Energy of the rate after a pulse, over that without"
    claims = (
        Claim(
            "prediction.rate",
            "Expected change of the rate against the plant's, relative",
            SOURCE,
            "1",
            high=1e-4,
        ),
        Claim(
            "prediction.unrestricted",
            f"{text}, best dipole, all ((15) of the paper: not more)",
            SOURCE,
            "1",
            high=1.0,
            threshold=Threshold.PAPER,
        ),
        Claim(
            "prediction.restricted",
            f"{text}, best of 18 pulses and none, all ((15) of the paper: not more)",
            SOURCE,
            "1",
            high=1.0,
            threshold=Threshold.PAPER,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        columns = [list(column) for column in zip(*found[0], strict=True)]
        return [
            claim.judge(float(np.max(column)), spread=spread_of(claim, column))
            for claim, column in zip(claims, columns, strict=True)
        ]

    return Study("prediction", (all_errors,), conclude)


def all_errors() -> list[tuple[float, float, float]]:
    """The three figures of each state."""
    states = [state_of(seed) for seed in range(STATES)]
    return [(rate_error(one), energy_left(one, unrestricted), energy_left(one, restricted)) for one in states]


def state_of(seed: int) -> State:
    """Any attitude, rate, wheel and field; a boom or a compact body, with products of inertia."""
    random = np.random.default_rng(seed)
    moments = np.diag([1.0, 139.0, 139.0] if seed % 2 else [20.0, 27.0, 31.0])
    turn, _ = np.linalg.qr(random.standard_normal((3, 3)))
    q0, q1, q2, q3 = random.standard_normal(4).tolist()
    sizes = (MOST_WHEEL_NMS, MOST_RADPS, FIELD_T)
    wheel, omega, field = (size * random.standard_normal(3) / 2.0 for size in sizes)
    return State(turn @ moments @ turn.T, vec3(wheel), normalise((q0, q1, q2, q3)), vec3(omega), vec3(field))


def rate_error(state: State) -> float:
    """|Omega_plant - Omega - dt dOmega/dt| / |dt dOmega/dt| over a moment."""
    expected = MOMENT_S * np.array(state.change())
    change = state.omega_after(ZERO, MOMENT_S) - np.array(state.omega_body_orbit_radps)
    return float(np.linalg.norm(change - expected) / np.linalg.norm(expected))


def energy_left(state: State, chosen: Dipole) -> float:
    """The energy in the plant after a pulse with the chosen dipole, over that without."""
    after, without = (state.energy(state.omega_after(m, PULSE_S)) for m in (chosen(state), ZERO))
    return after / without


def unrestricted(state: State) -> Vec3:
    """The best dipole without limits."""
    b = np.array(state.b_body_t)
    paid = best_impulse(state.missing(), vec3(b), rows(state.inertia_kgm2))
    return vec3(np.cross(b, paid) / (PULSE_S * b @ b))


def restricted(state: State) -> Vec3:
    """The best of 18 pulses, or none."""
    metric = rows(np.linalg.inv(state.inertia_kgm2))
    config = PulseConfig(3, 100, 3000, True, LEVELS_AM2, PULSE_S, 1.0, 300.0, metric, metric)
    fired = choose(FREE, state.missing(), metric, 0, state.b_body_t, config)
    m = np.zeros(3)
    if fired is not None:
        m[fired.coil] = dipole_am2(fired.level, LEVELS_AM2)
    return vec3(m)


def vec3(v: NDArray[np.floating]) -> Vec3:
    """Plain floats."""
    x, y, z = (float(c) for c in v)
    return (x, y, z)


def rows(m: NDArray[np.floating]) -> Mat3:
    """Plain floats."""
    first, second, third = map(vec3, m)
    return (first, second, third)
