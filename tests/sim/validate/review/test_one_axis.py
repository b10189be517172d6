"""Claims on one axis: a law that lacks one of its terms misses them."""

import pytest

from fsw.core.algebra.vector import add, scale
from fsw.core.laws import sun_critical, sun_panels
from sim.campaign.claim import ClaimVerdict
from sim.validate.review import one_axis

pytestmark = pytest.mark.long


def verdict(name):
    study = next(study for study in one_axis.studies() if study.id == f"review.one_axis.{name}")
    (outcome,) = study.conclude([task() for task in study.tasks])
    return outcome.verdict


@pytest.mark.interpreted
def test_panels_without_their_difference_miss_the_sun(monkeypatch):
    assert verdict("sun_panels") is ClaimVerdict.PASS
    whole = sun_panels.panel_torque
    monkeypatch.setattr(
        sun_panels, "panel_torque", lambda currents, axis, k, k_most: whole(currents, axis, 0.0, k_most)
    )
    assert verdict("sun_panels") is ClaimVerdict.FAIL


@pytest.mark.interpreted
def test_with_half_of_its_damping_the_critical_law_is_slower_without_the_gravity_gradient(monkeypatch):
    """With it the law only comes nearer."""
    both = ("sun_critical", "sun_critical_free")
    assert [verdict(name) for name in both] == [ClaimVerdict.PASS, ClaimVerdict.PASS]
    whole = sun_critical.critical_acceleration
    monkeypatch.setattr(
        sun_critical,
        "critical_acceleration",
        lambda omega, sun, axis, xi: add(whole(omega, sun, axis, xi), scale(xi, omega)),
    )
    assert [verdict(name) for name in both] == [ClaimVerdict.PASS, ClaimVerdict.FAIL]
