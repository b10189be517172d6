"""Claims: stabilisation by spin (section 2.1)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
