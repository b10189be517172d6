"""The regulator that knows a periodic torque: exact for what it is told, and it learns what it is not."""

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.lqr import STEPS, lqr, middles, orbit_problem
from fsw.core.laws.lqr_disturbed import DisturbedGains, functions, lqr_disturbed
from fsw.core.laws.plan.riccati import skews

DIAGONAL = np.diag([1.02, 1.85, 1.95])
INERTIA = np.array([[1.02, 0.02, 0.01], [0.02, 1.85, -0.03], [0.01, -0.03, 1.95]])
DIPOLE_AM2 = (0.005, -0.003, 0.008)


@pytest.fixture(scope="module")
def table(bench):
    return bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_disturbed").schedules["lqr_disturbed"]


def test_a_constant_is_answered_as_the_regulator_answers_it(table):
    assert table.gains[:, :, 9:12] == pytest.approx(
        table.gains[:, :, 6:9], rel=1e-6, abs=1e-6 * np.abs(table.gains[:, :, 6:9]).max()
    )


def test_no_other_periodic_dipole_costs_less_under_the_torque(bench, table):
    """The periodic motion under a torque of all five functions, beside least squares over all steps."""
    orbit = bench.Orbit()
    rows = tuple(map(tuple, INERTIA.tolist()))
    b0 = 7.812e15 / orbit.radius_m**3
    problem, field = orbit_problem(
        rows, (0.0, 0.0, 0.0), orbit.rate_radps, np.radians(98.6), b0, DisturbedGains()
    )
    c = 1e-8 * np.random.default_rng(2).standard_normal(15)
    f, g = problem.free[:, :6], problem.free[:, 6:]
    pushes = -g @ skews(field)
    torques = np.array([np.kron(functions(u), np.eye(3)) @ c for u in middles().tolist()])
    # the periodic motion is linear in the dipoles: x = x_d + R m
    motion = np.kron(np.roll(np.eye(STEPS), 1, axis=0), f)
    solve = np.linalg.inv(np.eye(6 * STEPS) - motion)
    shift = np.roll(np.eye(STEPS), 1, axis=0)
    driven = (shift @ (torques @ g.T)).ravel()
    pushed = np.einsum("kl,lij->kilj", shift, pushes).reshape(6 * STEPS, 3 * STEPS)
    weight = np.sqrt(np.tile(problem.cost, STEPS))
    matrix = np.vstack([weight[:, None] * (solve @ pushed), np.sqrt(problem.effort) * np.eye(3 * STEPS)])
    wanted = np.concatenate([-weight * (solve @ driven), np.zeros(3 * STEPS)])
    best = np.linalg.lstsq(matrix, wanted, rcond=None)[0].reshape(STEPS, 3)
    states = (solve @ (driven + pushed @ best.ravel())).reshape(STEPS, 6)
    by_law = np.einsum("kij,kj->ki", table.gains[:, :, :6], states) + table.gains[:, :, 9:] @ c
    assert by_law == pytest.approx(best, abs=1e-5 * np.abs(best).max())


@pytest.fixture(scope="module")
def flight(bench, turned):
    """Flights with a residual dipole that nobody knows: its torque is periodic as the field is."""

    def fly(law, name, gains=None, orbits=5.0, dipole=DIPOLE_AM2):
        body = bench.Body(DIAGONAL, most_am2=2.0, dipole=dipole)
        return bench.fly_from_rest(
            law,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), 5.0),
            orbits=orbits,
            step_s=20.0,
            settings=bench.scheduled(body, 20.0, name, gains),
        )

    return fly


@pytest.mark.long
def test_a_periodic_torque_that_nobody_knows_is_learned(flight):
    learned = flight(lqr_disturbed, "lqr_disturbed", {"learning": 3.0})
    plain = flight(lqr, "lqr")
    last = len(plain.t_s) // 5
    assert learned.angle_deg[-last:].mean() < 0.4 * plain.angle_deg[-last:].mean()


def test_without_learning_it_is_the_regulator(flight):
    kept = flight(lqr_disturbed, "lqr_disturbed", {"learning": 0.0}, orbits=0.3)
    plain = flight(lqr, "lqr", orbits=0.3)
    assert kept.m_body == pytest.approx(plain.m_body, rel=1e-9, abs=1e-12)


@pytest.fixture
def asked(bench, turned):
    """The law in one tick, 15 deg off; with what it remembers."""

    def ask(memory=(), tick=200, **changed):
        orbit, c = bench.Orbit(), turned((1, -2, 3), 15.0)
        c_body_from_eci = c @ orbit.c_orbit_from_eci(tick * 10.0)
        inputs = bench.inputs_at(orbit, tick, 10.0, c_body_from_eci, np.array([1e-4, 2e-4, 1.3e-3]), None)
        settings = bench.scheduled(bench.Body(INERTIA, most_am2=2.0), 10.0, "lqr_disturbed")
        return lqr_disturbed(inputs.replace(**changed), memory, bench.setpoint(), settings)

    return ask


@pytest.mark.parametrize("foreign", [(1.0, 2.0), (0.0,) * 136])
def test_what_another_law_remembered_is_not_used(asked, foreign):
    assert asked(foreign) == asked(())


def test_nothing_is_learned_over_a_long_gap(asked):
    first = asked((), tick=200).memory
    assert asked(first, tick=207).memory[10:] == first[10:]
    assert asked(first, tick=204).memory[10:] != first[10:]


@pytest.mark.parametrize("missing", ["attitude", "reference"])
def test_without_knowledge_nothing_is_asked_for_and_nothing_forgotten(asked, missing):
    memory = asked().memory
    demand = asked(memory, tick=201, **{missing: UNKNOWN if missing == "attitude" else None})
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
    assert demand.memory == memory


@pytest.mark.parametrize("gains", [{"learning": -1.0}, {"learning": 21.0}, {"effort": 0.0}])
def test_numbers_out_of_range_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        DisturbedGains(**gains)


@pytest.fixture
def turned_15(turned):
    return turned((1, -2, 3), 15.0)


def test_what_is_learned_is_a_torque_of_orbital_axes(asked, bench, turned_15):
    """A rate that is more by a little: J times it, turned back, over the functions of latitude."""
    more, memory = np.array([2e-6, -1e-6, 3e-6]), asked().memory
    orbit, tick = bench.Orbit(), 201
    omega = asked_rate(orbit, turned_15)
    plain, other = (
        np.array(asked(memory, tick=tick, attitude=attitude_of(bench, turned_15, rate)).memory[10:])
        for rate in (omega, omega + more)
    )
    share = DisturbedGains().learning / orbit.period_s
    expected = np.kron(
        share * np.array([1.0, 2.0, 2.0, 2.0, 2.0]) * functions(orbit.rate_radps * 10.0 * tick),
        turned_15.T @ INERTIA @ more,
    )
    assert other - plain == pytest.approx(expected, rel=0.02, abs=1e-2 * np.abs(expected).max())


def asked_rate(orbit, c):
    return np.array([1e-4, 2e-4, 1.3e-3]) - orbit.rate_radps * c[:, 2]


def attitude_of(bench, c, relative):
    orbit = bench.Orbit()
    omega = relative + orbit.rate_radps * c[:, 2]
    return bench.inputs_at(orbit, 201, 10.0, c @ orbit.c_orbit_from_eci(2010.0), omega, None).attitude


def test_a_torque_that_the_filter_knows_is_not_learned_again(asked, bench, turned_15):
    """Of its impulse that of the half step in which it is known is taken off."""
    torque, memory = np.array([3e-6, -2e-6, 4e-6]), asked().memory
    orbit = bench.Orbit()
    plain, other = (
        np.array(asked(memory, tick=201, torque_body_nm=tuple(part * torque)).memory[10:])
        for part in (0.0, 1.0)
    )
    share = DisturbedGains().learning / orbit.period_s
    assert (other - plain)[:3] == pytest.approx(-share * 0.5 * 10.0 * turned_15.T @ torque, rel=1e-6)


def test_of_a_turned_body_the_answer_to_what_is_learned_is_in_its_axes(asked, table, bench, turned_15):
    """Beside the same memory without it."""
    memory, learned = asked().memory, 1e-8 * np.random.default_rng(4).standard_normal(15)
    full, empty = (*memory[:10], *learned), (*memory[:10], *(0.0,) * 15)
    more = np.subtract(*(asked(one, tick=200).m_body_am2 for one in (full, empty)))
    step = int(bench.Orbit().rate_radps * 2000.0 * STEPS / (2.0 * np.pi)) % STEPS
    assert more == pytest.approx(turned_15 @ table.gains[step, :, 9:] @ learned, rel=1e-3)


def test_what_is_learned_is_expected_to_turn_the_body_in_its_axes(asked, bench, turned_15):
    """Beside the same memory without it: J times the change is the torque of orbital axes, turned."""
    memory, learned = asked().memory, 1e-7 * np.random.default_rng(4).standard_normal(15)
    full, empty = (asked((*memory[:10], *own), tick=200) for own in (learned, np.zeros(15)))
    orbit = bench.Orbit()
    b_body_t = turned_15 @ orbit.c_orbit_from_eci(2000.0) @ orbit.b_eci_t(2000.0)
    coils = np.cross(np.subtract(full.m_body_am2, empty.m_body_am2), b_body_t)
    torque = turned_15 @ (functions(orbit.rate_radps * 2000.0) @ learned.reshape(5, 3))
    change = np.subtract(full.memory[4:7], empty.memory[4:7])
    assert INERTIA @ change - coils == pytest.approx(torque, rel=1e-5)
