"""What the tests of coil effects fly: a filter, pulses that did part of what they should, and their trace."""

from math import inf, radians

import filter_steps
import numpy as np
from changed import changed
from estimator_samples import tuned

from fsw.core.actuation.pulses import PulseConfig, impulse
from fsw.core.algebra.quaternion import IDENTITY, conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, add, scale, sub, transform, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.coils.effects import solve, trace_pulse
from fsw.core.fdir.coils.explanations import explain_pulses
from fsw.core.fdir.coils.weak_test import WeakTest
from fsw.core.laws.plan.pulse_model import AXES, Pulse
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference

QUIET = {
    "attitude_sigma_deg": 0.1,
    "rate_sigma_degps": 0.001,
    "torque_noise_nm_rts": 1e-8,
    "gate_nis": inf,
    "mag_bias_t": Prior((3e-7,) * 3, (1e-11,) * 3),
    "torque_body_nm": Prior((1e-7,) * 3, (3e-11,) * 3),
}
"""A filter that is sure of its attitude, so that a pulse shows, and refuses nothing."""
CONFIG = tuned(**QUIET)
B_ECI_T, S_ECI, E1_ECI = (1.7e-5, -2.3e-5, 3.1e-5), unit((-0.8, 0.35, 0.4)), unit((0.3, 0.7, -0.5))
REFERENCE = Reference(scale(7.1e6, E1_ECI), 7.1e6, B_ECI_T, S_ECI, True, IDENTITY, 1.055e-3)
GRAVITY_PS2 = 3.0 * MU_M3PS2 / REFERENCE.radius_m**3
START = mekf.start(normalise((0.6, -0.4, 0.5, 0.3)), (1e-3, -4e-4, 7e-4), CONFIG)
LEVEL_AM2, PULSE_S, EVERY, UNUSED = 8.0, 3, 100, (ZERO, ZERO, ZERO)
PULSES = PulseConfig(PULSE_S, EVERY, 3000, True, (0.02, 4.0, LEVEL_AM2), PULSE_S, 1.0, 300.0, UNUSED, UNUSED)
WEAK = WeakTest(0.7, 0.8, 14.0)


def step(estimate, dipole_am2):
    return filter_steps.predict(estimate, E1_ECI, B_ECI_T, 3e-6, dipole_am2, CONFIG)


def b_body_t(estimate):
    return rotate(estimate.q_body_from_eci, B_ECI_T)


def kick_radps(estimate, coil):
    impulse_nms = impulse(Pulse(coil, 3), b_body_t(estimate), PULSES)
    return transform(CONFIG.rotor.inertia_inverse, impulse_nms)


def traced(estimate, pulse, b_eci_t=B_ECI_T, tuning=CONFIG):
    return changed(estimate, trace_pulse, pulse, b_eci_t, GRAVITY_PS2, PULSES, tuning)


def fly(coils, parts, ticks=EVERY, noise=1.0, alter=lambda estimate: estimate, level=3):
    """The estimate after pulses of these coils, each with its part of the effect; also the true attitude."""
    random = np.random.default_rng(3)
    truth = estimate = START
    for coil, part in zip(coils, parts, strict=True):
        for tick in range(ticks):
            dipole = scale(PULSES.levels_am2[level - 1], AXES[coil]) if tick < PULSE_S else ZERO
            truth, estimate = step(truth, scale(part, dipole)), step(estimate, dipole)
            if tick >= PULSE_S:
                b, s = (rotate(truth.q_body_from_eci, r) for r in (B_ECI_T, S_ECI))
                b = add(b, tuple(noise * 2e-7 * random.normal(size=3)))
                s = add(s, tuple(noise * radians(0.5) * random.normal(size=3)))
                estimate = filter_steps.update_both(estimate, b, B_ECI_T, s, S_ECI, CONFIG)
            elif tick == PULSE_S - 1:
                estimate = traced(alter(estimate), Pulse(coil, level))
    return estimate, truth


def judged(estimate):
    """The estimate after the solution, and its likeliest explanation: a coil, and the part of its effect."""
    estimate = estimate.copy()
    solution = solve(estimate, CONFIG)
    if solution is None:
        return estimate, None
    likeliest = explain_pulses(solution)[0]
    nothing = next(one for one in explain_pulses(solution) if one.coil == -1)
    sure = nothing.distance - likeliest.distance > 2.0 * WEAK.threshold
    return estimate, (likeliest.coil, likeliest.part) if sure else None


def deviation(estimate):
    sums = estimate.trace.sums
    return np.linalg.solve(sums[:-1, :-1] + np.eye(len(sums) - 1), sums[:-1, -1])


def covariance(estimate):
    sums = estimate.trace.sums
    return np.linalg.inv(sums[:-1, :-1] + np.eye(len(sums) - 1))


def error_state(estimate, other):
    """Attitude and rate that ``estimate`` lacks of ``other``."""
    _, *turn = multiply(conjugate(estimate.q_body_from_eci), other.q_body_from_eci)
    return np.array((*scale(2.0, tuple(turn)), *sub(other.omega_body_radps, estimate.omega_body_radps)))


def left(estimate):
    """What the pulses do not explain of the squares of the innovations."""
    return estimate.trace.sums[-1, -1] - deviation(estimate) @ estimate.trace.sums[:-1, -1]
