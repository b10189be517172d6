"""Claims: three axes, simple feedback (section 3.1): laws in flight, and gains found on the ground."""

from sim.campaign.claim import Study
from sim.validate.review.feedback import gains, laws


def studies() -> list[Study]:
    """All of this section."""
    return [*laws.studies(), *gains.studies()]
