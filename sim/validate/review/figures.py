"""Small studies: a claim whose one figure a function gives."""

from collections.abc import Callable

from sim.campaign.claim import Claim, Study


def one_figure(claim: Claim, figure: Callable[[], float]) -> Study:
    """The study of a claim of the same id; ``figure`` must be picklable."""
    return Study(claim.id, (figure,), lambda found: [claim.judge(found[0])])
