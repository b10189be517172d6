"""Claims: a figure passes within its limits."""

from math import inf, nan

import pytest

from sim.campaign.claim import Claim, ClaimVerdict, Spread, Threshold
from sim.campaign.study import spread_of

CLAIM = Claim("a.b", "Least | most", "Somebody 2001", "deg", low=1.0, high=2.0)


@pytest.mark.parametrize(
    ("ours", "verdict"),
    [(1.0, "PASS"), (2.0, "PASS"), (0.999, "FAIL"), (2.001, "FAIL"), (float("nan"), "FAIL")],
)
def test_a_figure_passes_within_its_limits(ours, verdict):
    assert CLAIM.judge(ours).verdict.value == verdict


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        ({"high": 3.0}, "<= 3"),
        ({"low": 3.0}, ">= 3"),
        ({"low": 1.0, "high": 2.0}, "1 to 2"),
        ({"high": 0.0}, "0"),
    ],
)
def test_limits_for_people(limits, text):
    assert Claim("a", "b", "c", "d", **limits).limits == text


def test_what_is_fitted_to_its_limits_shows_nothing_by_meeting_them():
    fitted = Claim("a", "b", "c", "d", high=3.0, threshold=Threshold.FITTED)
    assert fitted.judge(2.0).verdict is ClaimVerdict.FITTED
    assert fitted.judge(3.1).verdict is ClaimVerdict.FAIL


@pytest.mark.parametrize(
    ("limits", "ours", "expected"),
    [
        ({"high": 3.0}, 1.5, 2.0),
        ({"high": 3.0}, 0.0, inf),
        ({"high": 0.0}, 0.0, 1.0),
        ({"low": 0.5}, 1.0, 2.0),
        ({"low": 1.0, "high": 8.0}, 2.0, 4.0),
        ({"low": -1.0, "high": -0.4}, -0.5, 2.0),
        ({"high": 1.0}, -0.5, inf),
    ],
)
def test_the_room_is_the_factor_by_which_a_figure_could_be_worse(limits, ours, expected):
    assert Claim("a", "b", "c", "d", **limits).room(ours) == pytest.approx(expected)


def test_a_spread_tells_how_many_flights_meet_the_claim():
    claim = Claim("a", "b", "c", "d", low=0.0, high=3.0)
    assert spread_of(claim, [1.0, 4.0, 2.0, nan]) == Spread(
        flights=4, meet=2, least=1.0, median=3.0, most=inf
    )


@pytest.mark.parametrize(("ours", "loose"), [(0.5, True), (7.0, False), (90.0, False), (9000.0, False)])
def test_a_limit_is_loose_where_it_is_met_by_far(ours, loose):
    """One that is missed by far is no loose one."""
    assert Claim("a", "b", "c", "d", high=60.0).is_loose(ours) is loose
    assert not Claim("a", "b", "c", "d", high=60.0, wide="of another satellite").is_loose(ours)
