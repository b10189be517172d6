"""The robust regulator: with a wheel and without; a large gamma leaves ``lqr``."""

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.h_infinity import HInfinityGains, h_infinity, robust_schedule
from fsw.core.laws.lqr import LqrGains, lqr, schedule

INERTIA = np.array([[1.02, 0.02, 0.01], [0.02, 1.85, -0.03], [0.01, -0.03, 1.95]])
WHEEL = (0.0, 0.0, 0.05)


def circle(bench):
    orbit = bench.Orbit()
    return orbit.rate_radps, np.radians(98.6), 7.812e15 / orbit.radius_m**3


def table(bench, wheel=(0.0, 0.0, 0.0), **gains):
    rows = tuple(map(tuple, INERTIA.tolist()))
    return robust_schedule(rows, wheel, *circle(bench), HInfinityGains(**gains))


@pytest.fixture(scope="module")
def flight(bench, turned):
    def fly(law, name, body, orbits=1.0, gains=None):
        return bench.fly_from_rest(
            law,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, -2, 3), 15.0),
            orbits=orbits,
            step_s=20.0,
            settings=bench.scheduled(body, 20.0, name, gains),
        )

    return fly


@pytest.mark.parametrize("wheel", [(0.0, 0.0, 0.0), WHEEL])
def test_a_large_gamma_leaves_the_regulator(bench, wheel):
    rows = tuple(map(tuple, INERTIA.tolist()))
    plain = schedule(rows, wheel, *circle(bench), LqrGains())
    robust = table(bench, wheel, gamma=1e5)
    assert robust.gains[:, :, :6] == pytest.approx(
        plain.gains[:, :, :6], abs=1e-5 * np.abs(plain.gains[:, :, :6]).max()
    )


def test_a_gamma_that_cannot_be_had_is_doubled(bench):
    low, doubled = table(bench, gamma=0.75), table(bench, gamma=3.0)
    assert np.array_equal(low.gains, doubled.gains)


def test_a_small_gamma_answers_the_attitude_more(bench):
    soft, firm = (np.abs(table(bench, gamma=gamma).gains[:, :, 3:6]).mean() for gamma in (1e3, 2.5))
    assert firm > 1.2 * soft


@pytest.mark.long
def test_it_holds_the_body_and_that_with_a_wheel(bench, flight):
    for wheel, orbits in (((0.0, 0.0, 0.0), 1.5), (WHEEL, 3.0)):
        flown = flight(h_infinity, "h_infinity", bench.Body(np.diag([1.02, 1.85, 1.95]), wheel, 2.0), orbits)
        assert flown.angle_deg[-1] < 1.5


@pytest.mark.long
def test_from_the_same_start_it_is_sooner_at_rest_than_the_regulator(bench, flight):
    body = bench.Body(np.diag([1.02, 1.85, 1.95]), (0.0, 0.0, 0.0), 2.0)
    robust, plain = flight(h_infinity, "h_infinity", body, 1.5, {"gamma": 2.5}), flight(lqr, "lqr", body, 1.5)
    last = len(plain.t_s) // 3
    assert robust.angle_deg[-last:].mean() < 0.8 * plain.angle_deg[-last:].mean()


@pytest.mark.parametrize("missing", ["attitude", "reference", "schedule"])
def test_without_knowledge_nothing_is_asked_for(bench, missing):
    body, orbit = bench.Body(INERTIA), bench.Orbit()
    settings = bench.scheduled(body, 1.0, "h_infinity" if missing != "schedule" else "lqr")
    inputs = bench.inputs_at(orbit, 9, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    full = bench.scheduled(body, 1.0, "h_infinity")
    assert any(h_infinity(inputs, (), bench.setpoint(), full).m_body_am2)
    if missing == "attitude":
        inputs = inputs.replace(attitude=UNKNOWN)
    if missing == "reference":
        inputs = inputs.replace(reference=None)
    assert h_infinity(inputs, (), bench.setpoint(), settings).m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("gains", [{"gamma": 0.0}, {"gamma": 1e9}, {"effort": 0.0}, {"rate": -1.0}])
def test_numbers_that_make_no_game_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        HInfinityGains(**gains)
