"""Claims: damping of the rate (section 1 of the review)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
