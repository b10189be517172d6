"""Claims on laws that hold the whole attitude: one that decays more slowly misses what it came down to."""

import pytest

from fsw.core.laws import pd
from sim.campaign.claim import ClaimVerdict
from sim.validate.review.pointing import feedback_trials, other_trials


def outcome(name):
    study = next(
        trial.study() for trial in (*feedback_trials(), *other_trials()) if trial.id == f"review.{name}"
    )
    return next(
        one for one in study.conclude([task() for task in study.tasks]) if one.claim.id.endswith(".final")
    )


@pytest.mark.parametrize(
    "name", ["feedback.pd", "feedback.output", "feedback.regularised", "sliding.plain", "optimal.lqr"]
)
def test_each_decays_as_claimed_and_the_limit_is_near(name):
    found = outcome(name)
    assert found.verdict is ClaimVerdict.PASS
    assert not found.claim.is_loose(found.ours)
    assert not found.claim.wide


@pytest.mark.interpreted
def test_half_a_gain_about_one_axis_is_missed(monkeypatch):
    whole = pd.pd_dipole

    def halved(b, rate, error, k_w, k_a):
        return whole(b, (0.5 * rate[0], rate[1], rate[2]), error, k_w, k_a)

    monkeypatch.setattr(pd, "pd_dipole", halved)
    assert outcome("feedback.pd").verdict is ClaimVerdict.FAIL
