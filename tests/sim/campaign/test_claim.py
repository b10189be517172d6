"""Claims: a figure passes within its limits."""

import pytest

from sim.campaign.claim import Claim

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
