"""Theory against the plant: what they agree in, and that a slip in either would show."""

from dataclasses import replace

import numpy as np
import pytest

from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.validate import computed
from sim.validate.computed import ControlledPlant

FIFTY = replace(BODIES[2], inertia_kgm2=computed.FULL)
GAINS = computed.KNOWN_BEST["50 kg"][1]


def judged(study, results):
    return [outcome.verdict.value for outcome in study.conclude(results)]


def test_the_plant_is_linearised_to_what_the_design_tools_take_it_for():
    assert computed.linearisation_error(FIFTY) < 1e-10


@pytest.mark.parametrize(
    ("body", "gains"),
    [
        (FIFTY, Gains(1.000001 * GAINS.k_w, GAINS.k_a)),
        (FIFTY, Gains(GAINS.k_w, 1.000001 * GAINS.k_a)),
        (replace(FIFTY, inclination_deg=98.60001), GAINS),
        (
            replace(FIFTY, inertia_kgm2=((1.02, 0.03, -0.02), (0.03, 1.850001, 0.05), (-0.02, 0.05, 1.95))),
            GAINS,
        ),
    ],
)
def test_a_millionth_more_would_show(body, gains):
    theory = closed_loop(FIFTY, GAINS)(np.array([0.9]))[0]
    assert np.abs(ControlledPlant.of(body, gains).linearised(0.9) - theory).max() > 1e-8


def test_states_and_their_rates_belong_together():
    """A turn about axis 3 alone, in the orbit's plane: theta' = w to first order, nothing else turns."""
    plant = ControlledPlant(BODIES[2], 0.0, 0.0)
    x = np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.02])
    rates = plant.rates(1.1, x)
    a, b, c = 1.02, 1.85, 1.95
    assert rates[3:] == pytest.approx([0.0, 0.0, 0.3 * np.sqrt(1.0 - 1e-4)], abs=1e-12)
    pitch = 2.0 * np.arcsin(0.01)
    assert rates[:3] == pytest.approx([0.0, 0.0, 1.5 * (a - b) / c * np.sin(2.0 * pitch)], abs=1e-12)


@pytest.mark.long
def test_exponents_of_the_plant_are_those_of_the_theory():
    body = BODIES[2]
    assert computed.exponent_error(body) < 1e-5
    other = ControlledPlant(body, float(GAINS.k_w), 1.1 * float(GAINS.k_a)).monodromy()
    ours = degree_of_stability(monodromy(closed_loop(body, GAINS)))
    assert abs(float(degree_of_stability(other) - ours)) > 1e-3


def test_the_gains_that_are_known_give_about_the_degrees_that_are_known():
    """The optima sit on kinks: gains of few digits lose up to 0.04."""
    for body in BODIES:
        degree, gains = computed.KNOWN_BEST[body.name]
        found = float(degree_of_stability(monodromy(closed_loop(body, gains))))
        assert found == pytest.approx(degree, abs=0.04)


class TestVerdicts:
    def test_of_the_jacobi_integral(self):
        study = computed.jacobi()
        assert judged(study, [1e-12]) == ["PASS"]
        assert judged(study, [2e-11]) == ["FAIL"]

    def test_the_worst_body_counts(self):
        study = computed.linearisation()
        assert len(study.tasks) == 7
        errors = [1e-12] * 6 + [2e-9]
        outcome = study.conclude(errors)[0]
        assert (outcome.verdict.value, outcome.where) == ("FAIL", "50 kg, full inertia tensor")
        assert judged(study, [1e-12] * 7) == ["PASS"]

    def test_best_gains_may_not_be_worse_than_known_to_three_digits(self):
        study = computed.best_gains()
        known = [(degree, "", True) for degree, _ in computed.KNOWN_BEST.values()]
        assert judged(study, known) == ["PASS"] * 6
        worse = [(degree + 0.001, "", True) for degree, *_ in known]
        assert judged(study, worse) == ["FAIL"] * 6

    def test_bodies_that_gains_do_not_help(self):
        study = computed.unstable_bodies()
        assert judged(study, [(-0.3, "", True), (-0.1, "", False), (-0.1, "", False)]) == ["PASS"]
        outcome = study.conclude([(-0.3, "", True), (-0.1, "", True), (-0.1, "", False)])[0]
        assert (outcome.verdict.value, outcome.ours) == ("FAIL", 1.0)
        assert "50 kg" in outcome.where
