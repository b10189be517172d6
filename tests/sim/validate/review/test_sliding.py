"""Claims on sliding control: a law without what makes it up misses them."""

import pytest

from fsw.core.algebra.vector import ZERO
from fsw.core.laws import sliding_twisting
from sim.campaign.claim import ClaimVerdict
from sim.validate.review import sliding


def verdict():
    study = sliding.twisting()
    (outcome,) = study.conclude([task() for task in study.tasks])
    return outcome.verdict


@pytest.mark.interpreted
def test_super_twisting_without_its_integral_is_another_law(monkeypatch):
    assert verdict() is ClaimVerdict.PASS
    monkeypatch.setattr(sliding_twisting, "_grown", lambda *words: ZERO)
    assert verdict() is ClaimVerdict.FAIL
