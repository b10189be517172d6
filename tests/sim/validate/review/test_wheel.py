"""Claims on a pitch wheel: each is met, and a satellite that is off misses it."""

from dataclasses import replace

import pytest

from fsw.core.laws import wheel_integral
from fsw.core.laws.six_gain import SixGainGains
from sim.design.pitch_wheel import WheelLaw
from sim.validate.review import wheel


@pytest.mark.long
@pytest.mark.parametrize("study", wheel.studies(), ids=lambda study: study.id)
def test_each_claim_is_met(study):
    outcomes = study.conclude([task() for task in study.tasks])
    assert [outcome.verdict.value for outcome in outcomes] == ["PASS"]


def test_a_law_of_the_wrong_sign_would_miss_its_claim():
    short = replace(wheel.WHEELED, orbits=0.7)
    right, wrong = (
        wheel.last_lean_deg(replace(short, gains=SixGainGains(k2=k2), k_w=k_w))
        for k2, k_w in ((1.0, 1e7), (-1.0, 0.0))
    )
    assert wrong > 1.2 * right


@pytest.mark.interpreted
@pytest.mark.parametrize(("axis", "name"), [(0, "wheel_integral_yaw"), (2, "wheel_integral_pitch")])
def test_without_one_of_its_integrals_the_turn_about_that_axis_stays(monkeypatch, axis, name):
    study = next(one for one in wheel.studies() if one.id == f"review.wheel.{name}")
    whole = wheel_integral.integral_dipole

    def without(b_body_t, integral_s, k_i):
        kept = [0.0 if place == axis else part for place, part in enumerate(integral_s)]
        return whole(b_body_t, tuple(kept), k_i)

    monkeypatch.setattr(wheel_integral, "integral_dipole", without)
    (outcome,) = study.conclude([task() for task in study.tasks])
    assert outcome.verdict.value == "FAIL"


def test_without_its_rate_part_the_ellipse_misses_its_claim(monkeypatch):
    monkeypatch.setattr(wheel, "LAW", WheelLaw(8000.0, 0.0))
    assert wheel.slowest_decay() > -0.01
