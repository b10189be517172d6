"""Claims on one axis: a law that lacks one of its terms misses them."""

from fsw.core.laws.one_axis import sun_panels
from sim.campaign.claim import ClaimVerdict
from sim.validate.review import one_axis


def verdict():
    study = next(study for study in one_axis.studies() if study.id == "review.one_axis.sun_panels")
    (outcome,) = study.conclude([task() for task in study.tasks])
    return outcome.verdict


def test_panels_without_their_difference_miss_the_sun(monkeypatch):
    assert verdict() is ClaimVerdict.PASS
    whole = sun_panels.panel_torque
    monkeypatch.setattr(
        sun_panels, "panel_torque", lambda currents, axis, k, k_most: whole(currents, axis, 0.0, k_most)
    )
    assert verdict() is ClaimVerdict.FAIL
