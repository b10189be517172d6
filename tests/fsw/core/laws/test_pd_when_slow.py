"""PD beside the gravity gradient: damping alone while the body is fast, PD while it is slow."""

import numpy as np
import pytest

from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.damping import rate_damping
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.pd import pd, pd_far
from fsw.core.laws.pd_when_slow import SlowGains, error_when_slow, slow_far, slow_near

Q = (0.6, -0.48, 0.0, 0.64)
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
GAINS = {"pd_when_slow": SlowGains(0.004)}


def test_the_attitude_counts_up_to_the_rate_that_is_set():
    error = (0.1, -0.2, 0.3)
    assert error_when_slow(error, (0.0, 0.003, 0.0), 0.004) == error
    assert error_when_slow(error, (0.003, 0.003, 0.0), 0.004) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("ours", "other"), [(slow_near, pd), (slow_far, pd_far)])
def test_it_is_one_of_the_two_laws(bench, ours, other):
    settings, point = bench.config(bench.Body(), 1.0, GAINS), bench.setpoint(k_w=6e6, k_a=1600.0)
    for rate, expected in (((0.001, -0.002, 0.0), other), ((0.01, -0.02, 0.0), rate_damping)):
        inputs = LawInput(Attitude(Q, rate, 0.0, 0.0, True), B_BODY_T, FieldSample(), FieldSample())
        m = ours(inputs, (), point, settings).m_body_am2
        assert m == pytest.approx(expected(inputs, (), point, settings).m_body_am2)


@pytest.mark.long
def test_a_tumble_loses_the_jacobi_integral_while_it_is_fast_and_ends_pointed(bench, turned):
    orbit, body = bench.Orbit(), bench.Body(inertia=np.diag([0.3, 2.0, 2.2]), most_am2=5.0)
    run = bench.fly(
        slow_far,
        bench.setpoint(k_w=6e6, k_a=1615.0),
        gains=GAINS,
        body=body,
        c_body_from_orbit=turned((1, -2, 1), 110.0),
        omega_body=(0.02, -0.03, 0.025),
        seconds=3.5 * orbit.period_s,
    )
    e1, e3 = run.c_body_from_orbit[:, :, 0], run.c_body_from_orbit[:, :, 2]
    half = [0.5 * np.einsum("ti,ij,tj->t", v, body.inertia, v) for v in (run.relative_body, e1, e3)]
    jacobi = half[0] + orbit.rate_radps**2 * (3.0 * half[1] - half[2])
    fast = np.linalg.norm(run.relative_body, axis=1)[:-1] > 0.004
    assert fast[0]
    assert fast.sum() > 100
    assert np.all(np.diff(jacobi)[fast] < 0.0)
    assert run.angle_deg[-1] < 2.0


def test_a_rate_without_sense_is_refused():
    with pytest.raises(ValueError, match="must be positive"):
        SlowGains(0.0)
