"""A figure that is no number stays none, wherever it stands among others, and meets no claim."""

import ast
from dataclasses import replace
from math import nan
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fsw.core.laws.interface import Demand
from fsw.core.laws.table import LAWS
from sim.campaign.claim import Claim, ClaimVerdict
from sim.campaign.flight import FlightResult, Order
from sim.validate import optimal_pulses
from sim.validate.consat import minimisers, posat1, prediction
from sim.validate.guard import guarded
from sim.validate.population.claims import quiet_and_honest
from sim.validate.reference import environment_check, reference
from sim.validate.reference.reference_table import DATA
from sim.validate.review import damping, driven_wheel, effects, law_flight, regulators, wheel
from sim.validate.review import feedback_gains as gains
from sim.validate.review.figures import one_figure

VALIDATE = Path(__file__).parents[3] / "sim" / "validate"
NO_FIGURES = {
    "max((one for one in studies if f'{claim}.'.startswith(f'{one}.')), key=len, default='')",
    "max((past - first for first, past in spans(wrong & against)), default=0)",
    "min(SATELLITES, most)",
    "min(count, most)",
    "min(len(row), len(self.names) - 1)",
}
"""Counts and texts, among which there is none that is no number."""
CHECKED = {
    "max(-most, min(most, part))",
    "min(most, part)",
    "max(1.0, float(np.abs(mean).max(initial=0.0)))",
}
"""A dipole that was checked before; a bound that what is no number is not under."""
NO_CLAIMS = {"population/page.py"}


def calls(path):
    tree = ast.parse(path.read_text())
    called = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
    return {ast.unparse(node) for node in called if ast.unparse(node.func) in ("max", "min")}


@pytest.mark.long
def test_max_and_min_which_lose_what_is_no_number_take_no_figures():
    """They keep it only where it comes first; np.max and np.min always do."""
    modules = [
        path for path in VALIDATE.rglob("*.py") if path.relative_to(VALIDATE).as_posix() not in NO_CLAIMS
    ]
    assert {call for path in modules for call in calls(path)} <= NO_FIGURES | CHECKED


@pytest.mark.parametrize(
    ("study", "results", "failing"),
    [
        (
            prediction.prediction(),
            [[(1e-5, 0.9, 0.9), (nan, 0.9, nan)]],
            ["prediction.rate", "prediction.restricted"],
        ),
        (minimisers.genetic(), [[1e-4, 2e-4], [1e-4, nan]], ["genetic.median", "genetic.all"]),
        (regulators.averaged(), (0.1, nan, 0.1, 0.2), ["review.optimal.averaged.inertia"]),
        (regulators.averaged(), (0.1, 0.1, 0.1, nan), ["review.optimal.averaged.torque"]),
    ],
)
def test_a_result_that_is_none_fails_its_claim(study, results, failing):
    assert [o.claim.id for o in study.conclude(results) if o.verdict is ClaimVerdict.FAIL] == failing


def test_a_rise_of_the_jacobi_integral_that_is_none(monkeypatch):
    flown = SimpleNamespace(q_body_from_orbit=None, relative_body_radps=None, orbit_rate_radps=1e-3)
    monkeypatch.setattr(damping, "fly", lambda case: flown)
    monkeypatch.setattr(damping, "jacobi_integral", lambda *given: np.array([3.0, 2.0, nan, 1.0]))
    assert np.isnan(damping.jacobi_rise("rate_damping"))
    monkeypatch.setattr(damping, "jacobi_integral", lambda *given: np.array([3.0, 2.0, 1.0]))
    assert damping.jacobi_rise("rate_damping") == 0.0


def second_is_none(values):
    """Gives the values one by one, but nan in the place of the second."""
    given = iter(range(10**6))

    def give(*_):
        return nan if next(given) == 1 else values

    return give


def test_a_decay_or_a_share_that_is_none(monkeypatch):
    monkeypatch.setattr(wheel, "_decay_error", second_is_none(1e-6))
    assert np.isnan(wheel.worst_decay())
    monkeypatch.setattr(wheel, "decays", lambda *given: (-1.0, nan))
    assert np.isnan(wheel.slowest_decay())
    monkeypatch.setattr(gains, "best_on_line", lambda body: (None, 1.0))
    share = second_is_none(1.0)
    monkeypatch.setattr(gains, "best_of_all", lambda body: (None, share()))
    assert np.isnan(gains.least_share())


def test_a_torque_or_a_dipole_that_is_none(monkeypatch):
    monkeypatch.setattr(driven_wheel, "DRAWN", 4)
    effort = SimpleNamespace(m_body_am2=(0.0, 0.0, 0.0), wheel_torque_nm=nan)
    monkeypatch.setattr(driven_wheel, "two_coils_and_wheel", lambda *given: effort)
    monkeypatch.setattr(driven_wheel, "affordable", lambda *given: effort)
    assert np.isnan(driven_wheel.given_share())
    assert np.isnan(driven_wheel.beyond_limits())
    torque = second_is_none(0.0)
    monkeypatch.setattr(effects, "torques", SimpleNamespace(magnetic=lambda *given: (0.0, 0.0, torque())))
    assert np.isnan(effects.coils_about_normal())


def test_a_pointing_error_that_is_none():
    orders = [task.args[0] for task in optimal_pulses.beside_mpc(range(1, 4)).tasks]
    ours, theirs = (
        [FlightResult(order, {}, {"pointing_deg": deg}) for order, deg in zip(part, degs, strict=True)]
        for part, degs in ((orders[:3], (0.5, 0.9, nan)), (orders[3:], (0.6, 1.0, 3.0)))
    )
    assert {one.verdict for one in optimal_pulses.compared("a", ours, theirs)} == {ClaimVerdict.FAIL}


def test_a_dissipation_that_is_none():
    orders = posat1.libration().tasks[:3]
    settled = {"axis1_deg": {"settle_orbits_5deg": 2.0}}
    lost, sound = (
        [
            FlightResult(task.args[0], settled, {"m2_until_settled": m2})
            for task, m2 in zip(orders, values, strict=True)
        ]
        for values in ((nan, 5.0, 6.0), (1.0, 1.0, 1.0))
    )
    found = {one.claim.id: one.verdict for one in posat1.compared(lost, sound, sound)}
    assert found["posat1.dissipation"] is ClaimVerdict.FAIL


def test_the_worst_axis_is_the_one_without_a_number():
    figures = {"inside_1": 0.99, "inside_2": nan, "inside_3": 0.98}
    picked = {figure.id: figure.pick for figure in quiet_and_honest(1)}
    flight = FlightResult(Order("microsat"), {}, figures)
    assert np.isnan([picked["inside"](flight), picked["inside_worst"](flight)]).all()


def test_elements_whose_distance_is_none(monkeypatch):
    distance = second_is_none(1e-9)
    monkeypatch.setattr(environment_check, "_largest_distances", lambda *given: (distance(), 1e-12))
    position, velocity = reference.check_file(DATA / "tle.txt", "tle.txt").outcomes
    assert (position.verdict, velocity.verdict) == (ClaimVerdict.FAIL, ClaimVerdict.PASS)


class TestLaw:
    """A law that asks for what is no number, from some moment on."""

    FLIGHT = law_flight.LawFlight("pd", damping.FULL, orbits=0.01)

    @pytest.fixture(params=[Demand((0.0, nan, 0.0)), Demand(wheel_torque_nm=nan)], ids=["dipole", "wheel"])
    def law(self, request, monkeypatch):
        def asks(inputs, memory, setpoint, config):
            return request.param if inputs.tick == 3 else Demand()

        monkeypatch.setattr(law_flight, "LAWS", LAWS | {"pd": replace(LAWS["pd"], acquire=asks, point=asks)})

    def angle_deg(self):
        return float(law_flight.fly(self.FLIGHT).angle_deg[-1])

    def test_its_flight_has_no_figures(self, law):
        with pytest.raises(
            law_flight.NoNumberError, match=r"15 s after the start pd asks for what is no number"
        ):
            self.angle_deg()

    def test_it_meets_no_claim(self, law):
        study = guarded(one_figure(Claim("a", "Angle", "Somebody", "deg"), self.angle_deg))
        (outcome,) = study.conclude([task() for task in study.tasks])
        assert outcome.verdict is ClaimVerdict.FAIL
        assert "pd asks for what is no number" in outcome.where
