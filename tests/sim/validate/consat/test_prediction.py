"""What the law expects of a pulse against the plant, and that each sign planted in the law shows."""

import numpy as np
import pytest

from sim.campaign.claim import ClaimVerdict
from sim.validate.consat import prediction

SEEDS = range(20)


def worst(figure):
    return max(figure(prediction.state_of(seed)) for seed in SEEDS)


def planted_change(monkeypatch, **signs):
    """The law with another sign of its arguments."""
    change = prediction.free_rate_change

    def wrong(omega, c, w0, radius, inertia, inverse, wheel):
        return change(
            omega,
            c,
            signs.get("w0", 1.0) * w0,
            signs.get("radius", 1.0) * radius,
            inertia,
            inverse,
            tuple(signs.get("wheel", 1.0) * h for h in wheel),
        )

    monkeypatch.setattr(prediction, "free_rate_change", wrong)


def test_the_change_of_the_rate_is_the_plants():
    assert worst(prediction.rate_error) < 1e-4


@pytest.mark.parametrize("signs", [{"w0": -1.0}, {"wheel": -1.0}, {"radius": 1.01}], ids=str)
def test_an_error_in_any_term_shows(monkeypatch, signs):
    planted_change(monkeypatch, **signs)
    assert worst(prediction.rate_error) > 1e-3


@pytest.mark.parametrize("choice", [prediction.unrestricted, prediction.restricted])
def test_the_energy_is_never_more_and_with_the_sign_turned_it_is(monkeypatch, choice):
    def left(state):
        return prediction.energy_left(state, choice)

    assert worst(left) <= 1.0
    missing = prediction.missing_impulse
    monkeypatch.setattr(prediction, "missing_impulse", lambda *given: tuple(-c for c in missing(*given)))
    assert worst(left) > 1.0


def test_states_have_wheels_products_of_inertia_and_fields_of_an_orbit():
    states = [prediction.state_of(seed) for seed in SEEDS]
    assert all(
        np.abs(state.inertia_kgm2 - np.diag(np.diag(state.inertia_kgm2))).max() > 0.1 for state in states
    )
    assert all(np.linalg.norm(state.wheel_body_nms) > 1e-3 for state in states)
    assert all(1e-6 < np.linalg.norm(state.b_body_t) < 1e-4 for state in states)


@pytest.mark.parametrize(
    ("row", "failing"),
    [
        ((1e-5, 1.0, 1.0), []),
        ((2e-4, 0.9, 0.9), ["prediction.rate"]),
        ((1e-5, 1.0001, 0.9), ["prediction.unrestricted"]),
        ((1e-5, 0.9, 1.0001), ["prediction.restricted"]),
    ],
)
def test_verdicts(row, failing):
    outcomes = prediction.prediction().conclude([[(1e-6, 0.5, 0.5), row]])
    assert [o.claim.id for o in outcomes if o.verdict is ClaimVerdict.FAIL] == failing
