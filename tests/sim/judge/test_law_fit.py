"""Mistakes of a law are told by its dipoles, and none is where they brake or tell nothing."""

import numpy as np
import pytest

from sim.judge.law_fit import LEAST_PULSES, fit_law
from sim.scenario.schema import load

TICKS, PULSES = 4000, range(100, 3900, 103)


def flight(mistake=lambda braking: braking, rate_degps=1.0, pulses=PULSES):
    """Histories with one pulse of a coil at a time, along the largest component of what the law means."""
    rng = np.random.default_rng(5)
    q = np.tile((1.0, 0.0, 0.0, 0.0), (TICKS, 1))
    omega = rng.normal(size=(TICKS, 3))
    omega *= np.radians(rate_degps) / np.linalg.norm(omega, axis=1, keepdims=True)
    b = 3e-5 * rng.normal(size=(TICKS, 3))
    m = np.zeros((TICKS, 3))
    for tick in pulses:
        meant = mistake(np.cross(omega[tick], b[tick]))
        axis = int(np.abs(meant).argmax())
        m[tick + 1 : tick + 4, axis] = 30.0 * np.sign(meant[axis])
    torque = np.zeros((TICKS, 3))
    torque[1:] = np.cross(m[1:], b[:-1])
    return {
        "q_body_from_orbit": q,
        "omega_body_orbit_radps": omega,
        "b_body_t": b,
        "m_body_am2": m,
        "torque_body_nm/coils": torque,
    }


def fit(*arguments, **options):
    return fit_law(load("microsat"), flight(*arguments, **options))


def test_one_that_brakes_makes_no_mistake():
    found = fit()
    assert found.mistake == ""
    assert found.brakes > 0.7
    assert found.pulses == len(PULSES)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda d: -d, "a sign error: its dipoles speed the body up instead of braking it"),
        (lambda d: d * (1, -1, 1), "a sign error: the sign of y is wrong"),
        (lambda d: d[[1, 0, 2]], "the axes x and y are swapped"),
        (lambda d: d[[0, 2, 1]], "the axes y and z are swapped"),
        (
            lambda d: d[[1, 2, 0]],
            "the axes are mixed up: y is taken for x, z is taken for y, x is taken for z",
        ),
        (lambda d: d[[1, 0, 2]] * (1, -1, 1), "the axes x and y are swapped, and the sign of y is wrong"),
    ],
)
def test_a_mistake_of_signs_or_axes_is_named(mistake, words):
    assert fit(mistake).mistake.partition(": over ")[0] == words


def test_dipoles_at_random_are_no_mistake_that_has_a_name():
    rng = np.random.default_rng(6)
    found = fit(lambda d: rng.normal(size=3))
    assert found.mistake == ""
    assert abs(found.brakes) < 0.4


def test_samples_that_are_read_the_wrong_way_round_are_told():
    rng = np.random.default_rng(7)
    samples = rng.integers(-20_000, 20_000, size=(TICKS, 3)).astype(np.int16)
    read = samples.byteswap().astype(float)
    truth = flight()
    truth["m_body_am2"][:] = 0.0
    for tick in PULSES:
        seen = read[tick - 4] - read[tick]
        axis = int(np.abs(seen).argmax())
        truth["m_body_am2"][tick + 1 : tick + 4, axis] = 30.0 * np.sign(seen[axis])
    assert "the byte order of MAG_FIELD" in fit_law(load("microsat"), truth, samples).mistake
    assert fit_law(load("microsat"), flight(), samples).mistake == ""


@pytest.mark.parametrize("by_rate", [False, True])
def test_samples_that_are_read_as_unsigned_are_told(by_rate):
    samples = np.cumsum(np.random.default_rng(8).integers(-3000, 3001, size=(TICKS, 3)), axis=0)
    samples = (np.abs(samples % 40_000 - 20_000) - 10_000).astype(np.int16)
    read = samples.view(np.uint16).astype(float)
    truth = flight()
    truth["m_body_am2"][:] = 0.0
    for tick in PULSES:
        omega = truth["omega_body_orbit_radps"][tick]
        meant = np.cross(omega, read[tick]) if by_rate else read[tick - 4] - read[tick]
        truth["m_body_am2"][tick + 1 : tick + 4] = 10.0 * meant / np.linalg.norm(meant)
    assert fit_law(load("microsat"), truth, samples).mistake.startswith("MAG_FIELD is read as unsigned: ")
    for tick in PULSES:
        seen = (samples[tick - 4].astype(float) - samples[tick]) / 1e4
        truth["m_body_am2"][tick + 1 : tick + 4] = 10.0 * seen / np.linalg.norm(seen)
    assert "unsigned" not in fit_law(load("microsat"), truth, samples).mistake


def test_a_body_that_hardly_turns_tells_nothing():
    assert fit(lambda d: -d, rate_degps=0.1).pulses == 0


def test_few_pulses_tell_nothing():
    assert fit(lambda d: -d, pulses=PULSES[: LEAST_PULSES - 1]).pulses == 0
