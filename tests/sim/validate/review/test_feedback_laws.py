"""Claims on simple feedback: a law that lacks one of its terms misses one of them."""

import pytest

from fsw.core.algebra.vector import ZERO, scale
from fsw.core.laws import pd_delayed, sphere
from sim.campaign.claim import ClaimVerdict
from sim.validate.review import feedback_laws

pytestmark = pytest.mark.long


def missed(study):
    """The claims of a study that are missed."""
    outcomes = study.conclude([task() for task in study.tasks])
    return {one.claim.id for one in outcomes if one.verdict is not ClaimVerdict.PASS}


@pytest.mark.interpreted
def test_an_observer_that_is_not_told_its_torque_points_as_well_but_lags(monkeypatch):
    assert missed(feedback_laws.sphere()) == set()
    monkeypatch.setattr(sphere, "_given", lambda dipole_am2, most_am2: ZERO)
    assert missed(feedback_laws.sphere()) == {"review.feedback.sphere.pd"}


@pytest.mark.interpreted
def test_a_delayed_law_with_half_of_its_attitude_points_as_well_but_takes_another_way(monkeypatch):
    """The gravity gradient holds the body besides."""
    assert missed(feedback_laws.delayed()) == set()
    whole = pd_delayed.far_error
    monkeypatch.setattr(
        pd_delayed, "far_error", lambda q_body_from_orbit: scale(0.5, whole(q_body_from_orbit))
    )
    assert missed(feedback_laws.delayed()) == {"review.feedback.delayed.pd"}
