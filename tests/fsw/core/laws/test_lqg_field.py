"""Control from the magnetometer alone: the filter is the best linear one, and the body comes to rest."""

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from fsw.core.laws.lqg_field import FieldOnlyGains, covariances, lqg_field
from fsw.core.laws.lqr import STEPS, LqrGains, orbit_problem
from fsw.core.laws.plan.riccati import free_step, resting_torque, skews

INERTIA = np.array([[1.02, 0.02, 0.01], [0.02, 1.85, -0.03], [0.01, -0.03, 1.95]])
DIAGONAL = np.diag([1.02, 1.85, 1.95])


def test_the_covariance_is_that_of_the_best_estimate(bench):
    """Beside the conditional covariance of all fields of some steps at once, from the same beginning."""
    orbit, rows = bench.Orbit(), tuple(map(tuple, INERTIA.tolist()))
    b0 = 7.812e15 / orbit.radius_m**3
    problem, field = orbit_problem(rows, (0.0, 0.0, 0.0), orbit.rate_radps, np.radians(98.6), b0, LqrGains())
    steps, torque_nm, noise_t = 9, 1e-7, 2e-7
    first = np.diag(np.repeat([1e-6, 0.04], 3))
    f, g = problem.free[:, :6], problem.free[:, 6:]
    sigmas = covariances(problem, field[:steps], torque_nm, noise_t, first)
    # of (x0, w1, ..., wn): the state at the last step, and what was seen at each
    prior = block_diag(first, *[torque_nm**2 * np.eye(3)] * (steps - 1))
    state, seen = np.hstack([np.eye(6), np.zeros((6, 3 * (steps - 1)))]), []
    for k in range(steps):
        if k:
            state = f @ state
            state[:, 6 + 3 * (k - 1) : 9 + 3 * (k - 1)] += g
        seen.append(np.hstack([np.zeros((3, 3)), skews(field[k])]) @ state)
    rows_seen = np.vstack(seen)
    told = rows_seen @ prior @ rows_seen.T + noise_t**2 * np.eye(3 * steps)
    across = state @ prior @ rows_seen.T
    expected = state @ prior @ state.T - across @ np.linalg.solve(told, across.T)
    repeated = covariances_once(problem, field[:steps], torque_nm, noise_t, first)
    assert repeated[-1] == pytest.approx(expected, rel=1e-5, abs=1e-9 * np.abs(expected).max())
    assert np.linalg.eigvalsh(sigmas[-1])[0] > 0.0


def covariances_once(problem, field, torque_nm, noise_t, first):
    """One pass, by information in place of gain: another form of the same filter."""
    f, g = problem.free[:, :6], problem.free[:, 6:]
    found, sigma = [], first
    for b in field:
        h = np.hstack([np.zeros((3, 3)), skews(b)])
        found.append(np.linalg.inv(np.linalg.inv(sigma) + h.T @ h / noise_t**2))
        sigma = f @ found[-1] @ f.T + torque_nm**2 * g @ g.T
    return found


def test_the_periodic_covariance_repeats(bench):
    orbit, rows = bench.Orbit(), tuple(map(tuple, INERTIA.tolist()))
    b0 = 7.812e15 / orbit.radius_m**3
    problem, field = orbit_problem(rows, (0.0, 0.0, 0.0), orbit.rate_radps, np.radians(98.6), b0, LqrGains())
    args = (problem, field, 1e-7, 2e-7)
    sigmas = covariances(*args, np.diag(np.repeat([1e-6, 1.0], 3)))
    f, g = problem.free[:, :6], problem.free[:, 6:]
    again = covariances_once(*args, f @ sigmas[-1] @ f.T + 1e-14 * g @ g.T)
    assert again[-1] == pytest.approx(sigmas[-1], rel=1e-3, abs=1e-4 * np.abs(sigmas[-1]).max())


def test_the_observer_is_the_covariance_of_its_own_noise_and_torque(bench):
    """Sigma / (v^2 step): Sigma is the one that repeats, whatever the length of an orbit's steps."""
    orbit, rows, own = bench.Orbit(), tuple(map(tuple, INERTIA.tolist())), FieldOnlyGains()
    b0 = 7.812e15 / orbit.radius_m**3
    problem, field = orbit_problem(rows, (0.0, 0.0, 0.0), orbit.rate_radps, np.radians(98.6), b0, own)
    observer = bench.scheduled(bench.Body(INERTIA), 1.0, "lqg_field").schedules["lqg_field"].observer
    noise_t = own.noise * b0
    torque_nm = own.torque * orbit.rate_radps**2 * np.trace(INERTIA) / 3.0
    sigmas = observer * noise_t**2 * problem.step_s
    f, g = problem.free[:, :6], problem.free[:, 6:]
    before = f @ sigmas[-1] @ f.T + torque_nm**2 * g @ g.T
    again = covariances_once(problem, field, torque_nm, noise_t, before)
    for ours, expected in zip(sigmas, again, strict=True):
        assert ours == pytest.approx(expected, rel=1e-3, abs=1e-4 * np.abs(expected).max())


@pytest.fixture(scope="module")
def flight(bench, turned):
    def fly(angle_deg=15.0, orbits=2.5, known=False, dipole=(0.0, 0.0, 0.0)):
        body = bench.Body(DIAGONAL, most_am2=2.0, dipole=dipole)
        return bench.fly_from_rest(
            lqg_field,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), angle_deg),
            orbits=orbits,
            step_s=10.0,
            known=known,
            settings=bench.scheduled(body, 10.0, "lqg_field"),
        )

    return fly


@pytest.mark.long
def test_the_field_alone_brings_the_body_to_its_attitude(flight):
    flown = flight()
    assert flown.angle_deg[-1] < 1.0
    assert flown.angle_deg.max() < 40.0


def test_it_does_not_look_at_the_attitude(flight):
    blind, seeing = (flight(orbits=0.1, known=known).m_body for known in (False, True))
    assert np.array_equal(blind, seeing)


@pytest.fixture
def asked(bench, turned):
    def ask(memory=(), tick=9, sampled=True, **changed):
        orbit, body = bench.Orbit(), bench.Body(INERTIA, most_am2=2.0)
        c = turned((1, -2, 3), 5.0) @ orbit.c_orbit_from_eci(float(tick))
        before = bench.inputs_at(orbit, 3, 1.0, c, np.zeros(3), None).sample
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array([1e-3, 0.0, 1e-3]), before, sampled=sampled)
        settings = bench.scheduled(body, 1.0, "lqg_field")
        return lqg_field(inputs.replace(**changed), memory, bench.setpoint(), settings)

    return ask


def test_a_sample_moves_the_estimate_and_an_old_one_does_not(asked):
    """From the estimate of rest the attitude is moved towards (1, -2, 3)."""
    moved = np.array(asked().memory[4:7])
    assert moved @ np.array([1.0, -2.0, 3.0]) > 0.0
    assert asked(sampled=False).memory[1:7] == (0.0,) * 6


def test_a_long_gap_begins_anew(asked):
    memory = asked().memory
    assert asked(memory, tick=2000) == asked((), tick=2000)


def test_without_an_orbit_nothing_is_asked_for(asked):
    assert asked(reference=None).m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("gains", [{"noise": 0.0}, {"torque": 0.0}, {"effort": 0.0}])
def test_numbers_out_of_range_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        FieldOnlyGains(**gains)


def test_without_a_sample_the_estimate_moves_under_the_torque_on_the_nominal_attitude(asked, bench):
    """From rest without a dipole, over three seconds."""
    rows, w0 = tuple(map(tuple, INERTIA.tolist())), bench.Orbit().rate_radps
    moved = asked((6.0, *(0.0,) * 9), sampled=False).memory[1:7]
    torque = resting_torque(rows, (0.0, 0.0, 0.0), w0)
    expected = free_step(rows, (0.0, 0.0, 0.0), w0, 3.0)[:, 6:] @ torque
    assert moved == pytest.approx(expected, rel=1e-6)
    assert np.abs(torque).max() > 1e-9


def test_the_dipole_is_the_regulators_for_what_is_estimated(asked, bench):
    """In orbital axes in memory, in the estimated body's as demanded; the torque at rest is answered too."""
    table = bench.scheduled(bench.Body(INERTIA, most_am2=2.0), 1.0, "lqg_field").schedules["lqg_field"]
    x = np.array([2e-5, -1e-5, 3e-5, 0.05, -0.1, 0.15])
    demand = asked((8.0, *x, *(0.0,) * 3), sampled=False)
    x = np.array(demand.memory[1:7])
    c = Rotation.from_rotvec(x[3:]).as_matrix().T
    step = int(9.0 / bench.Orbit().period_s * STEPS)
    given = table.gains[step] @ np.concatenate([x, c.T @ table.problem.resting_nm])
    assert np.array(demand.memory[7:10]) == pytest.approx(given, abs=0.02 * np.abs(given).max())
    assert np.array(demand.m_body_am2) == pytest.approx(
        c @ demand.memory[7:10], abs=1e-2 * np.abs(given).max()
    )
    rest = table.gains[step, :, 6:] @ table.problem.resting_nm
    assert np.abs(rest).max() > 0.03 * np.abs(given).max()
