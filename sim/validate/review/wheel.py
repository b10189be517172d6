"""Claims: a wheel beside the coils (sections 2.2, 2.4)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
