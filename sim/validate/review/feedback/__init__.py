"""Claims: three axes, simple feedback (section 3.1): laws in flight, gains, and what linear theory says."""

from sim.campaign.claim import Study
from sim.validate.review.feedback import gains, laws, linear, neural


def studies() -> list[Study]:
    """All of this section."""
    return [*laws.studies(), *gains.studies(), *linear.studies(), *neural.studies()]
