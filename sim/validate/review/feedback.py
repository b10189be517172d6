"""Claims: three axes, simple feedback (section 3.1)."""

from sim.campaign.claim import Study


def studies() -> list[Study]:
    """All of this section."""
    return []
